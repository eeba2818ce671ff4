"""What is planned of a plume before the flight: limits of the altitude, what is known of the ship,
the distance.
"""

import math

import pytest

from gnc.errors import InfeasibleError
from gnc.mission.axis import SearchedPlume
from scenarios.planning.plume import plume_axis
from scenarios.scenario.files import load_study
from scenarios.scenario.sections.flight import ALTITUDE_MARGIN
from scenarios.world.plume import emission
from scenarios.world.vessel import SteadyVessel

VESSEL = SteadyVessel(8.0, 0.0)


def searching(*overrides):
    return load_study("plume_search", ["comparison.variants=[]", *overrides])


def test_a_search_keeps_within_the_limits_by_a_margin_that_grows_with_turbulence():
    for level in ("none", "moderate"):
        expected = plume_axis(searching(f"turbulence.level={level}"), VESSEL).expected
        margin = ALTITUDE_MARGIN[level]
        assert (expected.lowest, expected.highest) == (20.0 + margin, 120.0 - margin)


def test_what_is_known_of_the_ship_is_the_middle_and_the_spread_of_the_ranges():
    scenario = searching()
    axis = plume_axis(scenario, VESSEL)
    assert isinstance(axis, SearchedPlume)
    # Of a uniform distribution from 20 to 60 m: mean 40, deviation the range over the root of 12.
    assert axis.expected.source_height == 40.0
    assert axis.expected.source_deviation == pytest.approx(40.0 / math.sqrt(12.0), rel=1e-12)
    assert (
        axis.expected.buoyancy_flux == emission(scenario, speed=math.nan, load=0.55).buoyancy_flux
    )
    # The logarithm of a load that is uniform from 0.2 to 0.9 scatters by 0.4; fuel burnt goes
    # almost with the load.
    assert axis.expected.load_deviation == pytest.approx(0.4, abs=0.05)


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        (["flight.altitude_min_m=50", "flight.altitude_max_m=62"], "flight.altitude_min_m"),
        (["flight.altitude_max_m=60"], "flight.altitude_m"),
        (["payload={}"], "payload.instruments"),
    ],
)
def test_limits_that_leave_no_room_and_a_search_without_a_sniffer_are_refused_in_one_line(
    overrides, words
):
    with pytest.raises(InfeasibleError) as refusal:
        plume_axis(searching(*overrides), VESSEL)
    assert words in str(refusal.value)
    assert "\n" not in str(refusal.value)
