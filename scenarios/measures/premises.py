"""Measures whether the premises of the keep-out theorem held in a flight: for each term of the
error budget, the largest ratio of the actual error to the allowance for it, and its time.

Ratios follow from the flight's record: the truth, and the guidance's estimates and allowances
(``scenarios.flight.guard_belief``). Above 1 a premise did not hold. A violation of the keep-out
area in a flight with no ratio above 1 is an error of the theorem or of its code.

With the error budget B, the place p, the velocity over the mean air u, the wind w, and estimates
marked ^, the ratios are as follows; b is ``B.velocity`` and what is allowed for while few
measurements are in the wind.

position   |p^ - p| / (k sigma_p), by satellite navigation; k is that of the vessel's discs
wind       the larger of |w^ - w - g| and, by satellite navigation, |u^ - u|, over b, with the
           discrete gust g of the moment
vessel     |p_vessel + p^ - p - c| / R, in the disc (centre c, radius R) with the least room for it;
           an error of the own place counts as one of the vessel, in dead reckoning the last one
airspeed   ||u| - (V_f + V_s)/2| / ((V_f - V_s)/2 + b), fastest and slowest V of the guard; without
           turbulence, where the speed in gusts is part of ``turning``
response   n(t) / (c D + g t), in air without turbulence: n is how much less a turn at omega_max led
           away within t than predicted from its start, D the response of a full reversal, c the
           share of it that is counted, g the speed of declared gusts
turning    n(t) / (c D + g t + ``B.displacement.after(t)``), in turbulence
drift      |(p^ - p)(t) - (p^ - p)(0)| / ((drift + allowance) t + k ``B.drift_sigma(t)``), t since
           the first sample of dead reckoning: the last fix may have moved the estimate after the
           sample before it

A turn is predicted as the guard predicts it: with the lag and delay behind the given commands, the
pending course change of earlier commands, V_r commanded, and the speed that was flown. Full
commands for a radian or more count as a turn. Its deviation counts in the directions in which the
design's search takes it (``innerloop.flight.turn_reversal``): away from discs where a turn away
comes closest to them, which is abeam of one at rest, later by an angle from one that closes in, and
sooner from one that draws ahead. An aircraft that turns faster than predicted is nearer to what
lies ahead on the inner side; it does not turn away from that, and no turn away comes closest there.
In turbulence a turn is predicted over the wind as it was estimated at the start, since the speed is
kept over that, and at a speed within the guard's range: what is beyond is displacement. A turn by
satellite navigation ends where that is lost. If a part of the aircraft has failed, the budget's
allowance for that is added to c D.

A ratio is NaN if the flight has nothing to compare, if no turn deviates by more than the guard's
resolution, or if a term is exact, that is, if neither the budget nor the error exceeds the guard's
resolution.
"""

import itertools
import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from common.premises import EXCEEDED, HELD, TRAFFIC_TERM, ratio_column, time_column
from gnc.estimation.error_budget import ErrorBudget, WindErrorByGusts, deviations
from gnc.guard.guard import GuardParameters
from gnc.guard.turn import PENDING_DECAY, pending_turn_rate, rolled_change
from gnc.guidance import ReportedVessel
from scenarios.engine.task import Row
from scenarios.flight.guard_belief import GuardBelief
from scenarios.flight.outcome import Outcome
from scenarios.flight.record import FlightRecord
from scenarios.measures.traffic import traffic_premise
from scenarios.planning.flight_plan import FlightPlan

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Indices = npt.NDArray[np.intp]

POSITION_RESOLUTION = 0.05
"""Accuracy to which the guard evaluates a turn [m]: an error below it counts as none."""

SPEED_RESOLUTION = 0.05
"""Difference up to which the guard takes speeds as the same [m/s]."""

_FULL, _FULL_IN_TURBULENCE = 0.98, 0.8
"""Share of omega_max from which a command counts as that of a turn away [-]. In turbulence commands
are seldom full for long without the guard; there nearly full turns count, too."""

_SPEED_BAND = 0.03
"""Difference of the commanded pace from V_r up to which a turn counts as one at V_r, over V_r
[-]. The guard commands V_r in a turn away; one that slows down or speeds up has another response.
"""

_LEAST_TURN = 1.0
"""Course that full commands take to count as a turn [rad]: of less there is nothing to see."""

