"""The autopilot as a linear system about an equilibrium: what margins and predicted responses are
computed from.
"""

from collections.abc import Mapping

import numpy as np

from aircraft.linearise import LinearModel
from aircraft.trim import Trim
from innerloop.law.control_law import COMMANDS, STATES, ControlLaw, measurements

_STEP = 1e-4
"""Step of differences [SI]: the law has products and piecewise linear tables, so only rounding
limits it.
"""


def linear_controller(law: ControlLaw, trim: Trim) -> LinearModel:
    """Return the autopilot, linear about an equilibrium of the aircraft.

    Inputs are ``COMMANDS`` and the measurements, outputs are the control inputs, all as deviations
    from trim. States are ``STATES``. At an edge between two pieces of a table the slope is the mean
    of both.
    """
    point = operating_point(law, trim)
    measured_names = measurements(law.schedule)
    inputs = (*COMMANDS, *measured_names)
    controls = law.schedule.controls

    def column(name: str) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
        sides = []
        for sign in (1.0, -1.0):
            moved = {**point, name: point[name] + sign * _STEP}
            rates, outputs = evaluate_at(law, moved)
            sides.append(np.array([*(rates[s] for s in STATES), *(outputs[c] for c in controls)]))
        return np.asarray((sides[0] - sides[1]) / (2.0 * _STEP))

    by_state = np.column_stack([column(name) for name in STATES])
    by_input = np.column_stack([column(name) for name in inputs])
    n = len(STATES)
    kept = [i for i, name in enumerate(STATES) if name != "rudder_integral" or "rudder" in controls]
    return LinearModel(
        A=by_state[:n][np.ix_(kept, kept)],
        B=by_input[:n][kept],
        C=by_state[n:][:, kept],
        D=by_input[n:],
        state_labels=tuple(STATES[i] for i in kept),
        input_labels=inputs,
        output_labels=controls,
    )


def operating_point(law: ControlLaw, trim: Trim) -> dict[str, float]:
    """Return commands, measurements and the autopilot's states while the aircraft flies an
    equilibrium under it.

    In straight flight it counts as level: propeller and ailerons bank it by a tenth of a degree or
    so, which is beyond the edge of the tables at 0, and it turns to both sides from there.
    """
    roll = trim.roll if trim.yaw_rate else 0.0
    model_bank = law.model_bank(trim.yaw_rate, trim.airspeed, trim.airspeed)
    return {
        "airspeed_command": trim.airspeed,
        "altitude_command": trim.altitude,
        "heading_rate_command": trim.yaw_rate,
        "airspeed": trim.airspeed,
        "altitude": trim.altitude,
        "climb_rate": 0.0,
        "pitch": trim.pitch,
        "roll": roll,
        "beta": trim.beta,
        "heading_rate": trim.yaw_rate,
        **dict(zip("pqr", trim.rates_body, strict=True)),
        **dict.fromkeys(STATES, 0.0),
        "bank_integral": roll - model_bank,
        "model_rate": trim.yaw_rate,
    }


def evaluate_at(
    law: ControlLaw, point: Mapping[str, float]
) -> tuple[dict[str, float], dict[str, float]]:
    """Return the result of ``ControlLaw.evaluate`` at a point of commands, measurements and states
    by name.
    """
    return law.evaluate(point, point, point)
