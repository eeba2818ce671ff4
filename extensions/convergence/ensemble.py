"""Thousands of vehicles that track their references, integrated at once.

Each trajectory has a separate time and step size. One that ends makes room for the next.
"""

from collections.abc import Callable
from dataclasses import dataclass, fields
from enum import Enum

import numpy as np
import numpy.typing as npt

from extensions.convergence.motion import MOTIONS, RelativeMotion, Steering, Vehicle
from extensions.convergence.references import Array, TurningReferences

DISTANCE_CONVERGED = 0.02
"""Distance within which a vehicle is on its reference [m]."""

PHI_CONVERGED = 2e-4
"""|phi| within which a vehicle is on its reference [rad]."""


class Outcome(Enum):
    """How a trajectory ended."""

    CONVERGED = "converged"
    TIME_UP = "time_up"
    STEPS_UP = "steps_up"
    NOT_FINITE = "not_finite"


@dataclass(frozen=True, slots=True, kw_only=True)
class Tolerances:
    """Tolerances of the integration, for one step.

    Attributes
    ----------
    relative : of the distance to the reference [-]
    absolute : of the position, in addition [m]
    step_max : largest step [s]
    steps_max : steps, rejected ones included, after which a trajectory is given up
    """

    relative: float = 1e-6
    absolute: float = 1e-4
    step_max: float = 10.0
    steps_max: int = 2_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class EnsembleResult:
    """How n trajectories ended; arrays have shape (n,).

    Distances and commands are those at the ends of steps, which are some seconds long.

    Attributes
    ----------
    outcome, message : how it ended, and in words
    settling_time : last time at which the distance was at least the settling band, linear between
        steps [s]; NaN if that is the end
    duration : time of the trajectory [s]
    distance : at the end [m]
    distance_max : largest of the trajectory [m]
    phi_0, phi : vehicle course relative to that of z, at the start and at the end [rad]
    heading_rate_max : largest commanded |omega| [rad/s]
    steps : of the integration, rejected ones included
    """

    outcome: tuple[Outcome, ...]
    message: tuple[str, ...]
    settling_time: Array
    duration: Array
    distance: Array
    distance_max: Array
    phi_0: Array
    phi: Array
    heading_rate_max: Array
    steps: npt.NDArray[np.int64]


Observer = Callable[[npt.NDArray[np.int64], Array, Array, Array, Array], None]
"""Called with index, time, state, phi and command of the trajectories that took a step."""


def fly_ensemble(
    law: Steering,
    vehicle: Vehicle,
    references: TurningReferences,
    *,
    to_reference: npt.ArrayLike,
    course: npt.ArrayLike,
    settling_band: float,
    time_max: npt.ArrayLike,
    tolerances: Tolerances | None = None,
    places: int = 500,
    observe: Observer | None = None,
) -> EnsembleResult:
    """Return how trajectories ended, flown until each vehicle is on its reference or time is up.

    A vehicle is on its reference once d and phi are within ``DISTANCE_CONVERGED`` and
    ``PHI_CONVERGED``. From there d stays small under both laws of the paper. Under the Lyapunov law
    V_2 never rises, so that d is at most sqrt(d_0^2 + phi_0^2/k_1), 0.021 m at k_1 = 0.001. Under
    the cascade law the rate of d^2 is at most rho V phi^2 and phi decays exponentially, so that d^2
    gains at most rho V phi_0^2/(2 gain), (0.004 m)^2 at 1.5 1/s and R = 60 m. With cut commands
    this holds if the reference leaves a margin of 0.001 rad/s, because then nothing is cut: |omega
    - omega_r| is at most V (phi_r + phi)/R + 2 phi_r |omega_r| + gain phi, with phi_r about d/R.
    For cut commands and a reference that takes all of omega_max the result only says that the
    vehicle came to its reference.

    Parameters
    ----------
    law, vehicle : steering law and vehicle, the same for all
    references : of n vehicles
    to_reference : d at time 0, north and east, shape (2, n) [m]
    course : chi at time 0, shape (n,) [rad]
    settling_band : distance below which a trajectory counts as settled [m]
    time_max : limit, for all or for each, shape () or (n,) [s]
    tolerances : of the integration
    places : number of trajectories integrated at once; they start in the given order, and it is
        fastest with the longest ones first
    observe : called at the start and after every step
    """
    motion = MOTIONS[law](vehicle, references)
    state = motion.start(np.array(to_reference, dtype=float), np.array(course, dtype=float))
    limit = np.broadcast_to(np.asarray(time_max, dtype=float), (len(references),))
    flight = _Integration(motion, state, limit, settling_band, tolerances or Tolerances(), observe)
    flight.start(places)
    while len(flight.index):
        flight.step()
    return flight.result()


