"""Equilibrium flight, straight or turning, level or climbing.

JSBSim's own trim fails for small electric aircraft (its engine loop steps the propeller at 0.5 s), so equilibrium is sought
here on the accelerations themselves: the rigid body is held still, servos and propeller settle, and a bounded least-squares
solver drives the six accelerations to zero.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import approx_fprime, least_squares

from aircraft.errors import TrimError
from aircraft.fdm import Fdm
from aircraft.state import RigidBodyState, body_velocity, level, turn_rates

_TOLERANCE = 1e-5
"""Largest acceleration that counts as zero [m/s^2, rad/s^2]: a millionth of g."""

_ALPHA_MAX = 0.5
_BETA_MAX = 0.3
_BANK_MAX = 1.2
_DIFFERENCE = 1e-5
_START_ALPHA = 0.05
_START_THROTTLES = (0.5, 0.95)
"""Starts of the search. From too little throttle at high speed it can end where JSBSim's propeller barely turns."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Trim:
    """An equilibrium.

    Attributes
    ----------
    airspeed : true airspeed [m/s]
    altitude : [m]
    climb_angle : [rad]
    alpha, beta : angle of attack and sideslip [rad]
    roll, pitch : [rad]
    rates_body : p, q, r [rad/s]
    yaw_rate : rate of yaw, which in a steady turn is the heading rate [rad/s]
    inputs : control inputs by name [-]
    driven : driven states by name [SI]
    residual : largest remaining acceleration [m/s^2, rad/s^2]
    """

    airspeed: float
    altitude: float
    climb_angle: float
    alpha: float
    beta: float
    roll: float
    pitch: float
    rates_body: tuple[float, float, float]
    yaw_rate: float
    inputs: Mapping[str, float]
    driven: Mapping[str, float]
    residual: float

    def state(self, latitude: float = 0.0, longitude: float = 0.0, yaw: float = 0.0) -> RigidBodyState:
        """Return the rigid-body state of this equilibrium at a place [rad] and yaw [rad]."""
        return RigidBodyState(
            latitude=latitude,
            longitude=longitude,
            altitude=self.altitude,
            roll=self.roll,
            pitch=self.pitch,
            yaw=yaw,
            velocity_body=body_velocity(self.airspeed, self.alpha, self.beta),
            rates_body=self.rates_body,
        )

    def course_offset(self) -> float:
        """Return course minus yaw [rad]: where the aircraft goes against where it points."""
        ahead, right, _ = level(body_velocity(self.airspeed, self.alpha, self.beta), self.roll, self.pitch)
        return math.atan2(right, ahead)


def trim(fdm: Fdm, *, airspeed: float, altitude: float, bank: float = 0.0, climb_angle: float = 0.0) -> Trim:
    """Find the equilibrium at ``airspeed`` [m/s] and ``altitude`` [m].

    Parameters
    ----------
    fdm : the aircraft; its state is changed
    airspeed : true airspeed [m/s], positive
    altitude : [m]
    bank : 0 for straight flight (the small bank that balances the propeller's torque is then part of the solution), otherwise the
        bank angle of a steady turn [rad], whose yaw rate is part of the solution
    climb_angle : [rad]

    Raises
    ------
    TrimError : the solver did not converge, or needs more than a control can give
    """
    if not (math.isfinite(airspeed) and airspeed > 0.0):
        raise TrimError(f"trim of '{fdm.spec.name}': airspeed is {airspeed} m/s; it must be finite and above 0")
    for name, value, unit in (("altitude", altitude, "m"), ("bank", bank, "rad"), ("climb angle", climb_angle, "rad")):
        if not math.isfinite(value):
            raise TrimError(f"trim of '{fdm.spec.name}': {name} is {value} {unit}; it must be finite")
    if not abs(bank) < 0.5 * math.pi:
        raise TrimError(f"trim of '{fdm.spec.name}': bank is {math.degrees(bank):g} deg; it must lie within -90 and 90 deg")
    problem = _TrimProblem(fdm, airspeed=airspeed, altitude=altitude, bank=bank, climb_angle=climb_angle)
    residual = math.inf
    with fdm.frozen():
        for throttle in _START_THROTTLES:
            unknowns, converged = problem.solve(throttle)
            left = float(np.max(np.abs(problem.residual(unknowns))))
            if converged and fdm.settle() and left < _TOLERANCE:
                return problem.result(unknowns, left)
            residual = min(residual, left)
    where = f"{airspeed:g} m/s, {altitude:g} m, bank {math.degrees(bank):g} deg, climb {math.degrees(climb_angle):g} deg"
    raise TrimError(
        f"trim of '{fdm.spec.name}' at {where} did not converge: largest acceleration {residual:.2g} against a limit of"
        f" {_TOLERANCE:g}; choose a condition inside the flight envelope"
    )


