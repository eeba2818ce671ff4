"""Wind by where it comes from."""

import math

import pytest

from common.physics.wind import wind_towards, wind_velocity


@pytest.mark.parametrize(
    ("from_deg", "velocity"),
    [(0.0, (-5.0, 0.0)), (90.0, (0.0, -5.0)), (225.0, (5.0 / math.sqrt(2.0),) * 2)],
)
def test_wind_blows_away_from_where_it_comes_from(from_deg, velocity):
    # Sines of multiples of pi are off by 1e-16 of a circle.
    assert wind_velocity(5.0, from_deg) == pytest.approx(velocity, abs=1e-14)
    assert math.cos(wind_towards(from_deg)) * 5.0 == pytest.approx(velocity[0], abs=1e-14)
