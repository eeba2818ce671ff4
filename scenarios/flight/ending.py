"""When a flight has settled, when it is over, and how it ended.

A flight may end early: with a verdict on the fuel, or because no verdict can be reached.
Each look at the readings could be wrong, and a flight ends at the first that finds a verdict. So
the guard band allows for the looks before and after it (``measurement.estimate.repeated``).
"""

import math
import traceback
from enum import Enum
from pathlib import Path

from common.errors import RefusedError
from common.text import one_line
from gnc.errors import InfeasibleError
from gnc.estimation.health import Fault
from gnc.estimation.navigation import MeasuredMotion
from gnc.estimation.plume.passes import SensorState
from gnc.guidance import Guidance
from gnc.mission.axis import SearchedAxis
from gnc.mission.follow import PlumeFollowing
from gnc.mission.mission import LOST, Mode
from measurement.errors import MeasurementError
from measurement.estimate.estimator import estimate
from measurement.estimate.repeated import RepeatedVerdict
from measurement.estimate.verdict import OPEN
from scenarios.engine.task import Row
from scenarios.flight.outcome import Outcome
from scenarios.instruments.instrument import GasReader
from scenarios.planning.flight_plan import FlightPlan
from scenarios.scenario.sections.flight import DITCHED
from scenarios.vehicles.vehicle import Vehicle

_CENTRE_BANDS = 3.0
"""Largest distance of the orbit's centre from its place that counts as in place, over the settling
band: the vessel is not known exactly.
"""

LOOK_INTERVAL = 15.0
"""Time between looks at the readings [s]."""

_AGREEING = 2
"""Number of looks in a row that have to find the plume out of reach, or the sensor failed: either
may be temporary.
"""

_MEASURABLE = 0.05
"""Least probability that the plume can be crossed: below it the flight gives up [-]."""

LEFT_BY = 150.0
"""Distance that a leaving flight adds to its distance from the vessel until it is over [m]."""

_ON_THE_WATER = 2.0
"""Altitude below which a gliding vehicle has come down [m]."""

_SATURATED = 0.9
"""Largest share of the steps in which a law may demand more than omega_max without being at fault
[-].

In 63,688 flights with the paper's law, settled or not, the share was 0.38 at most.
"""

_GIVEN_UP = (Mode.OUTRUN, Mode.NO_PLUME, Mode.RETREATING)
"""Modes in which the plume is no longer crossed; a flight that holds off resumes after the next
report.
"""


class Settling:
    """Watches a flight, sample by sample.

    A flight settles at the first moment after which the vehicle stays near its reference, and the
    orbit near its place, for a whole period. It stays settled: later effects of turbulence or a
    manoeuvre belong to the flight.

    Parameters
    ----------
    band : distance from the reference that counts as near [m]
    period : of the oscillation [s]
    crossings : number of crossings to fly; 0 without an end
    after : time for which the flight goes on after it has settled; infinite without an end [s]

    Attributes
    ----------
    at : time at which the flight had settled; NaN before that is known [s]
    crossings : number of crossings since then
    tracked : longest time before that for which the vehicle stayed near its reference, with the
        orbit at any place [s]
    centre_error, centre_band : distance of the orbit's centre from its place at the last sample,
        infinite while it is still closing in, and the distance below which it counts as in place
        [m]
    """

    def __init__(
        self, *, band: float, period: float, crossings: int, after: float = math.inf
    ) -> None:
        self._band = band
        self._period = period
        self._demanded = crossings
        self._after = after
        self._since = math.inf
        self._near_since = math.inf
        self._side = 0.0
        self._complete = False
        self._open = True
        self.centre_band = _CENTRE_BANDS * band
        self.centre_error = math.inf
        self.at = math.nan
        self.crossings = 0
        self.tracked = 0.0

    def update(
        self,
        time: float,
        tracking_error: float,
        centre_error: float,
        x: float,
        y: float,
        axis: float,
    ) -> bool:
        """Record a sample; return whether the flight was complete at the sample before.

        Parameters
        ----------
        time : [s]
        tracking_error : distance to the reference [m]
        centre_error : distance of the orbit's centre from its place, infinite while that is still
            closing in [m]
        x, y : north and east of the vessel [m]
        axis : course along which the plume trails [rad]
        """
        self.centre_error = centre_error
        cos_a, sin_a = math.cos(axis), math.sin(axis)
        before, self._side = self._side, cos_a * y - sin_a * x
        if self._open:
            near = tracking_error < self._band
            self._near_since = min(self._near_since, time) if near else math.inf
            self.tracked = max(self.tracked, time - self._near_since)
        if self._open and (tracking_error >= self._band or centre_error >= self.centre_band):
            self._since, self.crossings = math.inf, 0
        elif self._since == math.inf:
            self._since = time
        elif before * self._side < 0.0 and cos_a * x + sin_a * y > 0.0:
            self.crossings += 1
        if self._open and time - self._since >= self._period:
            self.at, self._open = self._since, False
        complete, self._complete = self._complete, not self._open and self._flown(time)
        return complete

    def _flown(self, time: float) -> bool:
        """Return whether it has the required time after settling and the required crossings; False
        where neither is required.
        """
        crossed = 0 < self._demanded <= self.crossings
        if self._after == math.inf:
            return crossed
        return time - self.at >= self._after and self.crossings >= self._demanded


