import math

import numpy as np
import pytest
from flight_cases import scenario

from scenarios.world.vessel import given_place
from scenarios.world.wind import sampled_weather, wind_of


def sampled(given, seed=9):
    return sampled_weather(
        given, wind_of(given, given_place(given.place, 60.0)), np.random.default_rng(seed)
    )


@pytest.mark.parametrize("roughness", [1e-8, 2e-4, 1.0])
def test_a_wind_with_a_profile_is_the_one_given_at_its_height_whatever_the_roughness(roughness):
    given = scenario(
        wind={"speed_mps": 10.0, "from_deg": 180.0, "roughness_m": roughness, "height_m": 20.0}
    )
    field = wind_of(given, given_place(given.place, 60.0))
    # Rounding of logarithms; and V(z) = V(h) ln(z/z0)/ln(h/z0).
    assert field.now(0.0, 20.0) == pytest.approx((10.0, 0.0), abs=1e-12)
    assert field.now(0.0, 60.0)[0] == pytest.approx(
        10.0 * math.log(60.0 / roughness) / math.log(20.0 / roughness), rel=1e-12
    )


def test_gusts_come_one_after_the_other_and_are_no_stronger_than_they_may():
    turbulence = {"gusts": 5, "gust_speed_mps": 8.0, "gust_length_s": 4.0}
    weather = sampled(
        scenario(fidelity="six_dof", turbulence=turbulence, flight={"duration_max_s": 500.0})
    )
    assert len(weather.gusts) == 5
    for i, gust in enumerate(weather.gusts):
        # A hundred seconds for each, of which it takes four to rise and four to fall.
        assert 100.0 * i <= gust.start
        assert gust.start + gust.rise + gust.fall <= 100.0 * (i + 1)
        assert 4.0 <= math.hypot(*gust.velocity_ned) <= 8.0
        assert gust.velocity_ned[2] == 0.0
    assert weather.turbulence is None
