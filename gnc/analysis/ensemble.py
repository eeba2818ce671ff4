"""Fly thousands of vehicles after their references at once, each at its own time.

Step size and acceptance are each trajectory's own; trajectories that finish give their place to the
next.
"""

from collections.abc import Callable
from dataclasses import dataclass, fields

import numpy as np
import numpy.typing as npt

from gnc.analysis.dormand_prince import dormand_prince_step
from gnc.analysis.ensemble_motion import MOTIONS, Array, Motion, Steering, Vehicle
from gnc.analysis.ensemble_result import (
    DISTANCE_CONVERGED,
    PHI_CONVERGED,
    EnsembleResult,
    Outcome,
    Tolerances,
)
from gnc.analysis.turning_reference import TurningReferences
from gnc.errors import InfeasibleError

_SAFETY, _SHRINK_MAX, _GROW_MAX = 0.9, 0.2, 5.0


Observer = Callable[[npt.NDArray[np.int64], Array, Array, Array, Array], None]
"""Called with index, time, state, phi and command of the trajectories that took a step; arrays of
their number.
"""


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
    """Fly until each vehicle is on its reference, or its time is up.

    A vehicle is on its reference once d and phi are within ``DISTANCE_CONVERGED`` and
    ``PHI_CONVERGED``. From there d stays small for good under both laws of the paper. Under the
    Lyapunov law V_2 never rises, which lets d reach sqrt(d_0^2 + phi_0^2/k_1), 0.021 m at k_1 =
    0.001. Under the cascade law the rate of d^2 is at most rho V phi^2 and phi decays
    exponentially, so that d^2 gains at most rho V phi_0^2/(2 gain), (0.004 m)^2 at 1.5 1/s and R =
    60 m. With cut commands that holds if the reference leaves a margin of 0.001 rad/s, for then
    nothing is cut: |omega - omega_r| is at most V (phi_r + phi)/R + 2 phi_r |omega_r| + gain phi,
    with phi_r about d/R. Of cut commands about a reference that spends all of omega_max nothing is
    claimed but that it was reached.

    Parameters
    ----------
    law, vehicle : steering law and vehicle, the same for all
    references : of n vehicles
    to_reference : d at time 0, north and east, shape (2, n) [m]
    course : chi at time 0, shape (n,) [rad]
    settling_band : distance below which a trajectory counts as settled [m]
    time_max : limit, for all or for each, shape () or (n,) [s]
    tolerances : of the integration
    places : trajectories under way at once, begun in the order given: the longest first keep places
        busy to the end
    observe : called at the start and after every step

    Raises
    ------
    InfeasibleError : starts that do not belong to the references or are not finite, limits that are
        not above 0
    """
    begin = np.array(to_reference, dtype=float)
    chi = np.array(course, dtype=float)
    count = len(references)
    if begin.shape != (2, count) or chi.shape != (count,):
        raise InfeasibleError(
            f"to_reference and course have shapes {begin.shape} and {chi.shape}; with {count} references: (2, {count}), ({count},)"
        )
    if not (np.isfinite(begin).all() and np.isfinite(chi).all()):
        raise InfeasibleError("a start's distance or course is not finite; give numbers")
    limit = np.broadcast_to(np.asarray(time_max, dtype=float), (count,))
    if places < 1:
        raise InfeasibleError(
            f"places is {places}; it must be at least 1: 500 keep the processor busy"
        )
    if not (settling_band > 0.0 and (limit > 0.0).all() and np.isfinite(limit).all()):
        raise InfeasibleError(
            f"settling_band is {settling_band:g} m, time_max {limit.min():g} to {limit.max():g} s; both must be finite and above 0"
        )
    motion = MOTIONS[law](vehicle, references)
    state = motion.start(begin, chi)
    flight = _Flight(motion, state, limit, settling_band, tolerances or Tolerances(), observe)
    flight.begin(places)
    while len(flight.index):
        flight.step()
    return flight.result()