class StopReason(Enum):
    """The reason why a flight leaves early."""

    ABOVE = "verdict: above"
    BELOW = "verdict: below"
    OUT_OF_REACH = "plume out of reach"
    SENSOR = "sensor failed"


class EarlyStop:
    """Checks periodically whether the flight can end early, and then makes it leave.

    Parameters
    ----------
    reader : of the gases
    mission : that follows the plume
    settling : gives the time after which readings count

    Attributes
    ----------
    reason : why the flight leaves; None while it goes on
    left_at : when it began to leave [s]
    verdict : on the fuel, by all looks
    """

    def __init__(self, reader: GasReader, mission: PlumeFollowing, settling: Settling) -> None:
        self._reader, self._mission, self._settling = reader, mission, settling
        self._next_look, self._same_finding = LOOK_INTERVAL, 0
        self._last: StopReason | None = None
        self._left_from = math.inf
        self.reason: StopReason | None = None
        self.left_at = math.nan
        self.verdict = RepeatedVerdict(reader.limit_percent)

    @property
    def message(self) -> str:
        """Return the reason why the flight left without a verdict, in a sentence."""
        axis = self._mission.axis
        believed = ""
        if isinstance(axis, SearchedAxis) and not math.isnan(axis.estimate.height):
            found = axis.estimate
            believed = (
                f"; the plume's axis was taken to be {found.height:.0f} m high, with a deviation of"
                f" {found.height_deviation:.0f} m"
            )
        reason = self.reason.value if self.reason else ""
        return f"{reason}: it left at {self.left_at:.0f} s without a verdict{believed}"

    def has_left(self, time: float, distance: float) -> bool:
        """Return whether the flight has left, at a time [s] and a distance from the vessel [m]."""
        if self.reason is not None:
            return distance > self._left_from + LEFT_BY
        if time < self._next_look:
            return False
        self._next_look += LOOK_INTERVAL
        found = self._look()
        self._same_finding = self._same_finding + 1 if found is self._last else 1
        self._last = found
        needed = 1 if found in (StopReason.ABOVE, StopReason.BELOW) else _AGREEING
        if found is not None and self._same_finding >= needed:
            self.reason, self.left_at, self._left_from = found, time, distance
            self._mission.depart()
        return False

    def _look(self) -> StopReason | None:
        """Return the present reason to stop, or None."""
        axis = self._mission.axis
        if isinstance(axis, SearchedAxis):
            if axis.sensor is not SensorState.WORKING:
                return StopReason.SENSOR
            orbit = self._mission.orbit
            # Off its orbit a flight detects nothing, regardless of the plume's place.
            on_orbit = orbit is not None and orbit.in_place
            if on_orbit and axis.mode is not Mode.FOUND and axis.measurable() < _MEASURABLE:
                return StopReason.OUT_OF_REACH
        if math.isnan(self._settling.at):
            return None
        readings, limit = self._reader.readings(self._settling.at), self._reader.limit_percent
        try:
            found = estimate(readings, self._reader.spec, limits_percent=(limit,))
        except MeasurementError:
            return None
        verdict = self.verdict.look(
            found.fsc_percent,
            noise=found.noise_percent,
            total=found.total_percent,
            admitted=found.quality != "C",
        )
        return None if verdict == OPEN else StopReason(f"verdict: {verdict}")


