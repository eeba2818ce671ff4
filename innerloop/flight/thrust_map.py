"""Measure thrust over airspeed and throttle, and drag and angle of attack over airspeed and lift.

Thrust is measured with the body held still. Drag and angle of attack are measured in the equilibria
of the autopilot's tables, where drag equals thrust.
"""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from aircraft.fdm import TIME_STEP, Fdm
from aircraft.trim import Trim
from innerloop.schedule import Schedule

FORWARD_FORCE = "forces/fbx-total-lbs"
DOWNWARD_FORCE = "forces/fbz-total-lbs"
"""Force of air and engines downwards [lbf]; an accelerometer measures it over the mass."""

THRUST = "forces/fbx-prop-lbs"
"""Force of the engines along the body's longitudinal axis [lbf]."""

WEIGHT = "inertia/weight-lbs"
"""Weight of the aircraft [lbf]."""

_THROTTLE_STEPS = 10
"""Steps of the throttle in the table from idle to full [-]: a propeller brakes at low throttle."""

_SETTLED = 1e-6
"""Change of acceleration in a step below which engines count as settled [m/s^2, rad/s^2]."""

_SPOOLED = 0.9
"""Fraction of the change of thrust after which engines count as spooled up [-]."""

_SPOOL_MAX = 20.0
"""Time limit for engines to spool up from idle to full throttle [s]."""

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class ThrustMap:
    """Thrust and drag of one aircraft over its weight [-].

    Let n be the lift over the weight and V the airspeed. The angle of attack is a0 + a1 n/V^2 (a
    linear lift curve), and the drag over the weight is V^2 (c0 + c1 n/V^2 + c2 (n/V^2)^2) (a
    parabolic polar).

    Attributes
    ----------
    airspeeds, throttles : axes of the table [m/s, -]
    thrust : thrust over weight with settled engines, shape (airspeeds, throttles) [-]
    attack : a0, a1 [rad, rad m^2/s^2]
    polar : c0, c1, c2 [s^2/m^2, -, m^2/s^2]
    spool_time : time from the command of full throttle at idle until 90 % of the change of thrust
        [s]
    """

    airspeeds: tuple[float, ...]
    throttles: tuple[float, ...]
    thrust: tuple[tuple[float, ...], ...]
    attack: tuple[float, float]
    polar: tuple[float, float, float]
    spool_time: float


def measure_thrust(fdm: Fdm, schedule: Schedule) -> ThrustMap:
    """Return the thrust and drag of an aircraft over its weight.

    Parameters
    ----------
    fdm : the bare aircraft; its state is changed
    schedule : tables of the autopilot, with the equilibria
    """
    throttle = schedule.spec.input("throttle")
    throttles = np.linspace(throttle.lower, throttle.upper, _THROTTLE_STEPS + 1)
    level = [schedule.level(i) for i in range(len(schedule.airspeeds))]
    table = [[_settled_forces(fdm, trim, float(at))[0] for at in throttles] for trim in level]
    equilibria = [trim for row in schedule.trims for trim in row]
    loadings, squared, attacks, drags = [], [], [], []
    for trim in equilibria:
        thrust, forward, lift = _settled_forces(fdm, trim, trim.inputs["throttle"])
        along = forward * math.cos(trim.alpha) - lift * math.sin(trim.alpha)
        loadings.append(lift / trim.airspeed**2)
        squared.append(trim.airspeed**2)
        attacks.append(trim.alpha)
        drags.append(thrust - along)
    loading, speed_squared = np.array(loadings), np.array(squared)
    polar = _fit(np.array([speed_squared * loading**power for power in range(3)]).T, drags)
    attack = _fit(np.array([loading**power for power in range(2)]).T, attacks)
    return ThrustMap(
        airspeeds=tuple(schedule.airspeeds),
        throttles=tuple(throttles.tolist()),
        thrust=tuple(map(tuple, table)),
        attack=(attack[0], attack[1]),
        polar=(polar[0], polar[1], polar[2]),
        spool_time=_spool_time(fdm, level[schedule.middle], throttle.lower, throttle.upper),
    )


def _settled_forces(fdm: Fdm, trim: Trim, throttle: float) -> tuple[float, float, float]:
    """Return settled thrust, forward force and upward force at a throttle, over the weight [-]."""
    fdm.place(trim.state())
    fdm.command({**trim.inputs, "throttle": throttle})
    with fdm.frozen():
        fdm.settle(_SETTLED)
    weight = fdm.read(WEIGHT)
    return (
        fdm.read(THRUST) / weight,
        fdm.read(FORWARD_FORCE) / weight,
        -fdm.read(DOWNWARD_FORCE) / weight,
    )


def _spool_time(fdm: Fdm, trim: Trim, idle: float, full: float) -> float:
    """Return the time from idle to 90 % of the change of thrust, at full throttle [s]."""
    end = _settled_forces(fdm, trim, full)[0] * fdm.read(WEIGHT)
    begin = _settled_forces(fdm, trim, idle)[0] * fdm.read(WEIGHT)
    fdm.command({**trim.inputs, "throttle": full})
    steps = round(_SPOOL_MAX / TIME_STEP)
    late = 0
    with fdm.frozen():
        for step in range(1, steps + 1):
            fdm.step()
            if (fdm.read(THRUST) - begin) < _SPOOLED * (end - begin):
                late = step
            elif step > 2 * late + 1 / TIME_STEP:
                break
    return (late + 1) * TIME_STEP


def _fit(columns: Array, values: list[float]) -> list[float]:
    """Return the least-squares coefficients of the columns."""
    coefficients: list[float] = np.linalg.lstsq(columns, np.array(values), rcond=None)[0].tolist()
    return coefficients
