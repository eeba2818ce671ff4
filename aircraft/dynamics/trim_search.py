"""The search for an equilibrium: accelerations as a function of unknowns, and the solvers that zero
them.
"""

import math

import numpy as np
import numpy.typing as npt
from scipy.optimize import fsolve, least_squares

from aircraft.dynamics.equilibrium import Trim, TrimOutcome
from aircraft.simulation.fdm import Fdm
from aircraft.simulation.state import RigidBodyState, body_velocity, turn_rates

TOLERANCE = 1e-5
"""Largest acceleration that counts as zero [m/s^2, rad/s^2]: a millionth of g."""

_SETTLED = 2e-9
"""Change of acceleration a step below which engines count as settled: 2e-6 from the end with a lag
of ten seconds.
"""

_SETTLE_STEPS = 2400
"""Largest number of time steps in which engines may settle: 20 s."""

_GOOD = 0.05
"""Acceleration at which a search ends, over ``TOLERANCE`` [-]: the rest is for the remaining
settling.
"""

_NEAR_LIMIT = 0.05
"""Distance from a limit at which an unknown counts as at it, over its scale [-]: bounded searches
stop short.
"""

_ALPHA_MAX = 0.5
_BETA_MAX = 0.3
_BANK_MAX = 1.2
"""Limits of the unknown angles [rad], wider than any flight: angle of attack beyond stall, 29 deg;
sideslip, 17 deg; the bank that balances a propeller's torque in straight flight, 69 deg."""

_TURN_RATE_RATIO_MAX = 3.0
"""Limit of the unknown yaw rate, over that of a coordinated turn [-]."""

_GUESSED_GRAVITY = 9.81
"""Gravity in the guess of a turn's yaw rate, from which the search begins [m/s^2]; the true one
varies by 0.5 %.
"""

_SCALE = 0.1
"""Size of the unknowns [rad, -]; the yaw rate's is the turn's own."""

_CONVERGENCE = 1e-10
"""Relative change of the unknowns at which a solver ends [-]: so small that ``_GOOD`` nearly always
ends it before.
"""

_COST_CONVERGENCE = 1e-12
"""Change of cost and of gradient at which the least squares end: below the square of ``TOLERANCE``,
1e-10.
"""

_EVALUATIONS_MAX = 80
"""Largest number of evaluations of Powell's method, which takes a dozen where there is an
equilibrium.
"""

_ITERATIONS_MAX = 12
"""Largest number of iterations of the bounded least squares, each with a Jacobian of its own."""

_DIFFERENCE = 1e-3
"""Step of differences [rad, -]: large against what is left of an engine's settling."""

_START_ALPHA = 0.05
"""Angle of attack from which the search begins [rad]: 3 deg, as in cruise."""


_START_THROTTLES = (0.75, 0.5, 0.95)
"""Throttles from which the search begins, one after the other [-]. From too little throttle at high
speed it can end where JSBSim's propeller barely turns."""


class _FoundError(Exception):
    """Ends a search at its first good point: MINPACK would seek digits that a settling engine does
    not have.
    """

    def __init__(self, unknowns: npt.NDArray[np.float64]) -> None:
        super().__init__()
        self.unknowns = unknowns