class _TrimProblem:
    """Unknowns: angle of attack, sideslip, bank or yaw rate, every control input. A rudder adds zero sideslip as a condition."""

    def __init__(self, fdm: Fdm, *, airspeed: float, altitude: float, bank: float, climb_angle: float) -> None:
        self._fdm = fdm
        self._airspeed = airspeed
        self._altitude = altitude
        self._bank = bank
        self._climb_angle = climb_angle
        self._straight = bank == 0.0
        self._rudder = len(fdm.spec.inputs) > 3

    def solve(self, start_throttle: float) -> tuple[npt.NDArray[np.float64], bool]:
        """Return the solver's last point and whether it calls it a solution."""
        inputs = self._fdm.spec.inputs
        third = 0.0 if self._straight else 9.81 * math.tan(self._bank) / self._airspeed
        third_max = _BANK_MAX if self._straight else 10.0
        solution = least_squares(
            self.residual,
            [_START_ALPHA, 0.0, third] + [start_throttle if i.name == "throttle" else 0.0 for i in inputs],
            bounds=(
                [-_ALPHA_MAX, -_BETA_MAX, -third_max] + [i.lower for i in inputs],
                [_ALPHA_MAX, _BETA_MAX, third_max] + [i.upper for i in inputs],
            ),
            jac=self._jacobian if self._rudder else "2-point",
            x_scale=0.1,
            diff_step=[_DIFFERENCE],
            xtol=1e-12,
            ftol=1e-14,
            gtol=1e-14,
            max_nfev=60,
        )
        return solution.x, bool(solution.success)

    def _jacobian(self, unknowns: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Differences over absolute steps: least_squares takes steps relative to an unknown, and a rudder makes sideslip zero."""
        return np.asarray(approx_fprime(unknowns, self.residual, _DIFFERENCE))

    def residual(self, unknowns: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        fdm = self._fdm
        state, _ = self._state(unknowns)
        fdm.command(self._inputs(unknowns))
        fdm.place(state)
        fdm.settle()
        residual = [*fdm.acceleration_body(), *fdm.angular_acceleration()]
        if self._rudder:
            residual.append(float(unknowns[1]))
        return np.array(residual)

    def result(self, unknowns: npt.NDArray[np.float64], residual: float) -> Trim:
        state, yaw_rate = self._state(unknowns)
        spec = self._fdm.spec
        return Trim(
            airspeed=self._airspeed,
            altitude=self._altitude,
            climb_angle=self._climb_angle,
            alpha=float(unknowns[0]),
            beta=float(unknowns[1]),
            roll=state.roll,
            pitch=state.pitch,
            rates_body=state.rates_body,
            yaw_rate=yaw_rate,
            inputs=self._inputs(unknowns),
            driven={s.name: self._fdm.read(s.position) * s.scale for s in spec.driven_states},
            residual=residual,
        )

    def _inputs(self, unknowns: npt.NDArray[np.float64]) -> dict[str, float]:
        return {i.name: float(value) for i, value in zip(self._fdm.spec.inputs, unknowns[3:], strict=True)}

    def _state(self, unknowns: npt.NDArray[np.float64]) -> tuple[RigidBodyState, float]:
        alpha, beta, third = (float(value) for value in unknowns[:3])
        roll, yaw_rate = (third, 0.0) if self._straight else (self._bank, third)
        pitch = pitch_for_climb(alpha, beta, roll, self._climb_angle)
        state = RigidBodyState(
            altitude=self._altitude,
            roll=roll,
            pitch=pitch,
            velocity_body=body_velocity(self._airspeed, alpha, beta),
            rates_body=turn_rates(yaw_rate, roll, pitch),
        )
        return state, yaw_rate


def pitch_for_climb(alpha: float, beta: float, roll: float, climb_angle: float) -> float:
    """Return the pitch angle that gives ``climb_angle`` at these angles, all in rad.

    Source: Stevens and Lewis, Aircraft Control and Simulation, the rate-of-climb constraint.
    """
    a = math.cos(alpha) * math.cos(beta)
    b = math.sin(roll) * math.sin(beta) + math.cos(roll) * math.sin(alpha) * math.cos(beta)
    sin_climb = math.sin(climb_angle)
    root = math.sqrt(a * a - sin_climb * sin_climb + b * b)
    return math.atan((a * b + sin_climb * root) / (a * a - sin_climb * sin_climb))
