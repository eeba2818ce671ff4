"""Record of an autopilot's design, as plain data for the report."""

import math
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np

from aircraft.fdm import TIME_STEP, Fdm
from aircraft.model import Perturbation, has_play
from aircraft.spec import Envelope
from aircraft.trim import Trim, TrimOutcome, search_trim
from common.physics import heading_rate_for_bank
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.flight.limit_cycle import (
    ALTITUDE_MIN,
    BANK_MIN,
    LimitCycle,
    measure_limit_cycle,
)
from innerloop.flight.responses import (
    Response,
    flown_step,
    measure_lag,
    model_step,
    predicted_step,
    verify_model,
)
from innerloop.flight.turn_reversal import perturbed_aircraft, reversal_record
from innerloop.law import ControlLaw, linear_controller
from innerloop.margins import BREAK_NAMES, NOMINAL, REQUIRED, Check, Loops, Margin
from innerloop.robustness import CASES
from innerloop.schedule import LEVEL_GAINS, Schedule
from innerloop.store import Design, Record

_STEP_DURATION = 36.0
"""Duration of a step response times the frequency of the heading-rate response [rad]."""

_SAMPLES = 360
"""Approximate number of samples of a recorded response [-]."""

_FREQUENCIES = np.logspace(-2.5, 2.2, 220)
"""Frequencies of the recorded loop gains [rad/s]."""

_CLIMB_ANGLES_DEG = (-3.0, -1.5, 1.5, 3.0)
"""Climb angles of the recorded equilibria [deg]."""

_UPSET = {"altitude": "m", "airspeed": "mps"}
"""Quantities that a step of another command should not move, and their units."""

_CHANNEL_NAMES = {
    "beta": "sideslip",
    **{f"{name}_command": name for name in ("elevator", "aileron", "throttle")},
}
"""Names of channels in reports, if they differ from the closed loop's."""


def design_record(design: Design, root: Path) -> Record:
    """Return trims, poles, margins, loop gains and responses of a design, as plain data.

    Responses are predicted, and flown in JSBSim from the ``root`` of ``write_root``. For servos
    with play the record also has the limit cycle.
    """
    schedule = design.schedule
    spec, envelope = schedule.spec, schedule.envelope
    aircraft = perturbed_aircraft(spec, root, Perturbation())
    level = schedule.level(schedule.middle)
    slow_lag = measure_lag(aircraft, level, envelope.bank)
    nominal = [check for check in design.checks if check.case == NOMINAL]
    perturbed = [check for check in design.checks if check.case != NOMINAL]
    record = {
        "aircraft": spec.name,
        "title": spec.title,
        "source": spec.source,
        "altitude_m": schedule.altitude,
        "envelope": _envelope_record(envelope),
        "inputs": [
            {"name": i.name, "lower": i.lower, "upper": i.upper, "is_effect": bool(i.effectiveness)}
            for i in spec.inputs
        ],
        "design_airspeed_mps": level.airspeed,
        "airspeeds_mps": list(schedule.airspeeds),
        "banks_deg": [math.degrees(bank) for bank in schedule.banks],
        "weights": asdict(schedule.weights),
        "bandwidths_rad_s": asdict(design.bandwidths),
        "autopilot_rate_hz": 1.0 / (schedule.period * TIME_STEP),
        "model_frequency_rad_s": schedule.weights.model_frequency,
        "model_damping": schedule.weights.model_damping,
        "trims": [
            _trim_record(t, bank)
            for row in schedule.trims
            for t, bank in zip(row, schedule.banks, strict=True)
        ]
        + _climbs(schedule),
        "poles": _poles(schedule),
        "margins": [row for check in nominal for row in _margin_records(check)],
        "robustness": [_robustness_record(check) for check in perturbed],
        "required": asdict(REQUIRED),
        "loops": _loops(schedule),
        "responses": _responses(schedule, aircraft),
        "verification": verify_model(
            Fdm(spec), schedule.models[schedule.middle][LEVEL_GAINS], level
        ),
        "heading_rate_lag_s": slow_lag,
        "turn_reversal": reversal_record(spec, root, level, envelope.bank, slow_lag),
    }
    if has_play(root):
        # A new simulation flies this last, so that the other flights stay the same to the last bit.
        alone = perturbed_aircraft(spec, root, Perturbation())
        record["limit_cycle"] = _limit_cycle_record(measure_limit_cycle(alone, level))
    return record


def step_sizes(schedule: Schedule) -> dict[str, float]:
    """Return the sizes of the command steps, to two digits [rad/s, m/s, m].

    The heading rate steps by half its value in the steepest turn of the guidance. Airspeed and
    altitude step by half their largest unclipped error, the airspeed by at most a quarter of the
    envelope.
    """
    turn = heading_rate_for_bank(schedule.envelope.bank, schedule.level(schedule.middle).airspeed)
    room = 0.25 * (schedule.envelope.airspeed_max - schedule.envelope.airspeed_min)
    sizes = {
        "heading_rate": 0.5 * turn,
        "airspeed": min(0.5 * schedule.weights.airspeed_error_max, room),
        "altitude": 0.5 * schedule.weights.altitude_error_max,
    }
    return {name: float(f"{size:.2g}") for name, size in sizes.items()}


def _envelope_record(envelope: Envelope) -> Record:
    return {
        "airspeed_min_mps": envelope.airspeed_min,
        "airspeed_max_mps": envelope.airspeed_max,
        "airspeed_mps": envelope.airspeed,
        "stall_airspeed_mps": _finite(envelope.stall),
        "bank_deg": math.degrees(envelope.bank),
        "bank_max_deg": math.degrees(envelope.bank_max),
        "notes": list(envelope.notes),
    }


