"""Where a vessel may be: it is in every disc at every time, whatever it does within its limits and
whatever reports come.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from gnc_cases import courses, examples
from hypothesis import given
from hypothesis import strategies as st
from vessel_cases import LIMITS, Mailbox, Vessel, report_of

from gnc.estimation.reachable_set import ReachableSet, Tube, tube, tube_by_speed
from gnc.estimation.vessel_filter import VesselReport

STEP = 0.5
ROUNDING = 1e-9
"""Of places of a few kilometres [m]."""


def beyond(disc, vessel, time):
    """Return by how much a vessel is outside of a disc [m]; negative inside."""
    since = time - disc.time
    north, east = disc.north + disc.velocity_north * since, disc.east + disc.velocity_east * since
    return math.hypot(vessel.north - north, vessel.east - east) - disc.reach(since)


@st.composite
def errors(draw):
    """An error on the limit of what is allowed for, anywhere on it."""
    return {
        "split": draw(st.floats(0.0, math.pi / 2.0)),
        "place": draw(courses),
        "drift": draw(courses),
    }


@st.composite
def manoeuvres(draw):
    """Accelerations in any direction, full or not, each for up to 10 s: bang-bang among them."""
    bang = draw(st.booleans())
    share = st.just(1.0) if bang else st.floats(0.0, 1.0)
    pieces = draw(st.lists(st.tuples(courses, share, st.integers(1, 20)), min_size=1, max_size=12))
    return [(course, size) for course, size, steps in pieces for _ in range(steps)]


@examples(80)
@given(
    manoeuvre=manoeuvres(),
    velocity=st.tuples(courses, st.floats(0.0, LIMITS.speed_max)),
    reported=st.lists(
        st.tuples(st.booleans(), st.floats(0.0, 25.0), errors()), min_size=1, max_size=40
    ),
    speed_max=st.sampled_from([LIMITS.speed_max, math.inf]),
)
def test_the_vessel_is_in_every_disc_at_every_time(manoeuvre, velocity, reported, speed_max):
    limits = replace(LIMITS, speed_max=speed_max)
    course, speed = velocity
    vessel = Vessel(0.0, 0.0, speed * math.cos(course), speed * math.sin(course), limits)
    reach, post, discs = ReachableSet(limits), Mailbox(), []
    reach.report(report_of(vessel, 0.0, **reported[0][2]))
    for step, (towards, share) in enumerate(manoeuvre):
        time = step * STEP
        if step and step < len(reported) and reported[step][0]:
            # Late by up to 25 s: they overtake each other, and some arrive never.
            _, latency, error = reported[step]
            post.send(time + latency, report_of(vessel, time, **error))
        for report in post.deliver(time):
            reach.report(report)
        found = reach.tubes(time)
        # Those of earlier times stay true for good: a guard may keep one.
        discs += found
        for disc in discs:
            assert disc.reach(time - disc.time) >= 0.0
            assert beyond(disc, vessel, time) <= ROUNDING
        vessel.accelerate(
            share * limits.acceleration * math.cos(towards),
            share * limits.acceleration * math.sin(towards),
            STEP,
        )


def test_the_disc_is_no_larger_than_what_the_vessel_can_do():
    # A vessel that does the most it can, with the largest error, is on the edge of its disc: at
    # rest, and reported 20 s ago.
    limits = replace(LIMITS, speed_max=math.inf)
    vessel, age = Vessel(limits=limits), 20.0
    # The split of the error that is worst at that age: the gradient of 5 cos + 0.15 * 20 sin.
    report = report_of(vessel, 0.0, split=math.atan2(0.15 * age, 5.0), place=math.pi, drift=math.pi)
    vessel.accelerate(limits.acceleration, 0.0, age)
    assert beyond(tube(report, limits, age), vessel, age) == pytest.approx(0.0, abs=ROUNDING)


def test_the_disc_by_speed_is_reached_at_the_largest_speed():
    vessel, age = Vessel(velocity_north=15.0), 150.0
    report = report_of(vessel, 0.0, place=math.pi)
    vessel.accelerate(0.0, 0.0, age)
    disc = tube_by_speed(report, LIMITS, age)
    # 25 m of reported error and 15 m/s; the other disc has 0.25 m/s^2 150^2/2 alone, 2.8 km.
    assert disc.radius == pytest.approx(25.0 + 15.0 * age, rel=1e-12)
    assert beyond(disc, vessel, age) == pytest.approx(0.0, abs=ROUNDING)


def test_the_disc_by_speed_of_a_new_report_begins_as_the_other_one():
    report = VesselReport(0.0, 3.0, -4.0, 8.0, 0.0)
    disc = tube_by_speed(report, LIMITS, 20.0)
    # By hand: 5 hypot(5, 0.15 * 20) and 0.25 * 20^2/2 about 160 m farther north; from then on
    # anywhere at 15 m/s.
    assert disc == pytest.approx(
        (20.0, 163.0, -4.0, 0.0, 0.0, 5.0 * math.hypot(5.0, 3.0) + 50.0, 15.0, 0.0), rel=1e-12
    )


def test_a_disc_by_speed_is_there_as_soon_as_the_edge_of_the_other_may_be_faster_than_the_vessel():
    reach = ReachableSet(LIMITS)
    reach.report(VesselReport(0.0, 0.0, 0.0, 8.0, 0.0))
    # 8 m/s, and 0.25 m/s^2 until 9 s ahead: 15 m/s for reports that are 19 s old; their errors make
    # that less than a second sooner.
    by_speed = [
        bool([disc for disc in reach.tubes(time) if disc.velocity_north == 0.0])
        for time in (0.0, 17.0, 19.1, 60.0)
    ]
    assert by_speed == [False, False, True, True]


@examples(100)
@given(
    age=st.floats(0.0, 100.0),
    later=st.floats(0.0, 60.0),
    ahead=st.floats(0.0, 100.0),
    place=st.sampled_from([0.0, 5.0]),
    drift=st.sampled_from([0.0, 0.15, 2.0]),
)
def test_a_report_that_gets_older_never_widens_its_disc_beyond_what_it_was_said_to_become(
    age, later, ahead, place, drift
):
    limits = replace(LIMITS, position_sigma=place, velocity_sigma=drift)
    report = VesselReport(0.0, 0.0, 0.0, 8.0, 0.0)
    then, now = tube(report, limits, age), tube(report, limits, age + later)
    assert now.reach(ahead) <= then.reach(later + ahead) * (1.0 + 1e-12)
    assert (now.north, now.velocity_north) == pytest.approx((then.north + 8.0 * later, 8.0))


def test_reports_are_kept_by_when_they_were_true_and_not_by_when_they_came():
    reach = ReachableSet(replace(LIMITS, speed_max=math.inf))
    for time in (0.0, 30.0, 10.0, 20.0, 5.0):
        reach.report(VesselReport(time, 1000.0 * time, 0.0, 0.0, 0.0))
    # The newest three, the newest first: one that comes late is put where it belongs, or dropped.
    assert [disc.north for disc in reach.tubes(40.0)] == [30e3, 20e3, 10e3]


def test_a_vessel_that_is_known_exactly_is_a_disc_without_width():
    exact = replace(LIMITS, acceleration=0.0, position_sigma=0.0, velocity_sigma=0.0)
    reach = ReachableSet(exact)
    reach.report(VesselReport(1.0, 10.0, -4.0, 6.0, 2.0))
    # A vessel that cannot accelerate cannot reach another speed: no second disc; and no number is
    # none.
    assert reach.tubes(3.0) == [Tube(3.0, 22.0, 0.0, 6.0, 2.0)]


def test_without_a_position_error_the_disc_of_a_new_report_grows_by_its_velocity_error():
    limits = replace(LIMITS, acceleration=0.0, position_sigma=0.0)
    disc = tube(VesselReport(0.0, 0.0, 0.0, 0.0, 0.0), limits, 0.0)
    assert (disc.radius, disc.growth) == pytest.approx((0.0, 5.0 * 0.15), rel=1e-12)


def test_a_place_that_is_next_to_exact_makes_a_disc_that_is_next_to_that_of_an_exact_one():
    exact, nearly = (replace(LIMITS, position_sigma=sigma) for sigma in (0.0, 1e-110))
    report = VesselReport(0.0, 3.0, -4.0, 8.0, 0.0)
    for age in (0.0, 20.0):
        assert tube(report, nearly, age) == pytest.approx(tube(report, exact, age), rel=1e-12)


def test_normal_errors_are_outside_of_a_disc_as_rarely_as_its_deviations_say():
    # Two dimensions: exp(-k^2/2), 1.1 % at k = 3. 20000 reports, each 12 s old, of a vessel at rest
    # that stays.
    generator = np.random.default_rng(11)
    limits = replace(LIMITS, deviations=3.0, acceleration=0.0, speed_max=math.inf)
    count, vessel = 20_000, Vessel(limits=limits)
    place, drift = (
        5.0 * generator.standard_normal((count, 2)),
        0.15 * generator.standard_normal((count, 2)),
    )
    outside = sum(
        beyond(tube(VesselReport(0.0, *p, *v), limits, 12.0), vessel, 12.0) > 0.0
        for p, v in zip(place, drift, strict=True)
    )
    # 222 expected, plus or minus 15; three times that.
    assert outside == pytest.approx(count * math.exp(-4.5), abs=45.0)
