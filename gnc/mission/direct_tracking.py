"""The mission beside a steady vessel that is known exactly: track the paper's reference, on the way
to it go round the vessel.
"""

import copy
import math
from dataclasses import dataclass
from typing import Any, NamedTuple

from gnc.estimation.health import Fault
from gnc.estimation.navigation import OwnMotion
from gnc.estimation.vessel import TargetMotion
from gnc.guard.guard import KeepoutGuard
from gnc.mission.approach import LOST_TRACK, Approach, ApproachParameters
from gnc.mission.mode import Mode
from gnc.reference.closing import ClosingReference
from gnc.reference.joining import JoinedOrbit
from gnc.reference.reference import Reference
from gnc.tracker import Tracker, TrackingParameters

STANDOFF = 2.0
"""How far outside its place the orbit is joined, over the distance from the reference that counts
as tracked [-].
"""

CLOSING_RATE = 0.2
"""How fast it then closes in, over V_r [-]."""


class SteadyCentre(NamedTuple):
    """A centre of oscillation that keeps its place beside the vessel; not a number for a reference
    without a vessel.

    Attributes
    ----------
    x, y : north and east of the vessel [m]
    speed_ratio : nu [-]
    """

    x: float = math.nan
    y: float = math.nan
    speed_ratio: float = math.nan


