"""The winds at all heights that a flight may fly at count: how far it climbs, whether the vessel
outruns it, where it glides to.
"""

import pytest

from gnc.errors import InfeasibleError
from scenarios.planning.air.wind import check_not_outrun
from scenarios.scenario.files import load_study, with_values
from scenarios.world.world import mean_wind, vessel_of

FASTER_ALOFT = "height_m,speed_mps,from_deg\n1,10,0\n60,10,0\n250,26,0\n2000,26,0\n"

CIRCLE = {
    "guidance.mission": "standoff",
    "keepout.shape": "cylinder",
    "keepout.radius_m": 20.0,
    "reference.standoff_radius_m": 150.0,
    "plume.elevation_deg": 45.0,
    "vessel.speed_mps": 4.0,
}


def scenario(tmp_path, table, **values):
    """Return a scenario in the wind of a table, whose plume starts at 60 m, with the vessel and the
    wind of its flights.
    """
    file = tmp_path / "wind.csv"
    file.write_text(table, encoding="utf-8")
    found = with_values(load_study("sea_wind"), {"draws": [], "wind.table": str(file)} | values)
    return found, vessel_of(found)


def test_a_vessel_that_outruns_the_vehicle_where_it_climbs_to_is_refused(tmp_path):
    flown, vessel = scenario(tmp_path, FASTER_ALOFT, **CIRCLE)
    # At the funnel she moves at 14 m/s through the air; at 60 + 150 m at 4 + 10 + 16 *
    # ln(210/60)/ln(250/60) = 28 m/s.
    with pytest.raises(
        InfeasibleError,
        match=r"height of 210 m, which is flown, the vessel moves at up to 28\.\d m/s",
    ):
        check_not_outrun(flown, vessel, mean_wind(flown, vessel), 150.0)
    check_not_outrun(flown, vessel, mean_wind(flown, vessel), 10.0)
