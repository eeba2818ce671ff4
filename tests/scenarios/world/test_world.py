"""The world that a scenario describes."""

import math

import pytest
from flight_cases import scenario

from scenarios.world.world import apparent_wind, plume_of, vessel_of

STOPS = {
    "speed_mps": 8.0,
    "manoeuvres": [{"at_s": 10.0, "speed_mps": 0.0, "acceleration_mps2": 0.5}],
}


@pytest.mark.parametrize(
    ("changes", "at_start", "least", "greatest"),
    [
        # North at 6 m/s in a wind to the east at 6 m/s.
        (
            {"vessel": {"speed_mps": 6.0}, "wind": {"speed_mps": 6.0, "from_deg": 270.0}},
            *[math.hypot(6.0, 6.0)] * 3,
        ),
        ({"vessel": STOPS}, 8.0, 0.0, 8.0),
    ],
)
def test_the_apparent_wind_is_the_vessels_speed_through_the_air(changes, at_start, least, greatest):
    given = scenario(**changes)
    wind = apparent_wind(given, vessel_of(given))
    assert (wind.at_start, wind.least, wind.greatest) == pytest.approx(
        (at_start, least, greatest), abs=1e-12
    )


@pytest.mark.parametrize(
    ("direction", "degrees"), [(None, 135.0), ("apparent_wind", 135.0), ("given", 180.0)]
)
def test_the_plume_of_a_vessel_that_is_followed_trails_by_the_wind_unless_it_is_given(
    direction, degrees
):
    given = scenario(
        vessel={"speed_mps": 6.0},
        wind={"speed_mps": 6.0, "from_deg": 270.0},
        plume={"direction": direction},
    )
    axis = plume_of(given, vessel_of(given)).axis(0.0)
    assert math.remainder(axis - math.radians(degrees), 2.0 * math.pi) == pytest.approx(
        0.0, abs=1e-12
    )