class _Flight:
    """The integration: ``_all`` holds every trajectory, as it starts or as it ended, ``_now`` those
    under way.
    """

    def __init__(
        self,
        motion: Motion,
        state: Array,
        limit: Array,
        band: float,
        tolerances: Tolerances,
        observe: Observer | None,
    ) -> None:
        count = state.shape[1]
        self._band, self._tolerances, self._observe = band, tolerances, observe
        time = np.zeros(count)
        rates = motion.rates(time, state)
        distance = np.hypot(state[0], state[1])
        self._phi_0 = motion.phi(time, state)
        command = motion.command(time, state, rates)
        self._all = _Fields(
            time=time,
            limit=limit.copy(),
            # Short against the fastest motion there is, phi's under the Lyapunov law; steps grow
            # fivefold from there.
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

    def begin(self, places: int) -> None:
        """Put the first trajectories into their places."""
        self._next = min(places, len(self._message))
        self.index = np.arange(self._next)
        self._motion = self._whole.take(self.index)
        self._now = self._all.take(self.index)

    def step(self) -> None:
        """Try one step of every trajectory under way, accept it where it is good enough, retire
        what is finished.
        """
        now = self._now
        remaining = now.limit - now.time
        step = np.minimum(now.step, remaining)
        state, rates, error = dormand_prince_step(
            self._motion.rates, now.time, now.state, now.rates, step
        )
        norm = self._error_norm(state, error)
        finite = np.isfinite(norm)
        accepted = norm <= 1.0
        # Error goes with the fifth power of the step.
        factor = np.clip(
            _SAFETY * np.maximum(np.where(finite, norm, 1.0), 1e-8) ** -0.2, _SHRINK_MAX, _GROW_MAX
        )
        now.step = np.minimum(
            step * np.where(accepted, factor, np.minimum(factor, 1.0)), self._tolerances.step_max
        )
        now.steps += 1.0
        # The last step ends at the limit itself, whatever the rounding of its sum.
        time = np.where(step < remaining, now.time + step, now.limit)
        if accepted.all():
            now.time, now.state, now.rates = time, state, rates
        else:
            now.time = np.where(accepted, time, now.time)
            now.state = np.where(accepted, state, now.state)
            now.rates = np.where(accepted, rates, now.rates)
        self._watch(step, accepted)
        self._retire(finite)

    def _error_norm(self, state: Array, error: Array) -> Array:
        """Return the error against its tolerance; NaN where a state is not finite."""
        tolerances = self._tolerances
        # Sums, so that what is not finite in any is not finite in the norm.
        norm: Array = np.sqrt(error[0] * error[0] + error[1] * error[1]) + 0.0 * (
            state[0] + state[1]
        )
        offset = self._motion.offset_error(state, error)
        if offset is not None:
            norm += offset
        norm /= tolerances.absolute + tolerances.relative * self._now.distance
        return norm

    def _watch(self, step: Array, accepted: npt.NDArray[np.bool_]) -> None:
        """Record what the step brought: distances, commands, and when the settling band was left
        for the inside.
        """
        now = self._now
        before, state = now.distance, now.state
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
        """Give the places of finished trajectories to the next ones."""
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
            end = f"{now.distance[i]:.4g} m from the reference after {now.time[i]:.6g} s, phi {phi[i]:.3g} rad"
            if near[i]:
                outcome, message = Outcome.CONVERGED, "on the reference"
            elif not finite[i]:
                outcome, message = Outcome.NOT_FINITE, f"the step from there is not finite: {end}"
            elif time_up[i]:
                outcome, message = Outcome.TIME_UP, f"{end}: raise time_max"
            else:
                outcome, message = (
                    Outcome.STEPS_UP,
                    f"{end}, {now.steps[i]:.0f} steps: raise steps_max, or loosen tolerances",
                )
            self._outcome[self.index[i]], self._message[self.index[i]] = outcome, message
            self._phi[self.index[i]] = phi[i]
        self._all.put(self.index, now)
        last, self._next = self._next, min(self._next + int(finished.sum()), len(self._message))
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
    """Where trajectories are, what is known of them, and the step to try next; trajectories along
    the last axis.
    """

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
        return _Fields(
            **{field.name: getattr(self, field.name)[..., index] for field in fields(self)}
        )

    def put(self, index: npt.NDArray[np.int64], other: "_Fields") -> None:
        """Write ``other`` over the trajectories of ``index``."""
        for field in fields(self):
            getattr(self, field.name)[..., index] = getattr(other, field.name)