class _Integration:
    """``_all`` has every trajectory, at its start or at its end; ``_now`` those under way."""

    def __init__(
        self,
        motion: RelativeMotion,
        state: Array,
        limit: Array,
        band: float,
        tolerances: Tolerances,
        observe: Observer | None,
    ) -> None:
        count = state.shape[1]
        self._band = band
        self._tolerances = tolerances
        self._observe = observe
        time = np.zeros(count)
        rates = motion.rates(time, state)
        distance = np.hypot(state[0], state[1])
        self._phi_0 = motion.phi(time, state)
        command = motion.command(time, state, rates)
        self._all = _Fields(
            time=time,
            limit=limit.copy(),
            # Short compared with the fastest motion, that of phi under the Lyapunov law; steps grow
            # up to fivefold at a time.
            step=1e-2 / (1.0 + np.abs(rates[2:]).sum(axis=0)),
            state=state,
            rates=rates,
            distance=distance,
            distance_max=distance.copy(),
            command_max=np.abs(command),
            last_outside=np.where(distance >= band, 0.0, -1.0),
            steps=np.zeros(count),
        )
        self._whole = motion
        self._outcome: list[Outcome] = [Outcome.NOT_FINITE] * count
        self._message = [""] * count
        self._phi = np.empty(count)
        self._next = 0
        self.index = np.arange(0)
        if observe is not None:
            observe(np.arange(count), time, state, self._phi_0, command)

    def start(self, places: int) -> None:
        """Start the first trajectories."""
        self._next = min(places, len(self._message))
        self.index = np.arange(self._next)
        self._motion = self._whole.take(self.index)
        self._now = self._all.take(self.index)

    def step(self) -> None:
        """Try one step of every trajectory under way, and retire those that are finished."""
        now = self._now
        remaining = now.limit - now.time
        step = np.minimum(now.step, remaining)
        state, rates, error = dormand_prince_step(
            self._motion.rates, now.time, now.state, now.rates, step
        )
        norm = self._error_norm(state, error)
        finite = np.isfinite(norm)
        accepted = norm <= 1.0
        # The error is proportional to the fifth power of the step.
        by_error = _SAFETY * np.maximum(np.where(finite, norm, 1.0), 1e-8) ** -0.2
        factor = np.clip(by_error, _SHRINK_MAX, _GROW_MAX)
        now.step = np.minimum(
            step * np.where(accepted, factor, np.minimum(factor, 1.0)), self._tolerances.step_max
        )
        now.steps += 1.0
        # The last step ends exactly at the limit.
        time = np.where(step < remaining, now.time + step, now.limit)
        if accepted.all():
            now.time = time
            now.state = state
            now.rates = rates
        else:
            now.time = np.where(accepted, time, now.time)
            now.state = np.where(accepted, state, now.state)
            now.rates = np.where(accepted, rates, now.rates)
        self._watch(step, accepted)
        self._retire(finite)

    def _error_norm(self, state: Array, error: Array) -> Array:
        """Return the error over its tolerance, shape (n,); NaN where a state is not finite."""
        tolerances = self._tolerances
        # The sum makes the norm not finite where a state is not finite.
        norm: Array = np.sqrt(error[0] * error[0] + error[1] * error[1]) + 0.0 * (
            state[0] + state[1]
        )
        offset = self._motion.offset_error(state, error)
        if offset is not None:
            norm += offset
        norm /= tolerances.absolute + tolerances.relative * self._now.distance
        return norm

    def _watch(self, step: Array, accepted: npt.NDArray[np.bool_]) -> None:
        """Record distances, commands and the last time outside of the settling band."""
        now = self._now
        before = now.distance
        state = now.state
        now.distance = np.sqrt(state[0] * state[0] + state[1] * state[1])
        now.distance_max = np.maximum(now.distance_max, now.distance)
        command = self._motion.command(now.time, state, now.rates)
        now.command_max = np.maximum(now.command_max, np.abs(command))
        outside = now.distance >= self._band
        now.last_outside = np.where(outside, now.time, now.last_outside)
        crossed = (before >= self._band) & ~outside
        if crossed.any():
            fraction = (self._band - now.distance[crossed]) / (
                before[crossed] - now.distance[crossed]
            )
            now.last_outside[crossed] = now.time[crossed] - fraction * step[crossed]
        if self._observe is not None and accepted.any():
            phi = self._motion.phi(now.time, state)
            self._observe(
                self.index[accepted],
                now.time[accepted],
                state[:, accepted],
                phi[accepted],
                command[accepted],
            )

    def _retire(self, finite: npt.NDArray[np.bool_]) -> None:
        """Replace finished trajectories by the next ones."""
        now = self._now
        near = now.distance < DISTANCE_CONVERGED
        if near.any():
            near &= np.abs(self._motion.phi(now.time, now.state)) < PHI_CONVERGED
        time_up = now.time >= now.limit
        finished = near | time_up | (now.steps >= self._tolerances.steps_max) | ~finite
        if not finished.any():
            return
        phi = self._motion.phi(now.time, now.state)
        for i in np.nonzero(finished)[0]:
            end = (
                f"{now.distance[i]:.4g} m from the reference after {now.time[i]:.6g} s,"
                f" phi {phi[i]:.3g} rad"
            )
            if near[i]:
                outcome = Outcome.CONVERGED
                message = "on the reference"
            elif not finite[i]:
                outcome = Outcome.NOT_FINITE
                message = f"the step from there is not finite: {end}"
            elif time_up[i]:
                outcome = Outcome.TIME_UP
                message = f"{end}: raise time_max"
            else:
                outcome = Outcome.STEPS_UP
                message = f"{end}, {now.steps[i]:.0f} steps: raise steps_max, or loosen tolerances"
            number = self.index[i]
            self._outcome[number] = outcome
            self._message[number] = message
            self._phi[number] = phi[i]
        self._all.put(self.index, now)
        last = self._next
        self._next = min(last + int(finished.sum()), len(self._message))
        self.index = np.concatenate([self.index[~finished], np.arange(last, self._next)])
        self._motion = self._whole.take(self.index)
        self._now = self._all.take(self.index)

    def result(self) -> EnsembleResult:
        """Return how all trajectories ended."""
        end = self._all
        return EnsembleResult(
            outcome=tuple(self._outcome),
            message=tuple(self._message),
            settling_time=np.where(
                end.distance < self._band, np.maximum(end.last_outside, 0.0), np.nan
            ),
            duration=end.time,
            distance=end.distance,
            distance_max=end.distance_max,
            phi_0=self._phi_0,
            phi=self._phi,
            heading_rate_max=end.command_max,
            steps=end.steps.astype(np.int64),
        )


