"""When a flight is over, and how it ended."""

import math

from gnc.estimation.health import Fault
from gnc.estimation.navigation import MeasuredMotion
from gnc.guidance import Guidance
from gnc.mission.mission import LOST, Mode
from measurement.estimate.repeated import RepeatedVerdict
from scenarios.flight.judge import Judge
from scenarios.flight.outcome import Outcome
from scenarios.flight.settling import Settling
from scenarios.planning.flight_plan import FlightPlan
from scenarios.scenario.sections.flight import DITCHED
from scenarios.vehicles.vehicle import Vehicle

_ON_THE_WATER = 2.0
"""Altitude below which a gliding vehicle has come down [m]."""

_SATURATED = 0.9
"""Part of the steps of a flight in which its law asked for more than omega_max, above which the law
is at fault [-].

Of 63,688 flights with the paper's law, whether they settled or not, it was 0.38 at most.
"""

_GIVEN_UP = (Mode.OUTRUN, Mode.NO_PLUME, Mode.RETREATING)
"""Modes in which the plume is no longer crossed; a flight that holds off resumes with the next
report.
"""


class Ending:
    """Decides when a flight is over, and how it ended.

    Parameters
    ----------
    plan, vehicle, guidance, settling : of the flight
    judge : says when it has enough, or none

    Attributes
    ----------
    guarded : whether the keep-out guard changed a command in the flight; the loop says so at its
        end
    saturated : part of the steps in which the law asked for more than omega_max [-]; likewise
    outcome, message : in a word, and why in a sentence; nothing to say where it completed
    """

    def __init__(
        self,
        plan: FlightPlan,
        vehicle: Vehicle,
        guidance: Guidance,
        settling: Settling,
        judge: Judge | None,
    ) -> None:
        self._plan, self._vehicle, self._guidance, self._settling, self._judge = (
            plan,
            vehicle,
            guidance,
            settling,
            judge,
        )
        self._ditched, self._fault, self._end = False, "", 0.0
        self.guarded, self.saturated = False, 0.0
        self._noticed = math.inf

    def reached(
        self, time: float, motion: MeasuredMotion, sample: tuple[float, ...], *, complete: bool
    ) -> bool:
        """Return whether the flight is over at a sample; ``complete`` says whether it has all
        crossings that are asked for.
        """
        monitor, self._end = self._guidance.monitor, time
        self._ditched = (
            monitor is not None and monitor.fault is not Fault.NONE and sample[0] < _ON_THE_WATER
        )
        if monitor is None or monitor.fault is Fault.NONE:
            self._noticed = math.inf
        else:
            self._noticed = min(self._noticed, time)
        self._fault = "" if self._ditched else self._vehicle.fault(sample)
        over = complete
        if self._judge is not None:
            target = self._guidance.target
            over = self._judge.over(
                time, math.hypot(motion.north - target.north, motion.east - target.east)
            )
            over = over or (complete and self._judge.enough is None)
        return bool(self._fault) or self._ditched or over

    @property
    def enough(self) -> str:
        """Return why the flight left before its time, or nothing."""
        return (
            self._judge.enough.value
            if self._judge is not None and self._judge.enough is not None
            else ""
        )

    @property
    def verdict(self) -> RepeatedVerdict | None:
        """Return the verdict on the fuel by all looks, or None where nobody looked."""
        return self._judge.verdict if self._judge is not None else None

    @property
    def mode(self) -> str:
        """Return the mode of the guidance at the end, or ``DITCHED``."""
        return DITCHED if self._ditched else self._guidance.mode.value

    @property
    def outcome(self) -> Outcome:
        """Return how the flight ended."""
        mode = self._guidance.mode
        if self._fault:
            return Outcome.DIVERGED
        if self._ditched or mode in LOST:
            return Outcome.AIRCRAFT_LOST
        if self._plan.world is None or self.enough.startswith("verdict"):
            return Outcome.COMPLETED
        if self.enough:
            return Outcome.INCOMPLETE
        if math.isnan(self._settling.at):
            return Outcome.NOT_SETTLED
        flown = self._settling.crossings >= max(1, self._plan.crossings) and not self._missing
        # One that has flown all that it is to fly is over, whatever its guidance is about to do.
        given_up = (
            not self._plan.crossings and self._plan.after_settling == math.inf and mode in _GIVEN_UP
        )
        return Outcome.COMPLETED if flown and not given_up else Outcome.INCOMPLETE

    @property
    def _missing(self) -> float:
        """Return how much of the time after settling that is asked for has not been flown [s]."""
        asked = self._plan.after_settling
        return 0.0 if asked == math.inf else max(0.0, asked - (self._end - self._settling.at))

    @property
    def message(self) -> str:
        """Return why the flight did not complete, in a sentence; nothing where it did."""
        match self.outcome:
            case Outcome.DIVERGED:
                return f"{self._fault} at {self._end:.1f} s"
            case Outcome.AIRCRAFT_LOST:
                what = (
                    "came down on the sea"
                    if self._ditched
                    else f"was still {self.mode} towards the sea"
                )
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
        """Return which fault of the scenario had begun, or nothing."""
        fault = self._plan.world.fault if self._plan.world else None
        return (
            f", after the fault '{fault.kind}' at {fault.begins:.1f} s"
            if fault and fault.begins <= self._end
            else ""
        )

    def _what_was_noticed(self) -> str:
        """Return the fault that was noticed in flight and not taken back, or nothing."""
        monitor = self._guidance.monitor
        if monitor is None or self._noticed == math.inf:
            return ""
        return f", noticed as '{monitor.fault.value}' at {self._noticed:.1f} s"

    def _shortfall(self) -> str:
        settling, plan, mode = self._settling, self._plan, self._guidance.mode
        if self._judge is not None and self._judge.enough is not None:
            return self._judge.words
        ended = f", and ended {mode.value}" if mode in _GIVEN_UP else ""
        within = f"within {plan.duration_max:g} s{ended}"
        guard = ", and the keep-out guard may hold it off its orbit" if self.guarded else ""
        if math.isnan(settling.at):
            return self._unsettled(f"did not settle {within}", guard)
        if self._missing:
            flown = f"flew {plan.after_settling - self._missing:.0f} of {plan.after_settling:g} s after settling"
        elif plan.after_settling < math.inf and not plan.crossings:
            # It ended as it was to end, before the end of the longest flight.
            return (
                f"flew no crossing in {self._end - settling.at:.0f} s after settling: fly longer (flight.after_settling_s), or ask"
                " for crossings (flight.crossings)"
            )
        elif plan.crossings or not settling.crossings:
            flown = f"flew {settling.crossings}{f' of {plan.crossings}' if plan.crossings else ''} crossings after settling"
        else:
            return f"ended {mode.value} after {settling.crossings} crossings: the plume was no longer crossed"
        return f"{flown} {within}: allow more time (flight.duration_max_s), or start closer{guard}"

    def _unsettled(self, what: str, guard: str) -> str:
        """Return why a flight did not settle, and what may help."""
        tracked = self._settling.tracked
        if self.saturated > _SATURATED:
            return (
                f"{what}: its steering law asked for more than the largest heading rate in {100.0 * self.saturated:.0f} % of the"
                " steps; check that it returns rad/s, positive to the right (guidance.law)"
            )
        remedy = f"fly longer (flight.duration_max_s) or start closer, though neither may be enough{guard}"
        if tracked < self._plan.settling_period:
            return f"{what}: {remedy}"
        return f"{what}: it tracked its reference for {tracked:.0f} s, but {self._orbit()}. {remedy.capitalize()}"

    def _orbit(self) -> str:
        """Return how the orbit stood to its place at the end of a flight that tracked it and did
        not settle.
        """
        off, most = self._settling.centre_error, self._settling.centre_band
        if off == math.inf:
            return "its orbit was still closing in on its place"
        if off >= most:
            return f"its orbit was still {off:.0f} m from its place at the end ({most:g} m are near enough)"
        return "its orbit was not in its place for a whole period"