def _limit_cycle_record(found: LimitCycle) -> Record:
    return {
        "is_flown": found.is_flown,
        "period_s": _finite(found.period),
        "altitude_m": found.altitude,
        "bank_rad": found.bank,
        "counted_from": {"altitude_m": ALTITUDE_MIN, "bank_rad": BANK_MIN},
    }


def _trim_record(t: Trim, bank: float) -> Record:
    """Return the record of an equilibrium; in straight flight the grid's ``bank`` is 0 [rad]."""
    return {
        "airspeed_mps": t.airspeed,
        "bank_rad": bank,
        "roll_rad": t.roll,
        "climb_angle_rad": t.climb_angle,
        "alpha_rad": t.alpha,
        "sideslip_rad": t.beta,
        "pitch_rad": t.pitch,
        "yaw_rate_rad_s": t.yaw_rate,
        "residual": t.residual,
        "limits": list(t.limits),
        **dict(t.inputs),
        **dict(t.driven),
    }


def _climbs(schedule: Schedule) -> list[Record]:
    """Return the equilibria in climbs and descents at the middle airspeed."""
    fdm, level = Fdm(schedule.spec), schedule.level(schedule.middle)
    found = [
        search_trim(
            fdm,
            airspeed=level.airspeed,
            altitude=schedule.altitude,
            climb_angle=math.radians(angle),
            start=level,
        )
        for angle in _CLIMB_ANGLES_DEG
    ]
    return [_trim_record(t, 0.0) for t in found if t.outcome is TrimOutcome.CONVERGED]


def _point_record(check: Check) -> Record:
    return {
        "airspeed_mps": check.airspeed,
        "bank_rad": check.bank,
        "between": check.between,
        "stable": check.stable,
    }


def _margin_records(check: Check) -> list[Record]:
    return [
        _point_record(check) | {f.name: _finite(getattr(margin, f.name)) for f in fields(Margin)}
        for margin in check.margins
    ]


def _robustness_record(check: Check) -> Record:
    gain, phase = check.worst_gain, check.worst_phase
    return {
        "case": check.case,
        "periods_late": CASES[check.case].periods_late,
        **_point_record(check),
        "gain_db": _finite(gain.gain_db),
        "gain_loop": gain.loop,
        "phase_deg": _finite(phase.phase_deg),
        "phase_loop": phase.loop,
    }


def _finite(value: float | str) -> float | str | None:
    """Return a value for JSON, with None for infinity and NaN."""
    return value if isinstance(value, str) or np.isfinite(value) else None


def _poles(schedule: Schedule) -> list[Record]:
    law = ControlLaw(schedule)
    records = []
    for i, row in enumerate(schedule.models):
        for j, model in enumerate(row):
            at = schedule.gain_trim(i, j)
            loops = Loops(model, linear_controller(law, at), schedule.delay)
            records.append(
                {
                    "airspeed_mps": at.airspeed,
                    "bank_rad": schedule.gain_banks[j],
                    "open_loop": _pairs(model.poles()),
                    "closed_loop": _pairs(loops.poles()),
                }
            )
    return records


def _pairs(poles: Any) -> list[list[float]]:
    """Return real and imaginary parts of poles, in ascending order."""
    return [[float(p.real), float(p.imag)] for p in sorted(poles, key=lambda p: (p.real, p.imag))]


def _loops(schedule: Schedule) -> list[Record]:
    level = schedule.level(schedule.middle)
    model = schedule.models[schedule.middle][LEVEL_GAINS]
    loops = Loops(
        model,
        linear_controller(ControlLaw(schedule), level),
        schedule.delay,
        frequencies=_FREQUENCIES,
    )
    records = []
    for name in loops.breaks:
        response = loops.opened(name)
        records.append(
            {
                "loop": BREAK_NAMES.get(name, name),
                "airspeed_mps": level.airspeed,
                "bank_rad": 0.0,
                "frequency_rad_s": _FREQUENCIES.tolist(),
                "gain_db": (20.0 * np.log10(np.abs(response))).tolist(),
                "phase_deg": np.degrees(np.unwrap(np.angle(response))).tolist(),
            }
        )
    return records


def _responses(schedule: Schedule, aircraft: AutopilotedAircraft) -> list[Record]:
    weights = schedule.weights
    level = schedule.level(schedule.middle)
    records = []
    for command, size in step_sizes(schedule).items():
        if command == "heading_rate":
            time = _STEP_DURATION / weights.model_frequency
            records.append(_response_record("model", model_step(schedule, size, time)))
        else:
            time = _STEP_DURATION / min(weights.model_frequency, 2.0 / weights.anti_windup_rate)
        predicted = predicted_step(schedule, schedule.middle, command, size, time)
        flown = flown_step(aircraft, level, command, size, time)
        records.append(_response_record("predicted", predicted))
        records.append(_response_record("flown", flown))
    return records


def _response_record(kind: str, response: Response) -> Record:
    stride = max(1, len(response.time) // _SAMPLES)
    return {
        "kind": kind,
        "command": response.command,
        "size": response.size,
        "rise_time_s": _finite(response.rise_time()),
        "overshoot": response.overshoot(),
        **{
            f"{name}_largest_{unit}": response.largest(name)
            for name, unit in _UPSET.items()
            if name in response.channels and name != response.command
        },
        "time_s": response.time[::stride].round(6).tolist(),
        "channels": {
            _CHANNEL_NAMES.get(name, name): values[::stride].tolist()
            for name, values in response.channels.items()
        },
    }
