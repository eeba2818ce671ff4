"""Equilibrium flight, straight or turning, level or climbing.

JSBSim's own trim fails for small electric aircraft, because its engine loop steps the propeller at
0.5 s. Here the rigid body is held still, servos and engines settle, and a solver drives the six
accelerations to zero. Powell's hybrid method (MINPACK) finds an existing equilibrium within a dozen
evaluations. If it fails, a bounded least-squares search gives the point of least acceleration and
the limits reached there.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum

import numpy as np
import numpy.typing as npt
from scipy.optimize import fsolve, least_squares

from aircraft.fdm import Fdm
from aircraft.spec import AircraftError
from aircraft.state import RigidBodyState, Vector, body_velocity, level, turn_rates

Array = npt.NDArray[np.float64]

TOLERANCE = 1e-5
"""Largest acceleration that counts as zero [m/s^2, rad/s^2]: a millionth of g."""

_SETTLED = 2e-9
"""Change of acceleration in a step below which engines count as settled [m/s^2, rad/s^2].

With a lag of ten seconds, 2e-6 of the change remains.
"""

_SETTLE_STEPS = 2400
"""Largest number of time steps in which engines may settle: 20 s."""

_GOOD = 0.05
"""Acceleration at which a search ends, over ``TOLERANCE`` [-]: settling leaves the rest."""

_NEAR_LIMIT = 0.05
"""Distance from a limit at which an unknown counts as limited, over its scale [-]."""

_ALPHA_MAX = 0.5
_BETA_MAX = 0.3
_BANK_MAX = 1.2
"""Limits of angle of attack, sideslip and bank in straight flight [rad]; no flight reaches them."""

_TURN_RATE_RATIO_MAX = 3.0
"""Limit of the unknown yaw rate over the yaw rate of a coordinated turn [-]."""

_GUESSED_GRAVITY = 9.81
"""Gravity in the first guess of a turn's yaw rate [m/s^2]; true gravity varies by 0.5 %."""

_SCALE = 0.1
"""Scale of the unknowns [rad, -]; a yaw rate is scaled with the coordinated turn's."""

_CONVERGENCE = 1e-10
"""Relative change of the unknowns at which a solver ends [-]; usually ``_GOOD`` ends it earlier."""

_COST_CONVERGENCE = 1e-12
"""Change of cost and of gradient at which the least squares end: below ``TOLERANCE**2``, 1e-10."""

_EVALUATIONS_MAX = 80
"""Largest number of evaluations of Powell's method; it takes a dozen if there is an equilibrium."""

_ITERATIONS_MAX = 12
"""Largest number of iterations of the bounded least squares, each with a Jacobian."""

_TURN_BACK = 1e3
"""Acceleration that stands for one that is not finite, to repel a search [m/s^2, rad/s^2]."""

_DIFFERENCE = 1e-3
"""Step of differences [rad, -]: large against the remainder of an engine's settling."""

_START_ALPHA = 0.05
"""Angle of attack from which the search begins [rad]: 3 deg, as in cruise."""

_START_THROTTLES = (0.75, 0.5, 0.95)
"""Throttles from which the search begins, one after the other [-].

With too little throttle at high speed, a search can end where JSBSim's propeller barely turns.
"""


