"""NPFG against its original: numbers of guidance-laws.md, section 1, computed by PX4's code in
single precision.
"""

import math

import numpy as np
import pytest

from extensions.arena.laws.npfg import NpfgParameters, bearing_feasibility, npfg

NORTH, CALM = (1.0, 0.0), (0.0, 0.0)
# PX4 computes in single precision: 1e-7 relative at each of some ten operations.
SINGLE = 5e-7


def test_beside_a_line_in_still_air():
    command = npfg((0.0, 20.0), (15.0, 0.0), CALM, NORTH, 0.0)
    # Section 1: E_b = 105 m, a = -6.79980, bearing -0.541408.
    assert command.error_bound == pytest.approx(105.0, rel=SINGLE)
    assert command.lateral_acceleration == pytest.approx(-6.79980, abs=5e-6)
    assert command.bearing == pytest.approx(-0.541408, abs=5e-7)


def test_beside_a_line_in_a_crosswind():
    command = npfg((0.0, 20.0), (15.0, 6.0), (0.0, 6.0), NORTH, 0.0)
    # Section 1: E_b = 113.0885, heading -0.863811, a = -10.03223; to the printed digits.
    assert command.error_bound == pytest.approx(113.0885, abs=5e-5)
    assert command.heading == pytest.approx(-0.863811, abs=5e-7)
    assert command.lateral_acceleration == pytest.approx(-10.03223, abs=6e-6)


def test_inside_a_turn_the_curvature_is_fed_forward():
    command = npfg((0.0, -10.0), (15.0, 0.0), CALM, NORTH, 1.0 / 80.0)
    # Section 1: a = 6.011614, with a feed-forward of 2.5 before fading: 15^2 m2/s2 over the 90 m of
    # the vehicle's own circle.
    assert command.lateral_acceleration == pytest.approx(6.011614, rel=SINGLE)
    assert command.feed_forward == pytest.approx(2.5, rel=SINGLE)


def test_blown_backwards_it_heads_against_the_wind_and_towards_its_bearing():
    command = npfg((0.0, 30.0), (-5.0, 0.0), (-20.0, 0.0), NORTH, 0.0)
    # Section 1.8, against(V) without regulation: along b sqrt(w^2 - V^2) - w, of 20 m/s from the
    # north and 15 m/s.
    least = math.sqrt(20.0**2 - 15.0**2)
    heading = math.atan2(
        least * math.sin(command.bearing), least * math.cos(command.bearing) + 20.0
    )
    assert command.heading == pytest.approx(heading, abs=1e-12)
    assert -0.5 * math.pi < command.bearing < command.heading < 0.0


@pytest.mark.parametrize(
    ("wind", "feasible"),
    [((-14.0, 0.0), 0.75), ((0.0, 15.0), 0.0), ((0.0, 13.5), 1.0), ((14.0, 0.0), 1.0)],
)
def test_a_bearing_is_feasible_as_far_as_airspeed_exceeds_what_blows_against_it(wind, feasible):
    # Section 1.3 at 15 m/s: sin^2(pi/2 min((V - c)/1.5, 1)); 1 m/s left of 1.5 is sin^2(60 deg) =
    # 3/4. Rounding.
    assert bearing_feasibility(NORTH, wind, 15.0) == pytest.approx(feasible, abs=1e-15)


def test_every_state_has_a_finite_command():
    generator = np.random.default_rng(18)
    for _ in range(500):
        position, velocity, wind = (
            tuple(float(x) for x in generator.normal(0.0, s, 2)) for s in (100.0, 12.0, 12.0)
        )
        course = generator.uniform(-math.pi, math.pi)
        curvature = float(generator.choice([0.0, generator.normal(0.0, 0.1)]))
        tangent = (math.cos(course), math.sin(course))
        parameters = NpfgParameters(period=float(generator.uniform(3.0, 30.0)))
        command = npfg(position, velocity, wind, tangent, curvature, parameters)
        assert all(
            math.isfinite(x)
            for x in (command.lateral_acceleration, command.heading, command.period)
        )
