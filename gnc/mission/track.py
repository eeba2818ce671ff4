"""The mission beside a steady vessel that is known exactly: track the paper's reference."""

import copy
import math
from dataclasses import dataclass
from typing import Any

from gnc.estimation.health import Fault
from gnc.estimation.navigation import OwnMotion
from gnc.estimation.vessel import TargetMotion
from gnc.mission.mission import NO_CENTRE, TRACK, Centre, Mode, OrbitStatus, Order
from gnc.mission.way import LOST_TRACK, Approach, ApproachParameters
from gnc.reference.oscillating import ClosingReference, JoinedOrbit
from gnc.reference.reference import Reference
from gnc.tracker import Tracker, TrackingParameters

STANDOFF = 2.0
"""Distance outside of its place at which the orbit is joined, over the distance that counts as
tracked [-].
"""

CLOSING_RATE = 0.2
"""Rate at which it then closes in, over V_r [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Joining:
    """Parameters of joining an orbit.

    Attributes
    ----------
    approach : the way to it
    orbit : orbit to join at its nearest point
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
    reference : at time 0
    centre : of its oscillation
    joining : how the orbit is joined; None to track the reference from the first step on
    """

    reference: Reference
    centre: Centre = NO_CENTRE
    joining: Joining | None = None

    @property
    def plan_interval(self) -> int:
        """Return the guidance steps between plans; 0 for one plan alone."""
        return self.joining.plan_interval if self.joining else 0


class DirectTracking:
    """Tracks a reference that is given for the whole flight; see ``gnc.mission.mission.Mission``.

    Differs from the paper because its law does not know the keep-out area: on the way to a far
    reference the law leads through the area, and law and guard would counteract each other for the
    whole flight. Here the vehicle goes round the vessel, and joins the orbit somewhat outside of
    its place, at the nearest phase; once it is tracked, the orbit closes in. An orbit that takes
    all of the heading rate is joined slowed down
    (``ReferenceShape.turn_rate_fraction_until_tracked``), and joined anew where it is lost.

    Parameters
    ----------
    parameters : of the mission
    tracking : of the tracker
    altitude : of the plume at the reference [m]
    """

    def __init__(
        self, parameters: DirectParameters, tracking: TrackingParameters, *, altitude: float
    ) -> None:
        self._tracking = tracking
        self._altitude = altitude
        self._centre = parameters.centre
        self._axis = math.atan2(parameters.centre.y, parameters.centre.x)
        self._joining = parameters.joining
        self.tracker: Tracker[Any] = Tracker(tracking, copy.copy(parameters.reference))
        # Whether the orbit may be lost without an action of the guard, and joined anew.
        self._losable = False
        self._on_the_way = False
        self._closing = False
        self._standoff = 0.0
        self._airspeed = parameters.reference.speed
        self._approach: Approach | None = None
        if self._joining is not None:
            approach = self._joining.approach
            self._losable = self._joining.orbit.shape.turn_rate_fraction_until_tracked < 1.0
            self._on_the_way = True
            self._standoff = STANDOFF * approach.tracked
            self._airspeed = approach.airspeed
            self._approach = Approach(approach, tracking, parameters.reference.speed)
        self._centre_error = self._standoff
        self.orbit: OrbitStatus | None = OrbitStatus(
            self._centre, self._centre_error, not self._on_the_way
        )

    def plan(
        self,
        time: float,  # noqa: ARG002 - of the Protocol
        own: OwnMotion,
        vessel: TargetMotion,
        *,
        renew: bool,
        guarding: bool,
    ) -> Order:
        """Return the order to track the reference, or the way round the vessel to its orbit."""
        if self._joining is None or self._approach is None:
            return Order(TRACK, self._airspeed, self._altitude, Mode.TRACKING)
        watching = self._on_the_way or self._closing or guarding or self._losable
        if renew and watching:
            self._decide(self._joining, self._approach, own, vessel, guarding)
        if not self._on_the_way:
            return Order(TRACK, self._airspeed, self._altitude, Mode.TRACKING)
        x, y = self._joined_at()
        command = self._approach.command(
            own,
            vessel,
            x,
            y,
            self.tracker.heading_rate_command,
            additional_range=0.0,
            guarding=guarding,
        )
        return Order(command, self._airspeed, self._altitude, Mode.APPROACH)

    def react(self, fault: Fault) -> None:
        """Raise a ValueError: this mission has no departure, and its flights no health monitor."""
        raise ValueError(
            f"the vehicle has a fault, {fault.value}, and its mission has no departure; follow the"
            " plume instead"
        )

    def _decide(
        self,
        joining: Joining,
        approach: Approach,
        own: OwnMotion,
        vessel: TargetMotion,
        guarding: bool,
    ) -> None:
        """Decide whether to go on round the vessel or to track, and whether the orbit closes in."""
        reference = self.tracker.reference
        error = math.hypot(reference.north - own.north, reference.east - own.east)
        tracked = joining.approach.tracked
        lost = error > LOST_TRACK * tracked
        if self._on_the_way:
            x, y = self._joined_at()
            if approach.should_track(
                own, vessel, x, y, self._axis, error=error, tracking=False, guarding=guarding
            ):
                self._join(joining.orbit, own, vessel)
        elif (guarding or (self._losable and not self._closing)) and lost:
            self._on_the_way = True
            self._closing = False
            if guarding:
                approach.halve_join_distance()
        elif self._closing:
            self._close_in(error, tracked)
        in_place = not (self._on_the_way or self._closing)
        self.orbit = OrbitStatus(self._centre, self._centre_error, in_place)

    def _close_in(self, error: float, tracked: float) -> None:
        """Let the orbit close in while the reference is tracked."""
        ahead: ClosingReference = self.tracker.ahead
        near = error < (LOST_TRACK if ahead.closing else 1.0) * tracked
        if near:
            ahead.reference.set_turn_rate_fraction(1.0)
        # A slower orbit is larger, and would reach farther towards the vessel.
        ahead.closing = near and ahead.reference.turn_rate_fraction == 1.0
        if ahead.standoff == 0.0:
            # An orbit in its place no longer has to be moved.
            self.tracker.ahead = ahead.reference
            self._closing = False
        self._centre_error = ahead.standoff

    def _joined_at(self) -> tuple[float, float]:
        """Return the centre of the orbit that is joined, north and east of the vessel [m]."""
        return (
            self._centre.x + self._standoff * math.cos(self._axis),
            self._centre.y + self._standoff * math.sin(self._axis),
        )

    def _join(self, orbit: JoinedOrbit, own: OwnMotion, vessel: TargetMotion) -> None:
        """Track the orbit from its nearest point."""
        last = self.tracker.heading_rate_command
        reference = orbit.nearest(
            vessel.north + self._centre.x,
            vessel.east + self._centre.y,
            north=own.north - self._standoff * math.cos(self._axis),
            east=own.east - self._standoff * math.sin(self._axis),
            course=own.course,
            turn_radius=own.speed / self._tracking.heading_rate_max,
        )
        joined = ClosingReference(
            reference,
            axis=self._axis,
            standoff=self._standoff,
            rate=CLOSING_RATE * reference.speed,
            time_step=self._tracking.time_step,
        )
        self.tracker = Tracker(self._tracking, joined)
        self.tracker.heading_rate_command = last
        self._on_the_way = False
        self._closing = True
