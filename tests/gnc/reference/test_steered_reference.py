import math

import numpy as np
import pytest
from gnc_cases import HEADING_RATE_MAX, SPEED, examples
from hypothesis import given
from hypothesis import strategies as st

from gnc.reference.oscillating import JoinedOrbit
from gnc.reference.reference import REFERENCE_SHAPES
from gnc.reference.steered import SteeredReference

TIME_STEP = 0.05
ROLL_RATE_MAX = math.radians(40.0)

shapes = pytest.mark.parametrize("shape", ["sinusoid", "fastest"])


def swing(shape):
    return REFERENCE_SHAPES.get(shape)().swing(
        speed=SPEED, heading_rate=HEADING_RATE_MAX, roll_rate_max=ROLL_RATE_MAX
    )


def steered(shape="sinusoid", *, nu=0.5, mean_course=0.7, phase=0.0):
    return SteeredReference(
        north=-214.0,
        east=35.0,
        mean_course=mean_course,
        speed_ratio=nu,
        phase=phase,
        swing=swing(shape),
        speed=SPEED,
        heading_rate=HEADING_RATE_MAX,
        time_step=TIME_STEP,
    )


def speed_ratio(reference, shape):
    """Mean speed over speed: the mean of cos(course) over a period."""
    phases = np.linspace(0.0, 2.0 * math.pi, 4096, endpoint=False).tolist()
    courses = [swing(shape).course(reference.eta, phase) for phase in phases]
    return float(np.mean(np.cos(courses)))


steering = st.lists(
    st.tuples(st.floats(-math.pi, math.pi), st.floats(-0.3, 1.1), st.integers(1, 200)),
    min_size=1,
    max_size=8,
)


@shapes
@pytest.mark.parametrize("nu", [0.05, 0.5, 0.9])
def test_with_constant_parameters_it_is_the_reference_of_its_shape(shape, nu):
    reference, made = steered(shape, nu=nu), REFERENCE_SHAPES.get(shape)()
    orbit = made.design(
        nu=speed_ratio(reference, shape),
        speed=SPEED,
        heading_rate_max=HEADING_RATE_MAX,
        reserve=0.0,
        vessel_heading_rate=0.0,
        roll_rate_max=ROLL_RATE_MAX,
    )
    fixed = JoinedOrbit(shape=made, orbit=orbit, vessel_course=0.7, time_step=TIME_STEP).reference(
        0.0, -214.0, 35.0
    )
    for _ in range(2000):
        reference.step()
        fixed.step()
    # The same Simpson's rule; the series of J_0 is good to 5e-7, and so is eta, which 100 s of
    # turning make 2e-5 rad of phase.
    assert (reference.north, reference.east) == pytest.approx(
        (fixed.north, fixed.east), rel=0.0, abs=2e-3
    )
    assert reference.course == pytest.approx(fixed.course, rel=0.0, abs=5e-5)
    assert reference.heading_rate == pytest.approx(fixed.heading_rate, rel=0.0, abs=5e-5)


@shapes
@given(steering=steering, nu=st.floats(0.0, 0.97), phase=st.floats(-math.pi, math.pi))
@examples(40)
def test_it_is_a_unicycle_of_constant_speed_that_turns_no_faster_than_it_may(
    shape, steering, nu, phase
):
    reference = steered(shape, nu=nu, phase=phase)
    for mean_course, ratio, steps in steering:
        reference.steer(mean_course, ratio)
        for _ in range(steps):
            north, east, course = reference.north, reference.east, reference.course
            reference.step()
            turn = reference.course - course
            # Rounding: the heading rate as said, and what the course did.
            assert abs(reference.heading_rate) <= HEADING_RATE_MAX * (1.0 + 1e-12)
            assert abs(turn) <= HEADING_RATE_MAX * TIME_STEP * (1.0 + 1e-9)
            # The chord of an arc that turns evenly, and the course on its middle; how the rate
            # changes within a step, 1.5 rad/s^2 at most, moves the end by V dt^3 1.5/12 = 0.3 mm.
            chord = (
                SPEED * TIME_STEP * math.sin(0.5 * turn) / (0.5 * turn)
                if turn
                else SPEED * TIME_STEP
            )
            expected = (
                chord * math.cos(course + 0.5 * turn),
                chord * math.sin(course + 0.5 * turn),
            )
            assert (reference.north - north, reference.east - east) == pytest.approx(
                expected, rel=0.0, abs=4e-4
            )


@shapes
@pytest.mark.parametrize(("nu", "phase"), [(0.0, 1.0), (0.3, -2.2), (0.9, 0.0)])
def test_its_centre_is_the_mean_of_its_orbit(shape, nu, phase):
    reference = steered(shape, nu=nu, phase=phase)
    centre = np.array(reference.centre())
    mean_speed = speed_ratio(reference, shape) * SPEED
    drift = mean_speed * np.array([math.cos(0.7), math.sin(0.7)])
    # Ten periods, to within half a step: 0.025 s of some 150 s, up to 105 m from the centre, move
    # the mean by up to 2 cm.
    steps = round(10 * 2.0 * math.pi / reference.omega_0 / TIME_STEP)
    places = []
    for step in range(steps):
        places.append(np.array([reference.north, reference.east]) - step * TIME_STEP * drift)
        reference.step()
    assert np.mean(places, axis=0) == pytest.approx(centre, rel=0.0, abs=0.05)
    # Nor does it wander from there: the centre moves with the mean velocity. Table of Bessel
    # functions: 3e-6 of 100 m.
    end = np.array(reference.centre()) - steps * TIME_STEP * drift
    assert end == pytest.approx(centre, rel=0.0, abs=0.01)
