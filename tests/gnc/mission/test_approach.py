import math

import pytest
from gnc_cases import HEADING_RATE_MAX, SPEED, motion

from gnc.estimation.navigation import TrueNavigation
from gnc.estimation.vessel import SteadyTarget
from gnc.mission.approach import Approach, ApproachParameters

PARAMETERS = ApproachParameters(
    blocked_radius=201.0, round_radius=232.0, join_distance=150.0, tracked=12.0, airspeed=21.0
)
CENTRE = (-240.0, 0.0)
AXIS = math.pi
TIME_STEP = 0.05


def approach(place, course=0.0, *, lag=0.0, heading_rate=0.0):
    """Return the approach of a vehicle at a place, to a vessel at rest at the origin."""
    own = TrueNavigation()
    own.update(motion(*place, course, SPEED, heading_rate))
    return Approach(
        PARAMETERS,
        own=own,
        target=SteadyTarget(0.0, 0.0),
        speed=SPEED,
        heading_rate_max=HEADING_RATE_MAX,
        lag=lag,
        time_step=TIME_STEP,
    )


def command(found, last=0.0, *, additional_range=0.0, guarding=False):
    return found.command(*CENTRE, last, additional_range=additional_range, guarding=guarding)


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
    ("aspect", "from_afar", "once_tracking"),
    [(1.15, True, True), (1.25, False, True), (1.85, False, True), (1.95, False, False)],
)
def test_tracking_begins_nearer_to_the_plumes_axis_than_it_ends(aspect, from_afar, once_tracking):
    # 1.2 and 1.9 rad off the axis; near enough to the vessel that a centre 100 m astern of it is
    # within 150 m at any aspect.
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
    found = command(approach((-600.0, 0.0), 0.1))
    assert found == pytest.approx(-2.0 * HEADING_RATE_MAX * 0.1, rel=1e-9)
    for course in (-3.0, -1.0, 1.0, 3.0):
        found = command(approach((-600.0, 0.0), course))
        assert found == math.copysign(HEADING_RATE_MAX, -course)


def test_it_leads_round_the_vessel_from_ahead():
    # Straight astern from 600 m ahead lies the vessel.
    towards = approach((600.0, 10.0), math.pi)
    assert abs(command(towards)) > 0.1
    # The farther the larger the area that it has to go round.
    assert abs(command(towards, additional_range=60.0)) > abs(command(towards))


def test_it_turns_from_the_course_that_it_will_have_when_the_command_acts():
    late = approach((-600.0, 0.0), 0.1, lag=0.4, heading_rate=0.2)
    # Linear from 0.2 to 0.1 rad/s in 0.4 s: 0.06 rad.
    assert late.course_ahead(0.1) == pytest.approx(0.16, abs=1e-12)
    assert command(late, 0.1) == pytest.approx(-2.0 * HEADING_RATE_MAX * 0.16, rel=1e-9)


def held(found, duration):
    """Return the command after the keep-out guard has turned the vehicle away for so long [s]."""
    for _ in range(round(duration / TIME_STEP)):
        command(found, guarding=True)
    return command(found)


@pytest.mark.parametrize(("east", "side"), [(-100.0, 1.0), (100.0, -1.0)])
def test_held_by_the_guard_on_a_course_beside_the_vessel_it_flies_abeam(east, side):
    # The way to the centre is the shorter one round by the vessel, 30 degrees to that side.
    beside = approach((-180.0, east), 0.0)
    assert command(beside) == side * HEADING_RATE_MAX
    quarter_turn = 0.5 * math.pi / HEADING_RATE_MAX
    assert held(beside, 0.9 * quarter_turn) == side * HEADING_RATE_MAX
    # Abeam is 61 degrees to the other side of a vessel that lies 29 degrees to this one.
    assert held(beside, 0.2 * quarter_turn) == -side * HEADING_RATE_MAX
    off = math.atan2(100.0, 180.0) - 0.5 * math.pi
    slow = approach((-180.0, east), side * (off + 0.05))
    assert held(slow, 1.1 * quarter_turn) == pytest.approx(
        -side * 2.0 * HEADING_RATE_MAX * 0.05, rel=1e-9
    )


def test_it_flies_abeam_no_farther_than_it_goes_round_the_vessel():
    # 232 m; and not where the way does not lead through the course to the vessel.
    quarter_turn = 0.5 * math.pi / HEADING_RATE_MAX
    assert held(approach((-205.0, -112.0), 0.0), 2.0 * quarter_turn) == HEADING_RATE_MAX
    assert held(approach((-180.0, -100.0), math.pi), 2.0 * quarter_turn) == -HEADING_RATE_MAX


def test_tracking_does_not_begin_while_it_flies_abeam():
    beside = approach((-180.0, -100.0), 0.0)
    assert beside.joins(*CENTRE, AXIS, error=0.0, tracking=False, guarding=False)
    held(beside, math.pi / HEADING_RATE_MAX)
    assert not beside.joins(*CENTRE, AXIS, error=0.0, tracking=False, guarding=False)


def test_whom_the_guard_threw_back_joins_from_half_as_far_but_not_from_nearer_than_counts_as_lost():
    found, reached = approach((-390.0 + 1.0, 0.0)), []
    for _ in range(4):
        reached.append([off for off in (149.0, 74.0, 37.0, 35.0) if joins_from(found, off)])
        found.join_nearer()
    # 150, 75, 37.5 and 36 m: three times 12.
    assert reached == [[149.0, 74.0, 37.0, 35.0], [74.0, 37.0, 35.0], [37.0, 35.0], [35.0]]


def joins_from(found, off):
    # The vehicle is 389 m astern.
    return found.joins(-389.0 + off, 0.0, AXIS, error=0.0, tracking=False, guarding=False)