class Ending:
    """Decides when a flight is over, and how it ended.

    Parameters
    ----------
    plan, vehicle, guidance, settling : of the flight
    early_stop : decides when it can end early; None where it may not

    Attributes
    ----------
    guarded : whether the keep-out guard changed a command in the flight; the loop sets it at its
        end
    saturated : share of the steps in which the law demanded more than omega_max [-]; set likewise
    given_back : why the vehicle takes no more commands, set by an external pilot; the flight is
        then over at the next sample. Empty while it takes commands
    outcome, message : outcome in a word, and the reason in a sentence; empty for a completed flight
    """

    def __init__(
        self,
        plan: FlightPlan,
        vehicle: Vehicle,
        guidance: Guidance,
        settling: Settling,
        early_stop: EarlyStop | None,
    ) -> None:
        self._plan, self._vehicle, self._guidance = plan, vehicle, guidance
        self._settling, self._early_stop = settling, early_stop
        self._ditched, self._fault, self._end = False, "", 0.0
        self._noticed = math.inf
        self.guarded, self.saturated = False, 0.0
        self.given_back = ""

    def reached(
        self, time: float, motion: MeasuredMotion, sample: tuple[float, ...], *, complete: bool
    ) -> bool:
        """Return whether the flight is over at a sample; ``complete`` says whether it has all
        required crossings.
        """
        monitor, self._end = self._guidance.monitor, time
        failed = monitor is not None and monitor.fault is not Fault.NONE
        self._noticed = min(self._noticed, time) if failed else math.inf
        self._ditched = failed and sample[0] < _ON_THE_WATER
        self._fault = "" if self._ditched else self._vehicle.fault(sample)
        over = complete
        stop = self._early_stop
        if stop is not None:
            target = self._guidance.target
            distance = math.hypot(motion.north - target.north, motion.east - target.east)
            over = stop.has_left(time, distance) or (complete and stop.reason is None)
        return bool(self._fault) or self._ditched or over or bool(self.given_back)

    @property
    def stop_reason(self) -> str:
        """Return why the flight left early, or an empty text."""
        stop = self._early_stop
        return stop.reason.value if stop is not None and stop.reason is not None else ""

    @property
    def verdict(self) -> RepeatedVerdict | None:
        """Return the verdict on the fuel by all looks, or None without a look."""
        return self._early_stop.verdict if self._early_stop is not None else None

    @property
    def mode(self) -> str:
        """Return the mode of the guidance at the end, or ``DITCHED``."""
        return DITCHED if self._ditched else self._guidance.mode.value

    @property
    def outcome(self) -> Outcome:
        """Return how the flight ended."""
        mode, plan = self._guidance.mode, self._plan
        if self._fault:
            return Outcome.DIVERGED
        # A vehicle that was given back flies on, but not as the guidance orders.
        if self._ditched or (mode in LOST and not self.given_back):
            return Outcome.AIRCRAFT_LOST
        if plan.world is None or self.stop_reason.startswith("verdict"):
            return Outcome.COMPLETED
        if self.stop_reason:
            return Outcome.INCOMPLETE
        if math.isnan(self._settling.at):
            return Outcome.NOT_SETTLED
        flown = self._settling.crossings >= max(1, plan.crossings) and not self._missing
        # A complete flight is over, regardless of the present mode of its guidance.
        endless = not plan.crossings and plan.after_settling == math.inf
        given_up = endless and mode in _GIVEN_UP
        return Outcome.COMPLETED if flown and not given_up else Outcome.INCOMPLETE

    @property
    def _missing(self) -> float:
        """Return the remaining part of the required time after settling [s]."""
        demanded = self._plan.after_settling
        if demanded == math.inf:
            return 0.0
        return max(0.0, demanded - (self._end - self._settling.at))

    @property
    def message(self) -> str:
        """Return why the flight did not complete, in a sentence; empty where it did."""
        match self.outcome:
            case Outcome.DIVERGED:
                return f"{self._fault} at {self._end:.1f} s"
            case Outcome.AIRCRAFT_LOST:
                still = f"was still {self.mode} towards the sea"
                what = "came down on the sea" if self._ditched else still
                return (
                    f"it {what} at {self._end:.1f} s, {self._crossings()}{self._after_fault()}"
                    f"{self._what_was_noticed()}"
                )
            case Outcome.NOT_SETTLED | Outcome.INCOMPLETE:
                return self._shortfall()
        return ""

    def _crossings(self) -> str:
        settling, demanded = self._settling, self._plan.crossings
        if math.isnan(settling.at):
            return "before it had settled"
        return f"after {settling.crossings}{f' of {demanded}' if demanded else ''} crossings"

    def _after_fault(self) -> str:
        """Return the faults of the scenario that had begun, in words, or an empty text."""
        begun = self._plan.world.faults.begun(self._end) if self._plan.world else ()
        if not begun:
            return ""
        named = " and ".join(f"'{fault.kind}' at {fault.begins:.1f} s" for fault in begun)
        return f", after the fault{'s' * (len(begun) > 1)} {named}"

    def _what_was_noticed(self) -> str:
        """Return the fault that was noticed in flight and not revoked, or an empty text."""
        monitor = self._guidance.monitor
        if monitor is None or self._noticed == math.inf:
            return ""
        return f", noticed as '{monitor.fault.value}' at {self._noticed:.1f} s"

    def _shortfall(self) -> str:
        settling, plan, mode = self._settling, self._plan, self._guidance.mode
        if self.given_back:
            return f"{self.given_back} at {self._end:.1f} s, {self._crossings()}"
        if self._early_stop is not None and self._early_stop.reason is not None:
            return self._early_stop.message
        ended = f", and ended {mode.value}" if mode in _GIVEN_UP else ""
        within = f"within {plan.duration_max:g} s{ended}"
        guard = ", and the keep-out guard may hold it off its orbit" if self.guarded else ""
        if math.isnan(settling.at):
            return self._unsettled(f"did not settle {within}", guard)
        after = plan.after_settling
        if self._missing:
            flown = f"flew {after - self._missing:.0f} of {after:g} s after settling"
        elif after < math.inf and not plan.crossings:
            # The flight ended as planned, before the longest flight time.
            return (
                f"flew no crossing in {self._end - settling.at:.0f} s after settling: fly longer"
                " (flight.after_settling_s), or ask for crossings (flight.crossings)"
            )
        elif plan.crossings or not settling.crossings:
            demanded = f" of {plan.crossings}" if plan.crossings else ""
            flown = f"flew {settling.crossings}{demanded} crossings after settling"
        else:
            crossed = f"after {settling.crossings} crossings"
            return f"ended {mode.value} {crossed}: the plume was no longer crossed"
        remedy = "allow more time (flight.duration_max_s), or start closer"
        return f"{flown} {within}: {remedy}{guard}"

    def _unsettled(self, what: str, guard: str) -> str:
        """Return why a flight did not settle, and what may help."""
        tracked = self._settling.tracked
        if self.saturated > _SATURATED:
            return (
                f"{what}: its steering law demanded more than the largest heading rate in"
                f" {100.0 * self.saturated:.0f} % of the steps; check that it returns rad/s,"
                " positive to the right (guidance.law)"
            )
        longer = "fly longer (flight.duration_max_s) or start closer"
        remedy = f"{longer}, though neither may be enough{guard}"
        if tracked < self._plan.settling_period:
            return f"{what}: {remedy}"
        tracking = f"it tracked its reference for {tracked:.0f} s, but {self._orbit()}"
        return f"{what}: {tracking}. {remedy.capitalize()}"

    def _orbit(self) -> str:
        """Return, in words, how far the orbit was from its place at the end of a flight that
        tracked it and did not settle.
        """
        off, most = self._settling.centre_error, self._settling.centre_band
        if off == math.inf:
            return "its orbit was still closing in on its place"
        if off < most:
            return "its orbit was not in its place for a whole period"
        near = f"{most:g} m are near enough"
        return f"its orbit was still {off:.0f} m from its place at the end ({near})"


def failure(error: Exception | SystemExit) -> Row:
    """Return the outcome and the message of a flight that an error ended.

    Raises
    ------
    MemoryError : if that is the error: the same flight may succeed in a separate process
    """
    if isinstance(error, MemoryError):
        raise error
    if isinstance(error, InfeasibleError | MeasurementError):
        return unflown(Outcome.INFEASIBLE, str(error))
    message = str(error)
    if not isinstance(error, RefusedError):
        frames = traceback.extract_tb(error.__traceback__)
        # Methods of dataclasses are generated from text, and have no file; their caller has one.
        in_files = [frame for frame in frames if not frame.filename.startswith("<")]
        where = (in_files or frames)[-1]
        message = f"{type(error).__name__}: {error} ({Path(where.filename).name}:{where.lineno})"
    return unflown(Outcome.FAILED, message)


def unflown(outcome: Outcome, message: str) -> Row:
    """Return the outcome and the message, in one line, of a flight that was not flown or not
    completed.
    """
    return {"outcome": outcome.value, "message": one_line(message), "criteria_met": False}
