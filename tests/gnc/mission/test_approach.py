import math

import pytest
from gnc_cases import HEADING_RATE_MAX, SPEED, motion

from gnc.estimation.own_motion import TrueNavigation
from gnc.estimation.target_motion import SteadyTarget
from gnc.mission.approach import Approach, ApproachParameters

PARAMETERS = ApproachParameters(blocked_radius=201.0, round_radius=232.0, join_distance=150.0, tracked=12.0, airspeed=21.0)
CENTRE = (-240.0, 0.0)
AXIS = math.pi


def approach(place, course=0.0, *, lag=0.0, heading_rate=0.0):
    """Return the approach of a vehicle at a place, to a vessel at rest at the origin."""
    own = TrueNavigation()
    own.update(motion(*place, course, SPEED, heading_rate))
    return Approach(PARAMETERS, own=own, target=SteadyTarget(0.0, 0.0), speed=SPEED, heading_rate_max=HEADING_RATE_MAX, lag=lag)


def joins(place, *, error=0.0, tracking=False, guarding=False):
    return approach(place).joins(*CENTRE, AXIS, error=error, tracking=tracking, guarding=guarding)


@pytest.mark.parametrize(
    ("place", "from_afar", "once_tracking"),
    [
        # 150 m from the centre, and 225 m once tracking.
        ((-389.0, 0.0), True, True),
        ((-391.0, 0.0), False, True),
        ((-464.0, 0.0), False, True),
        ((-466.0, 0.0), False, False),
    ],
)
def test_tracking_begins_nearer_to_the_centre_than_it_ends(place, from_afar, once_tracking):
    assert joins(place) is from_afar
    assert joins(place, tracking=True) is once_tracking


@pytest.mark.parametrize(
    ("aspect", "from_afar", "once_tracking"), [(1.15, True, True), (1.25, False, True), (1.85, False, True), (1.95, False, False)]
)
def test_tracking_begins_nearer_to_the_plumes_axis_than_it_ends(aspect, from_afar, once_tracking):
    # 1.2 and 1.9 rad off the axis; near enough to the vessel that a centre 100 m astern of it is within 150 m at any aspect.
    own, x, y = approach((-20.0 * math.cos(aspect), 20.0 * math.sin(aspect))), -100.0, 0.0
    assert own.joins(x, y, AXIS, error=0.0, tracking=False, guarding=False) is from_afar
    assert own.joins(x, y, AXIS, error=0.0, tracking=True, guarding=False) is once_tracking


@pytest.mark.parametrize(("error", "tracked_on"), [(35.0, True), (37.0, False)])
def test_the_guard_holds_off_who_joins_and_who_has_lost_the_reference(error, tracked_on):
    place = (-300.0, 0.0)
    assert joins(place, error=error)
    assert not joins(place, error=error, guarding=True)
    # Lost: three times 12 m away.
    assert joins(place, error=error, tracking=True, guarding=True) is tracked_on
    assert joins(place, error=error, tracking=True)


def test_the_command_turns_to_the_centre_and_within_omega_max():
    # 0.1 rad off: twice omega_max per radian.
    found = approach((-600.0, 0.0), 0.1).command(*CENTRE, 0.0, additional_range=0.0)
    assert found == pytest.approx(-2.0 * HEADING_RATE_MAX * 0.1, rel=1e-9)
    for course in (-3.0, -1.0, 1.0, 3.0):
        found = approach((-600.0, 0.0), course).command(*CENTRE, 0.0, additional_range=0.0)
        assert found == math.copysign(HEADING_RATE_MAX, -course)


def test_it_leads_round_the_vessel_from_ahead():
    # Straight astern from 600 m ahead lies the vessel.
    towards = approach((600.0, 10.0), math.pi)
    assert abs(towards.command(*CENTRE, 0.0, additional_range=0.0)) > 0.1
    # The farther the larger the area that it has to go round.
    assert abs(towards.command(*CENTRE, 0.0, additional_range=60.0)) > abs(towards.command(*CENTRE, 0.0, additional_range=0.0))


def test_it_turns_from_the_course_that_it_will_have_when_the_command_acts():
    late = approach((-600.0, 0.0), 0.1, lag=0.4, heading_rate=0.2)
    # Linear from 0.2 to 0.1 rad/s in 0.4 s: 0.06 rad.
    assert late.course_ahead(0.1) == pytest.approx(0.16, abs=1e-12)
    assert late.command(*CENTRE, 0.1, additional_range=0.0) == pytest.approx(-2.0 * HEADING_RATE_MAX * 0.16, rel=1e-9)
