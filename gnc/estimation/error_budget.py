"""What is not known exactly in a flight, and by how much: one error budget of named terms.

A term is a **bias** of unknown sign, a **process** that varies about 0 with a standard deviation
and a correlation time, a **growth** with age, or a **deviation** along a turn. The planner states
the terms from what the scenario declares (``scenarios/planning/air/errors.py``). The keep-out
guard, the planner of the orbit's margin, the refusals and the monitor of the premises read them
here. Each of them needs the same two answers: by how much may a velocity be wrong now
(``velocity``), and by how much a place after some time (``displacement``).

**Turbulence, as a moving vehicle meets it.** A horizontal component q of the gusts is a process of
standard deviation sigma and correlation time T = L/V, by the scale length L and the airspeed V. Its
exponential correlation rho(t) = exp(-t/T) makes it a first-order Markov process: from a gust q_0
that is known, q(t) = rho(t) q_0 + innovations that are independent of q_0. Integrated over a time,

    var integral q                  = 2 sigma^2 T (t - T (1 - rho))             (Taylor, 1922)
    var integral (q - rho q_0)      = sigma^2 (2 T t - 3 T^2 + 4 T^2 rho - T^2 rho^2).

**The estimated wind.** Each measurement of the wind triangle has the gust of its moment in it. With
the filter's gain K, the error e of the estimate follows e <- (1 - K) e + K q. Before the
measurement, q has changed: q <- rho q + an innovation. So for p = var e and c = cov(e, q),

    p <- (1 - K)^2 p + 2 K (1 - K) rho c + K^2 sigma^2
    c <- (1 - K) rho c + K sigma^2,

from p = c = sigma^2 at the first measurement, whose K is 1. ``WindErrorByGusts`` keeps both.

**Dead reckoning** takes the air to move with the estimated wind and what is left of the last gust
that was measured: (w + e) + rho(t) (q_0 - e). Its error of place after an age t is the integral of
q - rho q_0 - (1 - rho) e. The innovations are independent of e, too, so that the variance is

    var integral (q - rho q_0)  +  p (t - T (1 - rho))^2.

**A turn under satellite navigation.** The guidance keeps the speed over the estimated mean air, and
the autopilot turns the motion over the ground by the acceleration across. So a turn in gusts is
known much better than the gusts: what is left is the deviation of the closed loop, from its linear
model (``scenarios/planning/margin/turn_spread.py``). A wrong wind by itself moves no turn, since
the speed is kept over the wrong mean air. A wind estimate that changes during the turn does move
it. With the gain g = K/dt of the filter per second it changes by at most g times the integral of q
- e, and the vehicle follows the change along its path; that is displaced by at most

    min(1, g t/2)  sqrt(var integral (q - rho q_0) + var (T (1 - rho) q_0 - t e)).

**How many standard deviations.** ``deviations`` returns the k that errors exceed at a stated rate.
One rate, ``EXCEEDED_PER_HOUR``, holds for all processes in the vehicle's own motion; the vessel's
discs are placed by ``following.touches_per_hour``.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

EXCEEDED_PER_HOUR = 0.1
"""How often a process in the vehicle's own motion may exceed what is allowed for [1/h].