_HALF_TURNS = 1.5
"""Half turns for which a turn is followed [-]: a turn away takes as many at most."""

_LEANS = np.radians([-60.0, -30.0, 0.0, 30.0, 60.0])
"""How far the directions away lean forward of abeam [rad]: the sine is the speed at which the disc
closes in, over that of the vehicle."""

_STARTS = 32
"""Starts of turns in the time of such a turn [-]."""


_LOST = (Outcome.AIRCRAFT_LOST.value, Outcome.DIVERGED.value)
"""Outcomes of aircraft that no longer fly their commands."""


class Ratios(NamedTuple):
    """Ratios of actual errors to the allowances for them, over time.

    Attributes
    ----------
    time : shape (n,) [s]
    values : shape (n,), NaN if there is nothing to compare [-]
    """

    time: Array
    values: Array

    def largest(self) -> tuple[float, float]:
        """Return the largest ratio and its time [-, s]; NaN without a ratio."""
        if not np.isfinite(self.values).any():
            return math.nan, math.nan
        i = int(np.nanargmax(self.values))
        return float(self.values[i]), float(self.time[i])


def premise_figures(plan: FlightPlan, record: FlightRecord) -> Row:
    """Return the largest ratio of each premise and its time; empty for a record without a guard's
    estimates.
    """
    if not set(GuardBelief.COLUMNS) <= set(record.columns):
        return {}
    row: Row = {}
    exceeded = []
    for term, ratios in premise_ratios(plan, record).items():
        largest, time = ratios.largest()
        row |= {ratio_column(term): largest, time_column(term): time}
        if largest > 1.0:
            exceeded.append(term)
    of_traffic = traffic_premise(record)
    if of_traffic.get(ratio_column(TRAFFIC_TERM), 0.0) > 1.0:
        exceeded.append(TRAFFIC_TERM)
    return {EXCEEDED: ", ".join(exceeded) or HELD} | row | of_traffic


def is_unexplained(row: Row) -> bool:
    """Return whether a guarded flight entered the keep-out area although every premise held and its
    aircraft was not lost. A lost aircraft does not fly its commands.
    """
    violated = row.get("keepout_violations", 0) > 0 and row["outcome"] not in _LOST
    return bool(violated and row.get(EXCEEDED) == HELD)


def premise_ratios(plan: FlightPlan, record: FlightRecord) -> dict[str, Ratios]:
    """Return the ratios of each premise over a flight, by ``common.premises.TERMS``.

    Raises
    ------
    ValueError : a flight without a keep-out guard
    """
    flight = _Flight(plan, record)
    by_turbulence = flight.budget.turbulence.sigma > 0.0
    turns = _turn_ratios(flight)
    nothing = flight.nothing()
    return {
        "position": _position_ratios(flight),
        "wind": _wind_ratios(flight),
        "vessel": _vessel_ratios(flight),
        "airspeed": nothing if by_turbulence else _airspeed_ratios(flight),
        "response": nothing if by_turbulence else turns,
        "turning": turns if by_turbulence else nothing,
        "drift": _drift_ratios(flight),
    }


class _Flight:
    """A flight's record with the quantities that several premises need.

    Attributes
    ----------
    column : of the record, by its name
    guard, budget : parameters of the guard, and its error budget
    time : [s]
    off_north, off_east : error of the own position [m]
    wind_north, wind_east : true mean wind at the vehicle [m/s]
    satellites : whether satellite navigation works
    last_fix : number of the last sample with satellite navigation
    allowance : error of the wind allowed for while few measurements are in it [m/s]
    velocity_error : b, the allowance for errors of velocity and wind [m/s]
    """

    def __init__(self, plan: FlightPlan, record: FlightRecord) -> None:
        if plan.guidance.guard is None or plan.world is None:
            raise ValueError("a flight without a keep-out guard has no premises")
        self.plan = plan
        self.column: Callable[[str], Array] = record.column
        self.guard: GuardParameters = plan.guidance.guard
        self.budget: ErrorBudget = self.guard.errors
        column = self.column
        self.time = column("time_s")
        self.off_north = column("own_seen_north_m") - column("north_m")
        self.off_east = column("own_seen_east_m") - column("east_m")
        self._gusts = plan.world.weather.gusts
        wind = plan.world.weather.wind
        self.wind_north, self.wind_east = wind.at(self.time, column("altitude_m"))
        self.lost_for = column("satellites_lost_s")
        self.satellites: Mask = self.lost_for == 0.0
        numbers = np.arange(len(self.time))
        self.last_fix: Indices = np.maximum.accumulate(np.where(self.satellites, numbers, 0))
        self.allowance = column("wind_allowance_mps")
        by_gusts = column("gust_in_wind_mps")
        reckoned = [
            self.budget.velocity(float(sigma), lost=float(lost))
            for sigma, lost in zip(by_gusts, self.lost_for, strict=True)
        ]
        self.velocity_error = np.array(reckoned) + self.allowance
        failing = plan.world.faults.of_aircraft()
        self.part_fails_at = failing[0].begins if failing else math.inf

    def gusts(self) -> tuple[Array, Array]:
        """Return the discrete gusts of the flight, north and east [m/s]."""
        north, east = np.zeros(len(self.time)), np.zeros(len(self.time))
        for gust in self._gusts:
            share = gust.share(self.time)
            north += gust.velocity_ned[0] * share
            east += gust.velocity_ned[1] * share
        return north, east

    def nothing(self) -> Ratios:
        """Return a ratio of NaN: there is nothing to compare."""
        return Ratios(self.time, np.full(len(self.time), math.nan))


