"""The guidance expects the exhaust where the measurement lets it rise to, at the load that it
expects.
"""

import pytest

from measurement.plume.spread import downwash, rise
from scenarios.planning.plume import axis_height
from scenarios.scenario.files import load_study
from scenarios.world.plume import emission
from scenarios.world.vessel import SteadyVessel


@pytest.mark.parametrize("speed", [3.0, 8.0, 19.0])
def test_it_is_the_rise_of_the_measurement_in_neutral_air_less_its_downwash(speed):
    scenario = load_study("sulphur", ["emission.load=0.2", "flight.altitude_max_m=400"])
    expected = axis_height(scenario, SteadyVessel(12.0, 0.7))
    # The true load is another one, of which the guidance knows nothing.
    emitted = emission(scenario, speed=12.0)
    above_funnel = float(rise(emitted, speed, 300.0 / speed)) - float(downwash(emitted, speed))
    assert expected.at(300.0, speed) - 35.0 == pytest.approx(above_funnel, rel=1e-9)
