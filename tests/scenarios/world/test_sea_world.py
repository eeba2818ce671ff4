import math

import numpy as np
import pytest
from sea_cases import scenario

from scenarios.world.weather import SATELLITES, VESSEL_DATA, drawn_fault, drawn_weather, wind_ned


def generator():
    return np.random.default_rng(9)


@pytest.mark.parametrize(
    ("from_deg", "blows_to"), [(0.0, (-10.0, 0.0)), (90.0, (0.0, -10.0)), (180.0, (10.0, 0.0)), (270.0, (0.0, 10.0))]
)
def test_the_wind_blows_to_where_it_does_not_come_from(from_deg, blows_to):
    assert wind_ned(scenario(wind={"speed_mps": 10.0, "from_deg": from_deg})) == pytest.approx(blows_to, abs=1e-12)


@pytest.mark.parametrize(("kind", "lasts"), [(VESSEL_DATA, 60.0), (SATELLITES, 10.0)])
def test_a_passing_fault_lasts_from_its_beginning_to_its_end(kind, lasts):
    fault = drawn_fault(scenario(fault={"kind": kind, "at_s": [100.0, 250.0]}), generator())
    assert 100.0 <= fault.begins <= 250.0
    assert fault.ends == fault.begins + lasts
    assert not fault.of_aircraft()
    found = [fault.lasts(kind, t) for t in (fault.begins - 0.01, fault.begins, fault.ends - 0.01, fault.ends)]
    assert found == [False, True, True, False]
    assert not fault.lasts(SATELLITES if kind == VESSEL_DATA else VESSEL_DATA, fault.begins)


def test_a_part_fails_for_good():
    fault = drawn_fault(scenario(fidelity="six_dof", fault={"kind": "engine"}), generator())
    assert fault.of_aircraft()
    assert fault.ends == math.inf
    assert not drawn_fault(scenario(), generator()).of_aircraft()


def test_gusts_come_one_after_the_other_and_are_no_stronger_than_they_may():
    turbulence = {"gusts": 5, "gust_speed_mps": 8.0, "gust_length_s": 4.0}
    weather = drawn_weather(scenario(fidelity="six_dof", turbulence=turbulence, flight={"duration_max_s": 500.0}), generator())
    assert len(weather.gusts) == 5
    for i, gust in enumerate(weather.gusts):
        # A hundred seconds for each, of which it takes four to rise and four to fall.
        assert 100.0 * i <= gust.start
        assert gust.start + gust.rise + gust.fall <= 100.0 * (i + 1)
        assert 4.0 <= math.hypot(*gust.velocity_ned) <= 8.0
        assert gust.velocity_ned[2] == 0.0
    assert weather.turbulence is None


def test_the_air_is_drawn_by_the_seed():
    turbulence = {"level": "light", "gusts": 2, "gust_speed_mps": 4.0}
    blown = scenario(fidelity="six_dof", turbulence=turbulence, wind={"speed_mps": 5.0, "from_deg": 30.0})
    assert drawn_weather(blown, generator()) == drawn_weather(blown, generator())
    assert drawn_weather(blown, np.random.default_rng(10)) != drawn_weather(blown, generator())
    assert drawn_weather(blown, generator()).wind == wind_ned(blown)