class TrimOutcome(Enum):
    """How a search for equilibrium ended."""

    CONVERGED = "converged"
    LIMITED = "held by a limit"
    NOT_CONVERGED = "not converged"
    NOT_FINITE = "not finite"


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
    yaw_rate : in a steady turn also the heading rate [rad/s]
    inputs : control inputs by name [-]
    driven : driven states by name [SI]
    outcome : whether it is an equilibrium
    residuals : remaining accelerations, forward, right, down, p, q, r [m/s^2, rad/s^2]
    limits : control inputs and angles at a limit, in words; if accelerations are not finite, the
        property of the model that is not
    """

    airspeed: float
    altitude: float
    climb_angle: float
    alpha: float
    beta: float
    roll: float
    pitch: float
    rates_body: Vector
    yaw_rate: float
    inputs: Mapping[str, float]
    driven: Mapping[str, float]
    outcome: TrimOutcome
    residuals: tuple[float, ...]
    limits: tuple[str, ...]

    @property
    def residual(self) -> float:
        """Largest remaining acceleration [m/s^2, rad/s^2]; infinite if one is not finite."""
        if not all(math.isfinite(value) for value in self.residuals):
            return math.inf
        return max(abs(value) for value in self.residuals)

    def state(
        self, latitude: float = 0.0, longitude: float = 0.0, yaw: float = 0.0
    ) -> RigidBodyState:
        """Rigid-body state of this equilibrium at a latitude, longitude and yaw [rad]."""
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
        """Course minus yaw [rad]."""
        ahead, right, _ = level(
            body_velocity(self.airspeed, self.alpha, self.beta), self.roll, self.pitch
        )
        return math.atan2(right, ahead)


def trim(
    fdm: Fdm,
    *,
    airspeed: float,
    altitude: float,
    bank: float = 0.0,
    climb_angle: float = 0.0,
    start: Trim | None = None,
) -> Trim:
    """Equilibrium at ``airspeed`` [m/s] and ``altitude`` [m]; parameters are as in ``search_trim``.

    Raises
    ------
    AircraftError : the search does not converge
    """
    found = search_trim(
        fdm, airspeed=airspeed, altitude=altitude, bank=bank, climb_angle=climb_angle, start=start
    )
    if found.outcome is TrimOutcome.CONVERGED:
        return found
    limits = " and ".join(found.limits)
    if found.outcome is TrimOutcome.NOT_FINITE:
        reason = limits
    elif found.residual < TOLERANCE and limits:
        reason = f"{limits} is not enough"
    else:
        reason = (
            f"largest acceleration {found.residual:.2g}{f' with {limits}' if limits else ''}"
            f" against a limit of {TOLERANCE:g}"
        )
    remedy = "choose a condition inside the flight envelope; or correct the model"
    if fdm.spec.envelope is not None:
        remedy += ", or the envelope that its spec states"
    raise AircraftError(
        f"trim of '{fdm.spec.name}' at {airspeed:g} m/s, {altitude:g} m,"
        f" bank {math.degrees(bank):g} deg, climb {math.degrees(climb_angle):g} deg"
        f" did not converge: {reason}; {remedy}"
    )


def search_trim(
    fdm: Fdm,
    *,
    airspeed: float,
    altitude: float,
    bank: float = 0.0,
    climb_angle: float = 0.0,
    start: Trim | None = None,
) -> Trim:
    """Result of a search for an equilibrium; its ``outcome`` says whether it was found.

    Parameters
    ----------
    fdm : the aircraft; its state is changed
    airspeed : true airspeed [m/s], positive
    altitude : [m]
    bank : bank angle of a steady turn, whose yaw rate is solved for [rad]; 0 for straight flight,
        where the small bank that balances the propeller's torque is solved for
    climb_angle : [rad]
    start : a known equilibrium nearby, from which the search begins

    Raises
    ------
    AircraftError : an impossible condition, such as a negative airspeed
    """
    for name, value, low, high, unit in (
        ("airspeed", airspeed, 0.0, math.inf, "m/s"),
        ("altitude", altitude, -math.inf, math.inf, "m"),
        ("bank", math.degrees(bank), -90.0, 90.0, "deg"),
        ("climb angle", math.degrees(climb_angle), -90.0, 90.0, "deg"),
    ):
        if not low < value < high:
            raise AircraftError(
                f"trim of '{fdm.spec.name}': {name} is {value:g} {unit}; it must lie between"
                f" {low:g} and {high:g} {unit}"
            )
    problem = _TrimProblem(
        fdm, airspeed=airspeed, altitude=altitude, bank=bank, climb_angle=climb_angle
    )
    tried: list[Trim] = []
    with fdm.frozen():
        for i, guess in enumerate(problem.guesses(start)):
            # Near a known equilibrium the engines already run at about the right speed.
            found = problem.solve(guess, run_up=start is None or i > 0)
            if found.outcome is TrimOutcome.CONVERGED:
                return found
            tried.append(found)
        return problem.least_acceleration(min(tried, key=lambda t: t.residual))


class _FoundError(Exception):
    """Ends a search at a good point, before MINPACK resolves the remainder of settling."""

    def __init__(self, unknowns: Array) -> None:
        super().__init__()
        self.unknowns = unknowns


class _TrimProblem:
    """Accelerations of the held aircraft as a function of unknowns, and the searches for zero.

    The unknowns are angle of attack, sideslip, bank (straight flight) or yaw rate (turn), and the
    control inputs. With a rudder, zero sideslip is a further condition.
    """

    def __init__(
        self, fdm: Fdm, *, airspeed: float, altitude: float, bank: float, climb_angle: float
    ) -> None:
        self._fdm = fdm
        self._airspeed = airspeed
        self._altitude = altitude
        self._bank = bank
        self._climb_angle = climb_angle
        self._straight = bank == 0.0
        inputs = fdm.spec.inputs
        self._has_rudder = any(i.name == "rudder" for i in inputs)
        self._turn = 0.0 if self._straight else _GUESSED_GRAVITY * math.tan(bank) / airspeed
        turn_max = _BANK_MAX if self._straight else _TURN_RATE_RATIO_MAX * abs(self._turn)
        turn_scale = _SCALE if self._straight else abs(self._turn)
        self._lower = np.array([-_ALPHA_MAX, -_BETA_MAX, -turn_max] + [i.lower for i in inputs])
        self._upper = np.array([_ALPHA_MAX, _BETA_MAX, turn_max] + [i.upper for i in inputs])
        self._scale = np.array([_SCALE, _SCALE, turn_scale] + [_SCALE] * len(inputs))

    def guesses(self, start: Trim | None) -> list[Array]:
        """Points from which to search: a known equilibrium nearby, then the default ones."""
        inputs = self._fdm.spec.inputs
        defaults = [
            np.array(
                [_START_ALPHA, 0.0, self._turn]
                + [throttle if i.name == "throttle" else 0.0 for i in inputs]
            )
            for throttle in _START_THROTTLES
        ]
        if start is None:
            return defaults
        turn = start.roll if self._straight and start.yaw_rate == 0.0 else self._turn
        nearby = [start.alpha, start.beta, turn] + [start.inputs[i.name] for i in inputs]
        return [np.array(nearby), *defaults]

    def solve(self, guess: Array, *, run_up: bool) -> Trim:
        """Result of Powell's method, which ignores limits; ``outcome`` says if one is exceeded."""

        def scaled_residual(z: Array) -> Array:
            # MINPACK's steps are relative and sideslip is zero, so unknowns are scaled to be near
            # 1.
            unknowns = guess + self._scale * (z - 1.0)
            residual = self._residual(unknowns)
            if np.max(np.abs(residual)) < _GOOD * TOLERANCE:
                raise _FoundError(unknowns)
            return residual

        self._start_anew_if_not_finite()

        self._fdm.allow_engine_restart()
        if run_up:
            self._run_up(guess)
        try:
            solution, *_ = fsolve(
                scaled_residual,
                np.ones(len(guess)),
                full_output=True,
                xtol=_CONVERGENCE,
                epsfcn=(_DIFFERENCE / _SCALE) ** 2,
                factor=1.0,
                maxfev=_EVALUATIONS_MAX,
            )
        except _FoundError as found:
            return self._result(found.unknowns)
        return self._result(guess + self._scale * (np.asarray(solution) - 1.0))

    def _start_anew_if_not_finite(self) -> None:
        """Reset JSBSim if an acceleration is not finite: later states would inherit the value."""
        if not all(
            map(math.isfinite, (*self._fdm.acceleration_body(), *self._fdm.angular_acceleration()))
        ):
            self._fdm.reset()

    def _run_up(self, guess: Array) -> None:
        """Settle at full throttle, since an earlier guess may have left a propeller windmilling."""
        inputs = [
            self._upper[3 + k] if i.name == "throttle" else guess[3 + k]
            for k, i in enumerate(self._fdm.spec.inputs)
        ]
        self._residual(np.array([*guess[:3], *inputs]))

    def least_acceleration(self, best: Trim) -> Trim:
        """Point of least acceleration within the limits, or ``best`` if that one is better."""
        for guess in self.guesses(None):
            self._start_anew_if_not_finite()
            if not np.isfinite(self._accelerations(guess)).all():
                continue
            solution = least_squares(
                self._residual,
                guess,
                bounds=(self._lower, self._upper),
                x_scale=self._scale,
                jac=self._jacobian,
                xtol=_CONVERGENCE,
                ftol=_COST_CONVERGENCE,
                gtol=_COST_CONVERGENCE,
                max_nfev=_ITERATIONS_MAX,
            )
            result = self._result(solution.x)
            if result.outcome is TrimOutcome.CONVERGED:
                return result
            if best.outcome is TrimOutcome.NOT_CONVERGED or result.residual < best.residual:
                best = result
        return best

    def _jacobian(self, unknowns: Array) -> Array:
        """Jacobian by differences over absolute steps, taken inward near a limit."""
        at = self._residual(unknowns)
        columns = []
        for i in range(len(unknowns)):
            step = _DIFFERENCE if unknowns[i] + _DIFFERENCE <= self._upper[i] else -_DIFFERENCE
            moved = unknowns.copy()
            moved[i] += step
            columns.append((self._residual(moved) - at) / step)
        return np.column_stack(columns)

    def _residual(self, unknowns: Array) -> Array:
        """Same as ``_accelerations``, but ``_TURN_BACK`` if one of them is not finite."""
        residual = self._accelerations(unknowns)
        if np.isfinite(residual).all():
            return residual
        self._start_anew_if_not_finite()
        return np.full(len(residual), _TURN_BACK)

    def _accelerations(self, unknowns: Array) -> Array:
        """The six accelerations [m/s^2, rad/s^2] and, with a rudder, the sideslip [rad]."""
        fdm = self._fdm
        state, _ = self._state(unknowns)
        fdm.command(self._inputs(unknowns))
        fdm.place(state)
        fdm.settle(_SETTLED, _SETTLE_STEPS)
        residual = [*fdm.acceleration_body(), *fdm.angular_acceleration()]
        if self._has_rudder:
            residual.append(float(unknowns[1]))
        return np.array(residual)

    def _result(self, unknowns: Array) -> Trim:
        state, yaw_rate = self._state(unknowns)
        spec = self._fdm.spec
        residuals = tuple(float(value) for value in self._accelerations(unknowns))
        finite = all(map(math.isfinite, residuals))
        settled = self._fdm.settle(_SETTLED, _SETTLE_STEPS)
        limits = self._limits(unknowns, settled) if finite else (self._not_finite(),)
        inside = bool(np.all(unknowns <= self._upper) and np.all(unknowns >= self._lower))
        if not finite:
            outcome = TrimOutcome.NOT_FINITE
        elif settled and inside and max(abs(value) for value in residuals) < TOLERANCE:
            outcome = TrimOutcome.CONVERGED
        elif limits:
            outcome = TrimOutcome.LIMITED
        else:
            outcome = TrimOutcome.NOT_CONVERGED
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
            outcome=outcome,
            residuals=residuals[:6],
            limits=limits,
        )

    def _not_finite(self) -> str:
        """Properties of the model that are not finite, in words."""
        names = self._fdm.not_finite()
        if not names:
            return "forces are not finite"
        more = f" and {len(names) - 1} more" if len(names) > 1 else ""
        return f"'{names[0]}'{more} not finite: correct it in {self._fdm.spec.files.file.name}"

    def _limits(self, unknowns: Array, settled: bool) -> tuple[str, ...]:
        """Limits that the unknowns are at or beyond, in words."""
        turn = "bank" if self._straight else "yaw rate"
        names = ["angle of attack", "sideslip", turn, *(i.name for i in self._fdm.spec.inputs)]
        near = _NEAR_LIMIT * self._scale
        reached = []
        for name, value, low, high, step in zip(
            names, unknowns, self._lower, self._upper, near, strict=True
        ):
            if value <= low + step:
                reached.append(f"{name} at its lower limit")
            elif value >= high - step:
                reached.append(f"{name} at its upper limit")
        if not settled:
            reached.append("forces that do not come to rest")
        return tuple(reached)

    def _inputs(self, unknowns: Array) -> dict[str, float]:
        return {
            i.name: float(value)
            for i, value in zip(self._fdm.spec.inputs, unknowns[3:], strict=True)
        }

    def _state(self, unknowns: Array) -> tuple[RigidBodyState, float]:
        """Rigid-body state, and yaw rate [rad/s]."""
        alpha, beta, turn = (float(value) for value in unknowns[:3])
        roll, yaw_rate = (turn, 0.0) if self._straight else (self._bank, turn)
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
    """Pitch angle for a climb angle, at given angle of attack, sideslip and roll [rad].

    Source: Stevens and Lewis, Aircraft Control and Simulation, the rate-of-climb constraint.
    """
    a = math.cos(alpha) * math.cos(beta)
    b = math.sin(roll) * math.sin(beta) + math.cos(roll) * math.sin(alpha) * math.cos(beta)
    sin_climb = math.sin(climb_angle)
    square_root = math.sqrt(a * a - sin_climb * sin_climb + b * b)
    return math.atan((a * b + sin_climb * square_root) / (a * a - sin_climb * sin_climb))
