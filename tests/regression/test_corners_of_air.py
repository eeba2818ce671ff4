"""Corners of air and sensors in which flights came within r_min, as a sceptic found them: each was
declared, and not reckoned with.

The commands are those of the search, each with one or two of the flights that had come in, until a
little after they did.
"""

import pytest
import study_runs

pytestmark = pytest.mark.slow

NOWHERE = ["draws=[]", "flight.crossings=0", "fidelity=kinematic"]
REVERSED = """time_utc,speed_mps,from_deg
2026-06-01T11:00:00Z,8,0
2026-06-01T12:02:00Z,8,0
2026-06-01T12:03:00Z,0,0
2026-06-01T12:03:01Z,0.1,180
2026-06-01T12:04:00Z,8,180
2026-06-01T12:30:00Z,8,180
"""
SHEARED = "height_m,speed_mps,from_deg\n1,8,0\n38,8,0\n45,10,180\n200,10,180\n"


NO_SATELLITES = "fault.kind=satellite_navigation"
CONTAINER = ("plume.model=fluctuating", "emission.ship=container", "plume.source_height_m=35")
WITHIN_R_MIN = (
    "guidance.mission=standoff",
    "reference.standoff_radius_m=120",
    "guidance.law=park_l1",
)
"""A law that circles within r_min."""

CORNERS = {
    # 12 of 12 flights had come in, as near as 57 and 4 m: dead reckoning went wrong by 4.7 m/s, and
    # 1 m/s was allowed for.
    **{
        f"{outage} s without satellites while the wind turns round": (
            REVERSED, "flights=1", "vessel.speed_mps=4", "place.utc=2026-06-01T12:00:00Z", NO_SATELLITES,
            f"fault.satellite_navigation_s={outage}", "fault.at_s=120", "flight.duration_max_s=200",
        )
        for outage in (60, 150)
    },
    # 2 of 8 had come in, as near as 190.7 m.
    "the wind turns round between two heights that exhaust is followed to": (
        SHEARED, "flights=2", "flight.duration_max_s=60", "vessel.speed_mps=3", *CONTAINER,
    ),
    # 8 of 8 had come in, by up to 185 m.
    "satellites are lost on the way to another height in shear": (
        "height_m,speed_mps,from_deg\n1,8,0\n36,8,0\n45,2,180\n90,2,180\n",
        "flights=1", "flight.duration_max_s=150", "vessel.speed_mps=3", *CONTAINER, NO_SATELLITES, "fault.at_s=[5,60]",
        "fault.satellite_navigation_s=150",
    ),
    # 6 of 12 had come in, by up to 11 m.
    "a flight begins lower than the plume and shear is between": (
        SHEARED, "flights=1", "flight_seed=2731240877", "flight.duration_max_s=60", "vessel.speed_mps=3",
        "plume.source_height_m=55", "flight.altitude_m=30",
    ),
    # 4 of 8 had come in, by up to 5.5 m.
    "dead reckoning goes by a compass with noise": (
        None, "flights=1", "flight_seed=98897466", "flight.duration_max_s=101", "wind.speed_mps=4", "vessel.speed_mps=4",
        *WITHIN_R_MIN, "sensors.heading_sigma_deg=10", "fault.at_s=[0,100]", NO_SATELLITES,
        "fault.satellite_navigation_s=150",
    ),
    # The guard decides at each step, and went by the lucky ones (185.8 and 198.8 m).
    **{
        f"noise of the {noise} does not make commands look safe": (
            None, "flights=1", "flight.duration_max_s=80", "vessel.speed_mps=4", "wind.speed_mps=4", *WITHIN_R_MIN,
            f"sensors.{noise}_sigma_mps=1",
        )
        for noise in ("velocity", "airspeed")
    },
    # 5 of 60 had come in, by up to 126 m: the first measurement, 3.5 m/s wrong, was taken for the
    # wind for 60 s.
    **{
        f"a noisy compass has measured a wind of {wind} m/s once": (
            None, "fidelity=six_dof", "flights=1", f"flight_seed={flight_seed}", f"wind.speed_mps={wind}",
            f"wind.from_deg={from_deg}", f"vessel.speed_mps={vessel}", NO_SATELLITES, "fault.at_s=0",
            "fault.satellite_navigation_s=60", "sensors.heading_sigma_deg=5", "flight.duration_max_s=100",
        )
        for flight_seed, wind, from_deg, vessel in (
            (1309792723, 4.757, 236.178, 1.547), (1339808699, 9.146, 196.918, 6.008),
        )
    },
    # 2 of 4 and 1 of 4 had come in, by up to 77 and 223 m: the filter of the wind began with 10 m/s
    # either way for likely, so that what gusts or a high speed hide was estimated too weak, and
    # stayed so.
    "satellites are lost at the start in turbulence": (
        None, "flights=1", NO_SATELLITES, "fault.at_s=0", "fidelity=six_dof", "turbulence.level=moderate",
        "wind.speed_mps=25", "wind.from_deg=180", "vessel.speed_mps=14", "fault.satellite_navigation_s=60",
        "start.distance_m=[450,900]", "flight.duration_max_s=45", "flight_seed=4168118249",
    ),
    "satellites are lost at the start of a fast vehicle": (
        None, "flights=1", NO_SATELLITES, "fault.at_s=0", "guidance.airspeed_mps=100", "kinematic.heading_rate_lag_s=0.4",
        "keepout.radius_m=1000", "wind.speed_mps=40", "wind.from_deg=60", "vessel.speed_mps=4",
        "fault.satellite_navigation_s=140", "start.distance_m=[3500,5000]", "flight.duration_max_s=120",
    ),
}  # fmt: skip
"""Tables of the wind, or none, and settings of ``sea_wind``."""