def _ratio(error: Array, reckoned: Array, resolution: float) -> Array:
    """Return errors over the allowances for them; NaN if neither exceeds the guard's resolution."""
    ratio = error / np.maximum(reckoned, resolution)
    return np.where((reckoned > resolution) | (ratio > 1.0), ratio, math.nan)


def _position_ratios(flight: _Flight) -> Ratios:
    process = flight.budget.own_position
    vessel = flight.plan.guidance.vessel
    if process.sigma == 0.0:
        k = 0.0
    elif isinstance(vessel, ReportedVessel):
        k = vessel.limits.deviations
    else:
        k = deviations(flight.budget.per_hour, correlation_times=(process.correlation_time,))
    error = np.hypot(flight.off_north, flight.off_east)
    reckoned = np.full(len(error), k * process.sigma)
    ratio = _ratio(error, reckoned, POSITION_RESOLUTION)
    return Ratios(flight.time, np.where(flight.satellites, ratio, math.nan))


def _wind_ratios(flight: _Flight) -> Ratios:
    if flight.plan.guidance.navigation is None:
        return flight.nothing()
    column = flight.column
    gust_north, gust_east = flight.gusts()
    wind_error = np.hypot(
        column("wind_north_mps") - flight.wind_north - gust_north,
        column("wind_east_mps") - flight.wind_east - gust_east,
    )
    speed, course = column("own_seen_speed_mps"), column("own_seen_course_rad")
    own_error = np.hypot(
        speed * np.cos(course) - (column("velocity_north_mps") - flight.wind_north),
        speed * np.sin(course) - (column("velocity_east_mps") - flight.wind_east),
    )
    error = np.where(flight.satellites, np.maximum(wind_error, own_error), wind_error)
    return Ratios(flight.time, _ratio(error, flight.velocity_error, SPEED_RESOLUTION))


def _vessel_ratios(flight: _Flight) -> Ratios:
    if not isinstance(flight.plan.guidance.vessel, ReportedVessel):
        return flight.nothing()
    column, fix = flight.column, flight.last_fix
    off_centre = np.hypot(
        column("vessel_north_m") + flight.off_north[fix] - column("disc_north_m"),
        column("vessel_east_m") + flight.off_east[fix] - column("disc_east_m"),
    )
    return Ratios(flight.time, _ratio(off_centre, column("disc_radius_m"), POSITION_RESOLUTION))


def _airspeed_ratios(flight: _Flight) -> Ratios:
    column = flight.column
    speed = np.hypot(
        column("velocity_north_mps") - flight.wind_north,
        column("velocity_east_mps") - flight.wind_east,
    )
    slowest, fastest = _speed_range(flight)
    beyond = np.maximum(flight.velocity_error, SPEED_RESOLUTION)
    half = 0.5 * (fastest - slowest) + beyond
    off_middle = np.abs(speed - 0.5 * (fastest + slowest))
    return Ratios(flight.time, _ratio(off_middle, half, SPEED_RESOLUTION))