@dataclass(slots=True, kw_only=True)
class _Fields:
    """State and history of trajectories, along the last axis, and the step to try next [s]."""

    time: Array
    limit: Array
    step: Array
    state: Array
    rates: Array
    distance: Array
    distance_max: Array
    command_max: Array
    last_outside: Array
    steps: Array

    def take(self, index: npt.NDArray[np.int64]) -> "_Fields":
        """Return a copy of the trajectories of ``index``."""
        taken = {field.name: getattr(self, field.name)[..., index] for field in fields(self)}
        return _Fields(**taken)

    def put(self, index: npt.NDArray[np.int64], other: "_Fields") -> None:
        """Write ``other`` over the trajectories of ``index``."""
        for field in fields(self):
            getattr(self, field.name)[..., index] = getattr(other, field.name)


# ---------------------------------------------------------------- Integration step

_SAFETY = 0.9
"""Part of the step that the error allows [-]."""

_SHRINK_MAX = 0.2
"""Smallest factor from one step to the next [-]."""

_GROW_MAX = 5.0
"""Largest factor from one step to the next [-]."""

_NODES = (1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0)
_STAGES = (
    (1 / 5,),
    (3 / 40, 9 / 40),
    (44 / 45, -56 / 15, 32 / 9),
    (19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729),
    (9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656),
    (35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84),
)
_ERROR = (71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40)


def dormand_prince_step(
    rates: Callable[[Array, Array], Array], time: Array, state: Array, first: Array, step: Array
) -> tuple[Array, Array, Array]:
    """Return the state after a step, its rates, and its error, the difference of both orders.

    Many systems take a step at once, each with a separate time and step. The formulae are those of
    orders 5 and 4 of Dormand and Prince, "A family of embedded Runge-Kutta formulae", Journal of
    Computational and Applied Mathematics 6, 1980.

    Parameters
    ----------
    rates : of the states at their times
    time : shape (n,) [s]
    state, first : now, and its rates, shape (k, n)
    step : shape (n,) [s]
    """
    slopes = [first]
    stage = state
    for node, weights in zip(_NODES, _STAGES, strict=True):
        stage = state + step * _weighted(weights, slopes)
        slopes.append(rates(time + node * step, stage))
    return stage, slopes[-1], step * _weighted(_ERROR, slopes)


def _weighted(weights: tuple[float, ...], slopes: list[Array]) -> Array:
    total: Array = weights[0] * slopes[0]
    for weight, slope in zip(weights[1:], slopes[1:], strict=True):
        if weight != 0.0:
            total = total + weight * slope
    return total