That alone violates nothing: the vehicle has to be at the limit of its guard just then, and the
error has to point towards the vessel.
"""

_SECONDS_PER_HOUR = 3600.0

_KNOWN_BETTER = 0.95
"""Share of an earlier variance of the estimated wind [-]. A variance that has fallen, but not below
that share, counts as unchanged.
"""

_ROUNDS = 10
"""Iterations that find k, whose rate depends on k: each leaves a tenth of the error or less [-]."""


def deviations(
    per_hour: float,
    *,
    correlation_times: Sequence[float] = (),
    draws: float = 0.0,
    ageing: float = 0.0,
) -> float:
    """Return the number of standard deviations that errors exceed at a rate [-].

    A normal error in two dimensions exceeds k standard deviations with the probability p =
    exp(-k^2/2). An error that is drawn anew does so once in 1/p draws. An error that ages, from the
    error of a place to that of a velocity, exceeds k at some age with the probability p (1 + k
    sqrt(pi/8)) at most, by Rice's formula over a quarter of a circle. A process of correlation time
    T comes to exceed k with a rate of p k^2/T at most (Kramers, "Brownian motion in a field of
    force and the diffusion model of chemical reactions", Physica, 1940).

    Parameters
    ----------
    per_hour : rate at which one of the errors exceeds k [1/h]
    correlation_times : of the processes [s]
    draws, ageing : errors that are drawn anew, and those of them that age [1/h]

    Examples
    --------
    >>> round(deviations(0.1, correlation_times=[11.3]), 2)
    4.72
    """
    wandering = sum(_SECONDS_PER_HOUR / time for time in correlation_times)
    k = 1.0
    for _ in range(_ROUNDS):
        chances = draws + ageing * (1.0 + k * math.sqrt(math.pi / 8.0)) + wandering * k * k
        k = math.sqrt(2.0 * math.log(max(1.0, chances / per_hour)))
    return k


# ---------------------------------------------------------------- Terms


@dataclass(frozen=True, slots=True, kw_only=True)
class Bias:
    """An error of unknown sign that lasts.

    Attributes
    ----------
    size : largest magnitude [the unit of the term]
    key : of the scenario that declares it
    """

    size: float = 0.0
    key: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Growth:
    """An error that grows with its age.

    Attributes
    ----------
    rate : largest growth [the unit of the term, per second]
    key : of the scenario that declares it
    """

    rate: float = 0.0
    key: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Process:
    """An error that varies about 0, with an exponential correlation.

    Attributes
    ----------
    sigma : standard deviation of each component [the unit of the term]
    correlation_time : T, after which the correlation is 1/e; 0 where there is no error [s]
    key : of the scenario that declares it
    """

    sigma: float = 0.0
    correlation_time: float = 0.0
    key: str = ""

    def remaining(self, time: float) -> float:
        """Return the share of a value that is left, on average, after a time [s, -]."""
        return math.exp(-time / self.correlation_time) if self.sigma > 0.0 else 0.0

    def change(self, time: float) -> float:
        """Return the standard deviation of its change within a time [s]."""
        return self.sigma * math.sqrt(2.0 * (1.0 - self.remaining(time)))

    def integral(self, time: float) -> float:
        """Return the standard deviation of its integral over a time [s]."""
        t = self.correlation_time
        lasting = time - t * (1.0 - self.remaining(time))
        return self.sigma * math.sqrt(max(0.0, 2.0 * t * lasting))

    def integral_from_known(self, time: float) -> float:
        """Return the standard deviation of the difference between its integral over a time [s] and
        the integral that was expected from the value at the start.
        """
        t, rho = self.correlation_time, self.remaining(time)
        square = 2.0 * t * time - t * t * (3.0 - rho * (4.0 - rho))
        # Over a time that is short against T the terms cancel to 2 time^3/(3 T).
        return self.sigma * math.sqrt(max(0.0, square))

    def not_remaining(self, time: float) -> float:
        """Return the integral of 1 - rho over a time [s], in seconds: for so long a value at its
        start has faded.
        """
        return time - self.correlation_time * (1.0 - self.remaining(time))


STILL = Process()
"""Air without turbulence."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TurnDeviation:
    """An error of place that grows along a turn.

    Attributes
    ----------
    interval : between the times at which it is given, from 0 on [s]
    sigmas : standard deviation of each component at these times, the first one 0 [m]
    key : of the scenario that declares it
    """

    interval: float = 1.0
    sigmas: tuple[float, ...] = ()
    key: str = ""

    def at(self, time: float) -> float:
        """Return the standard deviation after a time [s, m]; it goes on as at its end."""
        last = len(self.sigmas) - 1
        if last < 1:
            return 0.0
        place = time / self.interval
        i = min(int(place), last - 1)
        return self.sigmas[i] + (place - i) * (self.sigmas[i + 1] - self.sigmas[i])


AS_COMMANDED = TurnDeviation()
"""A turn without turbulence."""

# ---------------------------------------------------------------- The budget


@dataclass(frozen=True, slots=True, kw_only=True)
class ErrorBudget:
    """The errors that a flight is planned, guarded and judged with. A term of 0 is known exactly.

    Attributes
    ----------
    own_position : of the position by satellite navigation [m]
    own_velocity : of the velocity over the ground and of the wind, by sensors, and by crab angles
        that differ from those of steady turns [m/s]
    gusts : discrete gusts, which may each last as long as a turn [m/s]
    wind_change : change of the mean wind that its estimate has not followed [m/s]
    turbulence : as the vehicle meets it [m/s]
    turning : deviation of a turn in turbulence from the turn that was commanded [m]
    response : deviation of a full reversal from its prediction, towards the vessel [m]
    failed_part : deviation of a turn in which a part of the aircraft fails [m]
    drift : of dead reckoning, besides turbulence; the rate is 0 where satellite navigation is not
        lost [m]
    slowest : airspeed that the vehicle may fall to in any turn; infinite where it keeps to its
        commands [m/s]
    per_hour : how often the processes may exceed what is allowed for [1/h]
    """

    own_position: Process = Process()
    own_velocity: Bias = Bias()
    gusts: Bias = Bias()
    wind_change: Bias = Bias()
    turbulence: Process = STILL
    turning: TurnDeviation = AS_COMMANDED
    response: Bias = Bias()
    failed_part: Bias = Bias()
    drift: Growth = Growth()
    slowest: float = math.inf
    per_hour: float = EXCEEDED_PER_HOUR

    @property
    def k(self) -> float:
        """Number of standard deviations of turbulence that is allowed for [-]."""
        if self.turbulence.sigma == 0.0:
            return 0.0
        return deviations(self.per_hour, correlation_times=(self.turbulence.correlation_time,))

    @property
    def steady_velocity(self) -> float:
        """Largest lasting error of velocity and wind, without the drift of dead reckoning [m/s]."""
        return self.own_velocity.size + self.gusts.size + self.wind_change.size

    @property
    def may_drift(self) -> bool:
        """Whether satellite navigation may be lost."""
        return self.drift.rate > 0.0

    def velocity(self, wind_sigma: float, *, lost: float = 0.0) -> float:
        """Return the largest error of the wind, or of the velocity over the mean air [m/s].

        Parameters
        ----------
        wind_sigma : standard deviation of the estimated wind by gusts [m/s]
        lost : time since satellite navigation was lost [s]
        """
        drift = self.drift.rate if lost > 0.0 else 0.0
        return self.steady_velocity + drift + self.k * wind_sigma

    def wander(self, time: float) -> float:
        """Return the largest change of the error of the own position within a time [s, m]."""
        process = self.own_position
        if process.sigma == 0.0:
            return 0.0
        k = deviations(self.per_hour, correlation_times=(process.correlation_time,))
        return k * process.change(time)

    def drift_sigma(self, age: float, wind_sigma: float) -> float:
        """Return the standard deviation of dead reckoning by turbulence [m].

        Parameters
        ----------
        age : since the last satellite fix [s]
        wind_sigma : of the estimated wind by gusts at that time [m/s]
        """
        air = self.turbulence
        return math.hypot(air.integral_from_known(age), wind_sigma * air.not_remaining(age))

    def turn_sigma(self, time: float, wind: "WindErrorByGusts") -> float:
        """Return the standard deviation of a turn under satellite navigation in turbulence [m].

        Parameters
        ----------
        time : since it began [s]
        wind : error of the estimated wind when it began
        """
        air = self.turbulence
        gust_time = time - air.not_remaining(time)
        by_known = (
            (gust_time * air.sigma) ** 2
            - 2.0 * gust_time * time * wind.covariance
            + time * time * wind.variance
        )
        change = math.hypot(air.integral_from_known(time), math.sqrt(max(0.0, by_known)))
        return math.hypot(self.turning.at(time), min(1.0, 0.5 * wind.gain * time) * change)

    def displacement(
        self, *, lost: float = 0.0, wind: "WindErrorByGusts | None" = None
    ) -> "Displacement":
        """Return how far turbulence may take the vehicle from its predicted places from now on.

        Parameters
        ----------
        lost : time since satellite navigation was lost [s]
        wind : error of the estimated wind, at the last fix; None where it is known exactly
        """
        return Displacement(self, lost, wind or WindErrorByGusts(STILL))

    def parts(self, time: float, wind: "WindErrorByGusts | None" = None) -> "dict[str, Part]":
        """Return how far each term may displace the vehicle in a turn, by the term's name.

        Parameters
        ----------
        time : of the turn [s]
        wind : see ``displacement``
        """
        by_turbulence = self.displacement(wind=wind).after(time)
        return {
            "own position": Part(self.wander(time), self.own_position.key),
            "own velocity": Part(self.own_velocity.size * time, self.own_velocity.key),
            "gusts": Part(self.gusts.size * time, self.gusts.key),
            "change of the wind": Part(self.wind_change.size * time, self.wind_change.key),
            "turbulence": Part(by_turbulence, self.turbulence.key),
            "response of turns": Part(self.response.size, self.response.key),
            "failure of a part": Part(self.failed_part.size, self.failed_part.key),
            "drift of dead reckoning": Part(self.drift.rate * time, self.drift.key),
        }


class Part(NamedTuple):
    """How far a term may displace the vehicle [m], and the key of the scenario that declares it."""

    distance: float
    key: str


class Displacement:
    """How far turbulence may take the vehicle from its predicted places, k standard deviations.

    Satellite navigation may be lost at any moment, where that is declared: then a turn that was
    begun by satellites goes on by dead reckoning.

    Parameters
    ----------
    budget : of errors
    lost, wind : see ``ErrorBudget.displacement``
    """

    def __init__(self, budget: ErrorBudget, lost: float, wind: "WindErrorByGusts") -> None:
        self._budget = budget
        self._k = budget.k
        self._may_drift = budget.may_drift
        # All turns that are predicted at a moment are evaluated at the same times.
        self._found: dict[float, float] = {}
        self._lost = lost
        self._wind = wind.snapshot()

    def renew(self, lost: float, wind: "WindErrorByGusts") -> None:
        """Take in what is known now; see ``ErrorBudget.displacement``.

        An estimate that has become only a little better counts as unchanged, which is on the safe
        side.
        """
        known = self._wind.variance
        if lost == self._lost and _KNOWN_BETTER * known <= wind.variance <= known:
            return
        self._found.clear()
        self._lost = lost
        self._wind = wind.snapshot()

    def after(self, time: float) -> float:
        """Return the largest displacement after a time [s, m]."""
        if self._k == 0.0:
            return 0.0
        found = self._found.get(time)
        if found is None:
            found = self._found[time] = self._k * self._sigma(time)
        return found

    def _sigma(self, time: float) -> float:
        budget, lost, wind = self._budget, self._lost, self._wind
        sigma = 0.0
        if lost == 0.0:
            sigma = budget.turn_sigma(time, wind)
        if lost > 0.0 or self._may_drift:
            drifted = budget.drift_sigma(lost + time, wind.sigma)
            sigma = max(sigma, math.hypot(budget.turning.at(time), drifted))
        return sigma


EXACT = ErrorBudget()
"""Everything is known exactly."""


class WindErrorByGusts:
    """The error of an estimated wind by the gusts that are in its measurements.

    Parameters
    ----------
    turbulence : as the vehicle meets it [m/s]

    Attributes
    ----------
    variance : of each component of the error [m^2/s^2]
    covariance : of the error with the gust at the last measurement [m^2/s^2]
    gain : share of the error that a second of measurements corrects [1/s]
    """

    def __init__(self, turbulence: Process) -> None:
        self._turbulence = turbulence
        self.variance = 0.0
        self.covariance = 0.0
        self.gain = 0.0

    @property
    def sigma(self) -> float:
        """Standard deviation of each component of the error [m/s]."""
        return math.sqrt(self.variance)

    def snapshot(self) -> "WindErrorByGusts":
        """Return the error as it is now."""
        same = WindErrorByGusts(self._turbulence)
        same.variance = self.variance
        same.covariance = self.covariance
        same.gain = self.gain
        return same

    def measure(self, gain: float, time: float) -> None:
        """Take in a measurement.

        Parameters
        ----------
        gain : K, share of the measurement in the new estimate, 1 for the first [-]
        time : since the last measurement [s]
        """
        gust_variance = self._turbulence.sigma**2
        kept, rho = 1.0 - gain, self._turbulence.remaining(time)
        before = rho * self.covariance
        self.variance = (
            kept * kept * self.variance + 2.0 * gain * kept * before + gain * gain * gust_variance
        )
        self.covariance = kept * before + gain * gust_variance
        self.gain = gain / time