def _speed_range(flight: _Flight) -> tuple[Array, Array]:
    """Return the slowest and the fastest speed with which turns are predicted; the measured speed
    lies between them [m/s].
    """
    measured = flight.column("own_seen_speed_mps")
    return (
        np.minimum(flight.column("speed_slowest_mps"), measured),
        np.maximum(flight.column("speed_fastest_mps"), measured),
    )


def _drift_ratios(flight: _Flight) -> Ratios:
    lost = ~flight.satellites
    first = np.minimum(flight.last_fix + 1, len(lost) - 1)
    drifted = np.hypot(
        flight.off_north - flight.off_north[first], flight.off_east - flight.off_east[first]
    )
    budget = flight.budget
    steady = (budget.drift.rate + flight.allowance) * (flight.time - flight.time[first])
    reckoned = np.full(len(drifted), math.nan)
    by_gusts = flight.column("gust_in_wind_mps")
    for i in np.flatnonzero(lost):
        age = float(flight.lost_for[i])
        reckoned[i] = steady[i] + budget.k * budget.drift_sigma(age, float(by_gusts[i]))
    return Ratios(flight.time, _ratio(drifted, reckoned, POSITION_RESOLUTION))


# ---------------------------------------------------------------- Turns


class _Commands(NamedTuple):
    """Commanded turning between samples, shape (samples - 1,).

    Attributes
    ----------
    given, acting : mean heading rate that is commanded, and that acts after the delay [rad/s]
    full : whether the command is that of a turn away all the time
    """

    given: Array
    acting: Array
    full: Mask