class TrimProblem:
    """Unknowns: angle of attack, sideslip, bank or yaw rate, control inputs. A rudder adds the
    condition of no sideslip."""

    def __init__(
        self, fdm: Fdm, *, airspeed: float, altitude: float, bank: float, climb_angle: float
    ) -> None:
        self._fdm = fdm
        self._airspeed = airspeed
        self._altitude = altitude
        self._bank = bank
        self._climb_angle = climb_angle
        self._straight = bank == 0.0
        self._rudder = any(i.name == "rudder" for i in fdm.spec.inputs)
        self._turn = 0.0 if self._straight else _GUESSED_GRAVITY * math.tan(bank) / airspeed
        inputs = fdm.spec.inputs
        turn_max = _BANK_MAX if self._straight else _TURN_RATE_RATIO_MAX * abs(self._turn)
        self._lower = np.array([-_ALPHA_MAX, -_BETA_MAX, -turn_max] + [i.lower for i in inputs])
        self._upper = np.array([_ALPHA_MAX, _BETA_MAX, turn_max] + [i.upper for i in inputs])
        self._scale = np.array(
            [_SCALE, _SCALE, _SCALE if self._straight else abs(self._turn)] + [_SCALE] * len(inputs)
        )

    def guesses(self, start: Trim | None) -> list[npt.NDArray[np.float64]]:
        """Return the points from which to search: a known equilibrium nearby, then the default
        ones.
        """
        inputs = self._fdm.spec.inputs
        blank = [
            np.array(
                [_START_ALPHA, 0.0, self._turn]
                + [throttle if i.name == "throttle" else 0.0 for i in inputs]
            )
            for throttle in _START_THROTTLES
        ]
        if start is None:
            return blank
        third = start.roll if self._straight and start.yaw_rate == 0.0 else self._turn
        return [
            np.array([start.alpha, start.beta, third] + [start.inputs[i.name] for i in inputs]),
            *blank,
        ]

    def solve(self, guess: npt.NDArray[np.float64], *, run_up: bool) -> Trim:
        """Return the result of Powell's method from a guess; a solution beyond a limit is not an
        equilibrium.
        """

        def scaled(z: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
            # MINPACK steps relative to an unknown, and sideslip is zero: so every unknown is near
            # one.
            unknowns = guess + self._scale * (z - 1.0)
            residual = self.residual(unknowns)
            if np.max(np.abs(residual)) < _GOOD * TOLERANCE:
                raise _FoundError(unknowns)
            return residual

        self._fdm.revive()
        if run_up:
            self._run_up(guess)
        step = (_DIFFERENCE / _SCALE) ** 2
        try:
            solution, *_ = fsolve(
                scaled,
                np.ones(len(guess)),
                full_output=True,
                xtol=_CONVERGENCE,
                epsfcn=step,
                factor=1.0,
                maxfev=_EVALUATIONS_MAX,
            )
        except _FoundError as found:
            return self._result(found.unknowns)
        return self._result(guess + self._scale * (np.asarray(solution) - 1.0))

    def _run_up(self, guess: npt.NDArray[np.float64]) -> None:
        """Settle at full throttle first: an earlier guess may have left a governed propeller
        windmilling.
        """
        full = [
            self._upper[3 + k] if i.name == "throttle" else guess[3 + k]
            for k, i in enumerate(self._fdm.spec.inputs)
        ]
        self.residual(np.array([*guess[:3], *full]))

    def nearest(self, best: Trim) -> Trim:
        """Return the point within all limits where the accelerations are least, or the best found
        without limits.
        """
        for guess in self.guesses(None):
            solution = least_squares(
                self.residual,
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

    def _jacobian(self, unknowns: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Differences over absolute steps, inward where a limit is near."""
        at = self.residual(unknowns)
        columns = []
        for i in range(len(unknowns)):
            step = _DIFFERENCE if unknowns[i] + _DIFFERENCE <= self._upper[i] else -_DIFFERENCE
            moved = unknowns.copy()
            moved[i] += step
            columns.append((self.residual(moved) - at) / step)
        return np.column_stack(columns)

    def residual(self, unknowns: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Return the six accelerations and, with a rudder, the sideslip."""
        fdm = self._fdm
        state, _ = self._state(unknowns)
        fdm.command(self._inputs(unknowns))
        fdm.place(state)
        fdm.settle(_SETTLED, _SETTLE_STEPS)
        residual = [*fdm.acceleration_body(), *fdm.angular_acceleration()]
        if self._rudder:
            residual.append(float(unknowns[1]))
        return np.array(residual)

    def _result(self, unknowns: npt.NDArray[np.float64]) -> Trim:
        state, yaw_rate = self._state(unknowns)
        spec = self._fdm.spec
        residuals = tuple(float(value) for value in self.residual(unknowns))
        settled = self._fdm.settle(_SETTLED, _SETTLE_STEPS)
        limits = self._limits(unknowns, settled)
        converged = settled and max(abs(value) for value in residuals) < TOLERANCE
        inside = bool(np.all(unknowns <= self._upper) and np.all(unknowns >= self._lower))
        missed = TrimOutcome.LIMITED if limits else TrimOutcome.NOT_CONVERGED
        outcome = TrimOutcome.CONVERGED if converged and inside else missed
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

    def _limits(self, unknowns: npt.NDArray[np.float64], settled: bool) -> tuple[str, ...]:
        """Return the limits that the unknowns are at or beyond, in words."""
        names = [
            "angle of attack",
            "sideslip",
            "bank" if self._straight else "yaw rate",
            *(i.name for i in self._fdm.spec.inputs),
        ]
        near = _NEAR_LIMIT * self._scale
        at = [
            f"{name} at its {'lower' if value <= low + step else 'upper'} limit"
            for name, value, low, high, step in zip(
                names, unknowns, self._lower, self._upper, near, strict=True
            )
            if value <= low + step or value >= high - step
        ]
        return (*at, *(() if settled else ("forces that do not come to rest",)))

    def _inputs(self, unknowns: npt.NDArray[np.float64]) -> dict[str, float]:
        return {
            i.name: float(value)
            for i, value in zip(self._fdm.spec.inputs, unknowns[3:], strict=True)
        }

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
    square_root = math.sqrt(a * a - sin_climb * sin_climb + b * b)
    return math.atan((a * b + sin_climb * square_root) / (a * a - sin_climb * sin_climb))
