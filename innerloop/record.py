"""Everything a reader of a report wants to know of an autopilot's design, as plain data."""

from pathlib import Path
from typing import Any

import control
import numpy as np

from aircraft.trim import Trim
from innerloop.controller import CONTROLS
from innerloop.flight import AutopilotedAircraft
from innerloop.margins import SENSOR_BREAKS, Margin, closed_loop, frequency_response, loop_margins, open_loop
from innerloop.responses import CHANNELS, Response, flown_step, measure_lag, predicted_step
from innerloop.schedule import BANKS_DEG, Schedule

STEPS: dict[str, float] = {"heading_rate": 0.25, "airspeed": 1.0, "altitude": 1.0}
"""Steps that are predicted and flown [rad/s, m/s, m]."""

_STEP_DURATION = 6.0
_FREQUENCIES = np.logspace(-1.5, 2.0, 141)

Record = dict[str, Any]


def design_record(schedule: Schedule, root: Path) -> Record:
    """Compute trims, poles, margins, loop shapes and responses of a design, the responses also flown in JSBSim.

    Parameters
    ----------
    schedule : the design
    root : JSBSim root that ``write_root`` made of it
    """
    middle = len(schedule.airspeeds) // 2
    aircraft = AutopilotedAircraft(schedule.spec, root)
    level = schedule.level(middle)
    return {
        "aircraft": schedule.spec.name,
        "title": schedule.spec.title,
        "source": schedule.spec.source,
        "altitude_m": schedule.altitude,
        "design_airspeed_mps": schedule.airspeeds[middle],
        "airspeeds_mps": list(schedule.airspeeds),
        "weights": {name: getattr(schedule.weights, name) for name in schedule.weights.__slots__},
        "trims": [_trim_record(t) for row in schedule.trims for t in (row[BANKS_DEG.index(0.0)], row[BANKS_DEG.index(45.0)])],
        "poles": [_poles(schedule, i) for i in range(len(schedule.airspeeds))],
        "margins": [
            {"airspeed_mps": airspeed, **_margin_record(margin)}
            for i, airspeed in enumerate(schedule.airspeeds)
            for margin in loop_margins(schedule, i)
        ],
        "loops": [_loop_record(schedule, middle, name) for name in (*CONTROLS, *SENSOR_BREAKS)],
        "responses": [
            response
            for command, size in STEPS.items()
            for response in (
                _response_record("predicted", predicted_step(schedule, middle, command, size, _STEP_DURATION)),
                _response_record("flown", flown_step(aircraft, level, command, size, _STEP_DURATION)),
            )
        ],
        "heading_rate_lag_s": measure_lag(aircraft, level),
    }


def _trim_record(t: Trim) -> Record:
    return {
        "airspeed_mps": t.airspeed,
        "bank_rad": t.roll,
        "alpha_rad": t.alpha,
        "sideslip_rad": t.beta,
        "pitch_rad": t.pitch,
        "yaw_rate_rad_s": t.yaw_rate,
        **dict(t.inputs),
        **dict(t.driven),
    }


def _margin_record(margin: Margin) -> Record:
    return {name: _finite(getattr(margin, name)) for name in margin.__slots__}


def _finite(value: float | str) -> float | str | None:
    """JSON has no infinity and no nan; a margin that does not exist is null."""
    return value if isinstance(value, str) or np.isfinite(value) else None


def _poles(schedule: Schedule, index: int) -> Record:
    return {
        "airspeed_mps": schedule.airspeeds[index],
        "open_loop": _complex_pairs(schedule.models[index]),
        "closed_loop": _complex_pairs(closed_loop(schedule, index)),
    }


def _complex_pairs(system: control.StateSpace) -> list[list[float]]:
    return [[float(p.real), float(p.imag)] for p in sorted(system.poles(), key=lambda p: (p.real, p.imag))]


def _loop_record(schedule: Schedule, index: int, name: str) -> Record:
    response = frequency_response(open_loop(schedule, index, (name,)), _FREQUENCIES)
    return {
        "loop": name,
        "frequency_rad_s": _FREQUENCIES.tolist(),
        "gain_db": (20.0 * np.log10(np.abs(response))).tolist(),
        "phase_deg": np.degrees(np.unwrap(np.angle(response))).tolist(),
    }


def _response_record(kind: str, response: Response) -> Record:
    return {
        "kind": kind,
        "command": response.command,
        "size": response.size,
        "rise_time_s": _finite(response.rise_time()),
        "overshoot": response.overshoot(),
        "altitude_largest_m": response.largest("altitude"),
        "airspeed_largest_mps": response.largest("airspeed"),
        "time_s": response.time[::4].round(6).tolist(),
        "channels": {name: response.channels[name][::4].tolist() for name in CHANNELS},
    }
