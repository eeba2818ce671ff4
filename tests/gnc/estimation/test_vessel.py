"""The vessel: its motion by reports, and the discs that it cannot have left."""

import math
from dataclasses import replace

import numpy as np
import pytest
from gnc_cases import courses, examples
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm
from vessel_cases import LIMITS, Mailbox, Vessel, report_of

from gnc.estimation.vessel import (
    REPORTED_SCATTER,
    FilterParameters,
    ReachableSet,
    ReportedTarget,
    VesselFilter,
    VesselReport,
    singer_noise,
    tube,
)

STEP = 0.5
ROUNDING = 1e-9
"""Of places of a few kilometres [m]."""

SIGMA, MEMORY, POSITION, VELOCITY = 0.02, 40.0, 5.0, 0.15
FILTER = FilterParameters(
    position_sigma=POSITION, velocity_sigma=VELOCITY, acceleration=SIGMA, memory=MEMORY
)
FIRST = VesselReport(0.0, 100.0, -40.0, 5.0, 2.0)


def singer(time):
    """Return transition and process noise of Singer's model by Van Loan's matrix exponential (IEEE
    Trans. AC 23:395, 1978).
    """
    a = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0 / MEMORY]])
    spectral = np.diag([0.0, 0.0, 2.0 * SIGMA**2 / MEMORY])
    e = expm(np.block([[-a, spectral], [np.zeros((3, 3)), a.T]]) * time)
    transition = e[3:, 3:].T
    return transition, transition @ e[:3, 3:]


@pytest.mark.parametrize("time", [0.01, 0.19, 0.21, 2.0, 60.0, 400.0])
def test_its_process_noise_is_singers(time):
    # Below 0.2 s the leading terms alone are taken, true to 0.5 % by their comment; above, six
    # digits of the closed forms cancel at worst, of sixteen.
    tolerance = 5e-3 if time < 0.005 * MEMORY else 1e-3
    expected = singer(time)[1][np.triu_indices(3)]
    assert singer_noise(SIGMA**2, MEMORY, time) == pytest.approx(expected, rel=tolerance)


def test_it_is_a_plain_matrix_kalman_filter():
    rng, vessel, time = np.random.default_rng(3), VesselFilter(FILTER), 0.0
    vessel.report(FIRST)
    # North and east as complex numbers.
    states = np.array([FIRST.north + 1j * FIRST.east, 5.0 + 2.0j, 0.0])
    p = np.diag([POSITION**2, VELOCITY**2, SIGMA**2])
    h, r = np.eye(2, 3), np.diag([POSITION**2, VELOCITY**2])
    for gap in rng.uniform(2.0, 10.0, 40):
        time += gap
        north, east, v_north, v_east = rng.standard_normal(4) * 100.0
        vessel.report(VesselReport(time, north, east, v_north, v_east))
        transition, noise = singer(gap)
        states, p = transition @ states, transition @ p @ transition.T + noise
        gain = p @ h.T @ np.linalg.inv(h @ p @ h.T + r)
        measured = np.array([north + 1j * east, v_north + 1j * v_east])
        states, p = states + gain @ (measured - h @ states), (np.eye(3) - gain @ h) @ p
        motion = vessel.at(time + 3.0)
        ahead, more = singer(3.0)
        place, velocity, acceleration = ahead @ states
        found = (
            complex(motion.north, motion.east),
            complex(motion.velocity_north, motion.velocity_east),
            complex(motion.acceleration_north, motion.acceleration_east),
        )
        # Rounding of some hundred metres in 40 updates, and the closed forms of the noise as above.
        assert found == pytest.approx((place, velocity, acceleration), rel=1e-6, abs=1e-6)
        sigma = math.sqrt((ahead @ p @ ahead.T + more)[0, 0])
        assert motion.sigma == pytest.approx(sigma, rel=1e-6)


def test_a_late_report_counts_for_when_it_was_true():
    # What matters is the time in the report, not when it is handed over: here after a look at a
    # later time.
    looked, silent = VesselFilter(FILTER), VesselFilter(FILTER)
    looked.report(FIRST)
    looked.at(9.0)
    silent.report(FIRST)
    for vessel in (looked, silent):
        vessel.report(VesselReport(7.0, 135.0, -26.0, 5.0, 2.0))
    assert looked.at(9.0) == silent.at(9.0)


def beyond(disc, vessel, time):
    """Return by how much a vessel is outside of a disc [m]; negative inside."""
    since = time - disc.time
    north, east = disc.north + disc.velocity_north * since, disc.east + disc.velocity_east * since
    return math.hypot(vessel.north - north, vessel.east - east) - disc.reach(since)


errors = st.fixed_dictionaries(
    {"split": st.floats(0.0, math.pi / 2.0), "place": courses, "drift": courses}
)
"""Errors on the limit of what is allowed for, anywhere on it."""


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
        st.tuples(st.booleans(), st.floats(0.0, 25.0), errors), min_size=1, max_size=40
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


def test_normal_errors_are_outside_of_a_disc_as_rarely_as_its_deviations_say():
    # Two dimensions: exp(-k^2/2), 1.1 % at k = 3. 20000 reports, each 12 s old, of a vessel at rest
    # that stays.
    generator = np.random.default_rng(11)
    limits = replace(LIMITS, deviations=3.0, acceleration=0.0, speed_max=math.inf)
    count, vessel = 20_000, Vessel(limits=limits)
    place = 5.0 * generator.standard_normal((count, 2))
    drift = 0.15 * generator.standard_normal((count, 2))
    outside = sum(
        beyond(tube(VesselReport(0.0, *p, *v), limits, 12.0), vessel, 12.0) > 0.0
        for p, v in zip(place, drift, strict=True)
    )
    # 222 expected, plus or minus 15; three times that.
    assert outside == pytest.approx(count * math.exp(-4.5), abs=45.0)


def reported(*reports):
    target = ReportedTarget(VesselFilter(FILTER), ReachableSet(LIMITS), 0.05)
    for report in reports:
        target.report(VesselReport(*report))
    return target


def test_the_scatter_of_reports_is_left_out_of_the_acceleration():
    # 0.5 m/s within 5 s: more than a steady vessel's reports scatter by within the filter, in one
    # direction only.
    target = reported(
        (0.0, 0.0, 0.0, 6.0, 2.0), (5.0, 30.0, 10.0, 6.5, 2.0), (10.0, 66.0, 20.0, 8.0, 2.0)
    )
    target.update(10.0, True)
    seen = target.vessel.at(10.0)
    size = math.hypot(seen.acceleration_north, seen.acceleration_east)
    left = 1.0 - REPORTED_SCATTER / size
    assert left > 0.0
    assert (target.acceleration_north, target.acceleration_east) == pytest.approx(
        (left * seen.acceleration_north, left * seen.acceleration_east), rel=1e-12
    )
    # A tenth of that is scatter.
    steady = reported((0.0, 0.0, 0.0, 6.0, 2.0), (5.0, 30.0, 10.0, 6.05, 2.0))
    steady.update(7.0, True)
    assert steady.vessel.at(7.0).acceleration_north > 0.0
    assert (steady.acceleration_north, steady.acceleration_east) == (0.0, 0.0)