def _turn_ratios(flight: _Flight) -> Ratios:
    """Return by how much less turns led away than predicted, over the deviation that the guard
    keeps: the largest ratio along each turn, at the time of its start.
    """
    guard, column = flight.guard, flight.column
    rate_max, n = guard.heading_rate_max, len(flight.time)
    if n < 3:
        return flight.nothing()
    step = float(flight.time[1] - flight.time[0])
    turn_time = _HALF_TURNS * math.pi / rate_max + guard.delay + guard.lag
    steps = math.ceil(turn_time / step)
    measured = column("own_seen_speed_mps")
    # From the rate of the course through the air, converted to the mean air as navigation does.
    rates = column("heading_rate_rad_s") * _air_ratio(column("airspeed_mps"), measured)
    commands = _commands(flight, rates, step)
    pending = _pending_rates(guard, commands.acting, rates, step)
    starts = _turn_starts(
        commands, shortest=_LEAST_TURN / (rate_max * step), spacing=max(1, steps // _STARTS)
    )
    if not len(starts):
        return flight.nothing()
    sides = np.sign(commands.given[starts])
    entry = sides * np.minimum(0.0, sides * pending[starts])
    kept = _kept_for_response(flight, commands, starts, sides, rates[starts] + entry)
    path = _PredictedTurns(flight, starts, rates[starts], sides)
    largest, most = np.full(len(starts), -math.inf), np.zeros(len(starts))
    nearest = np.zeros(len(starts))
    going = np.ones(len(starts), dtype=np.bool_)
    entry_step = round(guard.delay / step)
    for k in range(steps):
        now = np.minimum(starts + k, n - 2)
        going &= (starts + k + 1 < n) & commands.full[now]
        going &= (np.sign(commands.given[now]) == sides) & flight.satellites[now + 1]
        if not going.any():
            break
        if k == entry_step:
            path.heading_rate += entry
        path.advance(now, commands.acting[now], step)
        nearer = path.nearer(now + 1)
        elapsed = (k + 1) * step
        reckoned = kept(now + 1) + flight.budget.gusts.size * elapsed
        compared = np.flatnonzero(going & (nearer > POSITION_RESOLUTION))
        reckoned[compared] += _displacement(flight, starts[compared], elapsed)
        ratio = nearer / np.maximum(reckoned, POSITION_RESOLUTION)
        largest = np.where(going & (ratio > largest), ratio, largest)
        most = np.where(going & (reckoned > most), reckoned, most)
        nearest = np.where(going & (nearer > nearest), nearer, nearest)
    flown = nearest > POSITION_RESOLUTION
    flown &= (most > POSITION_RESOLUTION) | (largest > 1.0)
    return Ratios(flight.time[starts], np.where(flown, largest, math.nan))


def _air_ratio(airspeed: Array, speed: Array) -> Array:
    return np.where(np.isfinite(airspeed), airspeed, speed) / np.maximum(1.0, speed)


def _commands(flight: _Flight, rates: Array, step: float) -> _Commands:
    """Return the commands between samples, as far as the largest bank allows them."""
    guard, column = flight.guard, flight.column
    rate_max, speed = guard.heading_rate_max, column("own_seen_speed_mps")[:-1]
    flyable = rate_max * np.minimum(1.0, guard.turn_speed / np.maximum(1.0, speed))
    time, course = flight.time, column("course_commanded_rad")
    # The turn at the start of the flight is assumed to have lasted before it.
    before = time - guard.delay
    delayed = np.interp(before, time, course) + np.minimum(0.0, before - time[0]) * rates[0]
    given = np.diff(course) / step
    # The commanded airspeed keeps the pace in the present gust (``gnc.airspeed``).
    measured, turned_at = column("own_seen_speed_mps"), flight.plan.guidance.speed
    airspeed = column("airspeed_mps")
    gust = np.where(np.isfinite(airspeed), airspeed - measured, 0.0)
    off_speed = np.abs(column("airspeed_command_mps") - gust - turned_at)
    away = (column("guard") > 0.0) | (off_speed <= _SPEED_BAND * turned_at)
    share = _FULL_IN_TURBULENCE if flight.budget.turbulence.sigma > 0.0 else _FULL
    return _Commands(
        given=np.clip(given, -flyable, flyable),
        acting=np.clip(np.diff(delayed) / step, -flyable, flyable),
        full=(np.abs(given) >= share * flyable) & away[:-1],
    )


def _pending_rates(guard: GuardParameters, acting: Array, rates: Array, step: float) -> Array:
    """Return the change of heading rate by which the guard describes the pending course change of
    earlier commands (``gnc.guard.guard.CommandHistory``), at each sample [rad/s].
    """
    found = np.zeros(len(rates))
    if guard.lag == 0.0:
        return found
    slow_lag = guard.delay + guard.lag if guard.slow_lag is None else guard.slow_lag
    decay = math.exp(-step / (PENDING_DECAY * guard.lag))
    most = 2.0 * guard.heading_rate_max * (guard.delay + guard.lag)
    turned = 0.5 * step * (rates[:-1] + rates[1:]) + (slow_lag - guard.delay) * np.diff(rates)
    lack = 0.0
    for i, gained in enumerate((step * acting - turned).tolist()):
        lack = min(max(decay * lack + gained, -most), most)
        found[i + 1] = pending_turn_rate(lack, float(rates[i + 1]), slow_lag, guard.lag)
    return found


def _turn_starts(commands: _Commands, *, shortest: float, spacing: int) -> Indices:
    """Return the samples from which turns are predicted: the beginning of each turn, and further
    ones at a fixed spacing.

    Full commands for fewer than ``shortest`` samples do not count as a turn.
    """
    sides = np.where(commands.full, np.sign(commands.given), 0.0)
    edges = np.flatnonzero(np.diff(sides, prepend=0.0, append=0.0) != 0.0).tolist()
    turns = [
        np.arange(begin, end, spacing)
        for begin, end in itertools.pairwise(edges)
        if sides[begin] != 0.0 and end - begin >= shortest
    ]
    return np.concatenate(turns) if turns else np.zeros(0, dtype=np.intp)


def _kept_for_response(
    flight: _Flight, commands: _Commands, starts: Indices, sides: Array, rates: Array
) -> Callable[[Indices], Array]:
    """Return the deviation that the guard keeps for the response of turns, at the samples that they
    have reached [m].
    """
    rate_max, budget = flight.guard.heading_rate_max, flight.budget
    rolled = np.array(
        [rolled_change(side, rate, rate_max) for side, rate in zip(sides, rates, strict=True)]
    )
    before = commands.given[np.maximum(starts - 1, 0)]
    jump = np.abs(commands.given[starts] - before) / (2.0 * rate_max)
    recent = np.maximum(flight.column("command_change")[starts], jump)
    deviation = budget.response.size * np.maximum(recent, rolled)

    def kept(at: Indices) -> Array:
        failed = flight.time[at] >= flight.part_fails_at
        return np.asarray(deviation + np.where(failed, budget.failed_part.size, 0.0))

    return kept


class _PredictedTurns:
    """Turns that are predicted from their starts, all at once.

    Parameters
    ----------
    flight : the flight in which they were flown
    starts : samples at which they begin
    rates : heading rates there [rad/s]
    sides : of the turns, 1 to the right and -1 to the left

    Attributes
    ----------
    heading_rate : present heading rate of each turn, shape (turns,) [rad/s]
    """

    def __init__(self, flight: _Flight, starts: Indices, rates: Array, sides: Array) -> None:
        column = flight.column
        self._sides = sides
        self._flight = flight
        self._north, self._east = column("north_m")[starts], column("east_m")[starts]
        self._estimated: tuple[Array, Array] | None = None
        if flight.budget.turbulence.sigma > 0.0:
            self._estimated = column("wind_north_mps")[starts], column("wind_east_mps")[starts]
        slowest, fastest = _speed_range(flight)
        self._slowest, self._fastest = slowest[starts], fastest[starts]
        wind_north, wind_east = self._wind(starts)
        self._course = np.arctan2(
            column("velocity_east_mps")[starts] - wind_east,
            column("velocity_north_mps")[starts] - wind_north,
        )
        self._turned = np.zeros(len(starts))
        self.heading_rate = np.array(rates)

    def _wind(self, at: Indices) -> tuple[Array, Array]:
        """Return the wind that a turn is predicted with: in turbulence as estimated at the
        start.
        """
        if self._estimated is not None:
            return self._estimated
        return self._flight.wind_north[at], self._flight.wind_east[at]

    def _chord(self, now: Indices, wind_north: Array, wind_east: Array, step: float) -> Array:
        """Return the distance flown relative to that wind from some samples to the next ones [m].

        It is computed from positions, because the speed need not change evenly between two samples.
        """
        column = self._flight.column
        north, east = column("north_m"), column("east_m")
        chord = np.hypot(
            north[now + 1] - north[now] - wind_north * step,
            east[now + 1] - east[now] - wind_east * step,
        )
        if self._estimated is None:
            return np.asarray(chord)
        return np.clip(chord, self._slowest * step, self._fastest * step)

    def advance(self, now: Indices, command: Array, step: float) -> None:
        """Advance the turns by a step [s] from some samples under commands [rad/s]."""
        lag = self._flight.guard.lag
        decay = math.exp(-step / lag) if lag > 0.0 else 0.0
        off_command = self.heading_rate - command
        turned = step * command + lag * (1.0 - decay) * off_command
        self.heading_rate = command + decay * off_command
        middle = self._course + 0.5 * turned
        wind_north, wind_east = self._wind(now)
        way = self._chord(now, wind_north, wind_east, step)
        self._north = self._north + way * np.cos(middle) + wind_north * step
        self._east = self._east + way * np.sin(middle) + wind_east * step
        self._course = self._course + turned
        self._turned = self._turned + self._sides * turned

    def nearer(self, at: Indices) -> Array:
        """Return how much less the turns led away than predicted, in the worst direction [m]."""
        column = self._flight.column
        lack_north = self._north - column("north_m")[at]
        lack_east = self._east - column("east_m")[at]
        away = self._course[:, None] + self._sides[:, None] * (0.5 * math.pi - _LEANS)
        lack = lack_north[:, None] * np.cos(away) + lack_east[:, None] * np.sin(away)
        # A disc that draws ahead is nearest before the turn has come so far.
        passed = (_LEANS < 0.0) & (self._turned[:, None] > 0.5 * math.pi + _LEANS)
        return np.asarray(np.max(np.where(passed, -math.inf, lack), axis=1))


def _displacement(flight: _Flight, starts: Indices, elapsed: float) -> Array:
    """Return the displacement by turbulence that the guard keeps, some time [s] after the starts of
    turns [m].
    """
    budget, column = flight.budget, flight.column
    found = np.zeros(len(starts))
    if budget.turbulence.sigma == 0.0:
        return found
    wind = WindErrorByGusts(budget.turbulence)
    displacement = budget.displacement(wind=wind)
    sigmas = column("gust_in_wind_mps")[starts].tolist()
    covariances = column("gust_in_wind_covariance_m2_s2")[starts].tolist()
    gains = column("gust_in_wind_gain_per_s")[starts].tolist()
    for i, sigma in enumerate(sigmas):
        wind.variance, wind.covariance, wind.gain = sigma**2, covariances[i], gains[i]
        found[i] = displacement.after(elapsed)
    return found