BY_THE_GUARD = ("noise of", "a noisy compass")
"""Corners in which the guard has to act."""


@pytest.mark.parametrize("name", CORNERS)
def test_a_declared_corner_of_air_and_sensors_is_kept_out_of(tmp_path, name):
    table, *overrides = CORNERS[name]
    if table is not None:
        (tmp_path / "wind.csv").write_text(table)
        overrides.append(f"wind.table={tmp_path / 'wind.csv'}")
    rows = study_runs.flown(tmp_path / "run", "sea_wind", *NOWHERE, *overrides)
    assert (rows["min_distance_m"] >= rows["keepout_radius_m"]).all()
    if name.startswith(BY_THE_GUARD):
        assert rows["guard_interventions"].sum() > 0


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {
            "fault.at_s": 0.6,
            "wind.speed_mps": 4,
            "vessel.speed_mps": 13,
            "flight.duration_max_s": 150,
            "flight_seed": 3774224420,
        },
    ],
    ids=["settled", "first second"],
)
def test_an_aircraft_whose_dead_reckoning_is_declared_better_than_its_own_keeps_out(
    changes, tmp_path
):
    # Five minutes without satellites, exact sensors, and a law that flies at the ship. With the 0
    # m/s that are declared it came 57 m in: its turns change all the time, and the crab angles that
    # it reckons with are those of steady ones. And 7 m, where the wind had been measured once, as
    # it rolled in.
    keys = {
        "reference.standoff_radius_m": 9000, "vessel.speed_mps": 14, "wind.speed_mps": 3, "wind.from_deg": 180,
        "start.range_m": 450, "start.aspect_deg": 180, "following.drift_rate_mps": 0, "fault.kind": "satellite_navigation",
        "fault.at_s": 5, "fault.satellite_navigation_s": 300, "flight.duration_max_s": 310, "flight.crossings": 0, **changes,
    }  # fmt: skip
    row = study_runs.flown_once(tmp_path / "run", "sea_wind", keys, *study_runs.AT_THE_SHIP)
    assert row["guard_time_s"] > 20.0
    assert row["min_distance_m"] > row["keepout_radius_m"]
    assert row["guard_lost_s"] == 0.0