NO_CENTRE = SteadyCentre()
"""The centre of a reference without a vessel."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Joining:
    """How an orbit is joined.

    Attributes
    ----------
    approach : the way to it
    orbit : to be joined where it is nearest
    plan_interval : guidance steps between plans
    """

    approach: ApproachParameters
    orbit: JoinedOrbit
    plan_interval: int


@dataclass(frozen=True, slots=True, kw_only=True)
class DirectParameters:
    """A reference to track, known in advance.

    Attributes
    ----------
    reference : as it is at time 0
    centre : of its oscillation
    joining : how its orbit is joined; it is tracked from the first step on if not given
    """

    reference: Reference
    centre: SteadyCentre = NO_CENTRE
    joining: Joining | None = None

    @property
    def plan_interval(self) -> int:
        """Return the guidance steps between plans; 0 for one plan alone."""
        return self.joining.plan_interval if self.joining else 0


class DirectTracking:
    """Tracks a reference that is given for the whole flight; attributes as of
    ``gnc.mission.mission.Mission``.

    Differs from the paper because its law knows nothing of the keep-out area: on the way to a far
    reference it leads through it, and law and guard would undo each other's work for as long as the
    flight lasts. Here the vehicle goes round the vessel, and joins the orbit somewhat outside of
    its place, at the phase that is nearest; once tracked, the orbit closes in. An orbit that takes
    all of the heading rate is joined slowed down (``ReferenceShape.joining_share``), and joined
    anew where it is lost.

    Parameters
    ----------
    parameters : of the mission
    tracking : of the tracker
    own, target : motion of the vehicle and of the vessel
    guard : of the keep-out area, or none
    altitude : of the plume at the reference [m]
    """

    __slots__ = (
        "_approach", "_axis", "_closing", "_guard", "_joining", "_losable", "_own", "_standoff", "_target", "_tracking", "airspeed",
        "altitude", "centre", "centre_error", "in_place", "leaving", "mode", "overriding", "started", "tracker",
    )  # fmt: skip

    def __init__(
        self,
        parameters: DirectParameters,
        tracking: TrackingParameters,
        *,
        own: OwnMotion,
        target: TargetMotion,
        guard: KeepoutGuard | None,
        altitude: float,
    ) -> None:
        self.tracker: Tracker[Any] = Tracker(tracking, copy.copy(parameters.reference))
        self.centre, self._axis = (
            parameters.centre,
            math.atan2(parameters.centre.y, parameters.centre.x),
        )
        self._own, self._target, self._guard, self._tracking = own, target, guard, tracking
        self._joining, self._closing = parameters.joining, False
        self._losable = (
            parameters.joining is not None and parameters.joining.orbit.shape.joining_share < 1.0
        )
        self._approach: Approach | None = None
        self._standoff, self.airspeed, self.altitude = 0.0, parameters.reference.speed, altitude
        if self._joining is not None:
            approach = self._joining.approach
            self._approach = Approach(
                approach,
                own=own,
                target=target,
                speed=parameters.reference.speed,
                heading_rate_max=tracking.heading_rate_max,
                lag=tracking.lag,
                time_step=tracking.time_step,
            )
            self._standoff, self.airspeed = STANDOFF * approach.tracked, approach.airspeed
        self.overriding, self.leaving = self._approach is not None, False
        self.started, self.centre_error, self.in_place = True, self._standoff, not self.overriding
        self.mode = Mode.APPROACH if self.overriding else Mode.TRACKING

    def plan(self, time: float) -> None:  # noqa: ARG002 - of the Protocol
        """Decide whether to go on round the vessel, to track the reference, and whether its orbit
        may close in.
        """
        guarding = self._guarding
        watching = self.overriding or self._closing or guarding or self._losable
        if self._approach is None or self._joining is None or not watching:
            return
        reference, own = self.tracker.reference, self._own
        error = math.hypot(reference.north - own.north, reference.east - own.east)
        tracked = self._joining.approach.tracked
        if self.overriding:
            x, y = self._joined_at()
            if self._approach.joins(
                x, y, self._axis, error=error, tracking=False, guarding=guarding
            ):
                self._join(self._joining.orbit)
        elif (guarding or (self._losable and not self._closing)) and error > LOST_TRACK * tracked:
            self.overriding, self._closing = True, False
            if guarding:
                self._approach.join_nearer()
        elif self._closing:
            ahead = self.tracker.ahead
            near = error < (LOST_TRACK if ahead.closing else 1.0) * tracked
            if near:
                ahead.reference.spend(1.0)
            # A slower orbit is larger: it would reach farther towards the vessel.
            ahead.closing = near and ahead.reference.share == 1.0
            if ahead.standoff == 0.0:
                # In its place it no longer has to be moved.
                self.tracker.ahead, self._closing = ahead.reference, False
            self.centre_error = ahead.standoff
        self.in_place = not (self.overriding or self._closing)
        self.mode = Mode.APPROACH if self.overriding else Mode.TRACKING

    def command(self, last_command: float) -> float:
        """Return the heading rate that leads to where the orbit is joined, round the vessel
        [rad/s]; the law's without a way.
        """
        if self._approach is None:
            return self.tracker.heading_rate_command
        return self._approach.command(
            *self._joined_at(), last_command, additional_range=0.0, guarding=self._guarding
        )

    def leave(self, fault: Fault) -> None:
        """Refuse to leave: this mission has no departure, and is not given a monitor that could
        demand it.

        Raises
        ------
        ValueError : always
        """
        raise ValueError(
            f"the vehicle has a fault, {fault.value}, and its mission has no departure; follow the plume instead"
        )

    @property
    def _guarding(self) -> bool:
        """Whether the keep-out guard turns the vehicle away."""
        return self._guard is not None and self._guard.intervening

    def _joined_at(self) -> tuple[float, float]:
        """Return the centre of the orbit as it is joined, north and east of the vessel [m]."""
        return self.centre.x + self._standoff * math.cos(
            self._axis
        ), self.centre.y + self._standoff * math.sin(self._axis)

    def _join(self, orbit: JoinedOrbit) -> None:
        """Track the orbit from where it is nearest."""
        own, target, centre, last = (
            self._own,
            self._target,
            self.centre,
            self.tracker.heading_rate_command,
        )
        reference = orbit.nearest(
            target.north + centre.x,
            target.east + centre.y,
            north=own.north - self._standoff * math.cos(self._axis),
            east=own.east - self._standoff * math.sin(self._axis),
            course=own.course,
            turn_radius=own.speed / self._tracking.heading_rate_max,
        )
        time_step, rate = self._tracking.time_step, CLOSING_RATE * reference.speed
        joined = ClosingReference(
            reference, axis=self._axis, standoff=self._standoff, rate=rate, time_step=time_step
        )
        self.tracker = Tracker(self._tracking, joined)
        self.tracker.heading_rate_command = last
        self.overriding, self._closing = False, True
