"""Flights in turbulence that came within r_min while the guard reckoned with the noise of the
sensors alone, by the metres that they did.
"""

from pathlib import Path

import pandas as pd
import pytest

from scenarios import fly
from scenarios.engine.processes import InProcessExecutor
from scenarios.scenario.files import load_study
from scenarios.studies.base import run_study

pytestmark = pytest.mark.slow

LAW = f"guidance.law={Path(__file__).parent}/law_past_the_ship.py:PastTheShip"
STANDOFF = ("following.margin_law=cascade", "guidance.mission=standoff", "vessel.speed_mps=3")
NO_SATELLITES = (
    *STANDOFF,
    "keepout.radius_m=100",
    "turbulence.level=moderate",
    "fault.kind=satellite_navigation",
    "start.distance_m=[500,700]",
)


def flown(path, *overrides):
    """Fly one flight of the operational conditions without a reference to settle on."""
    file = path / "scenario.toml"
    file.write_text(
        'extends = "operational"\ntitle = "adv"\n[flight]\ncrossings = 0\n', encoding="utf-8"
    )
    run_study(
        load_study(str(file), overrides),
        "scenario",
        path / "run",
        executor_factory=InProcessExecutor,
    )
    return pd.read_csv(path / "run" / "summary.csv").iloc[0]


@pytest.mark.parametrize(
    "keys",
    [
        # 96 m within, 90 s without satellites, by its own law.
        pytest.param(
            (
                *NO_SATELLITES,
                "seed=909249", "wind.speed_mps=2", "wind.from_deg=-80", "fault.at_s=[17.4,17.4]",
                "fault.satellite_navigation_s=90", "flight.duration_max_s=117.4",
            ),
            id="90 s without satellites",
        ),
        # 51 m within.
        pytest.param(
            (
                *NO_SATELLITES,
                "seed=605861", "wind.speed_mps=4", "wind.from_deg=-43", "fault.at_s=[38.8,38.8]",
                "fault.satellite_navigation_s=200", "flight.duration_max_s=248.8",
                LAW, "guidance.ship_speed_mps=3", "guidance.tangent_radius_m=97",
            ),
            id="200 s without satellites",
        ),
        # 14 m within, by turns of 35 s that gusts made slower.
        pytest.param(
            (
                *STANDOFF,
                "seed=686033", "keepout.radius_m=1000", "wind.speed_mps=3", "wind.from_deg=-91",
                "turbulence.level=light", "reference.standoff_radius_m=1200",
                "guidance.bank_deg=10", "flight.duration_max_s=95", "start.distance_m=[1350,1700]",
                LAW, "guidance.ship_speed_mps=3", "guidance.lead_share=1",
            ),
            id="slow turns",
        ),
    ],
)  # fmt: skip
def test_a_flight_in_turbulence_keeps_out(tmp_path, keys):
    row = flown(tmp_path, *keys)
    assert row.outcome == "not_settled"
    assert row.min_distance_m >= row.keepout_radius_m
    assert row.guard_lost_s == 0.0


def test_an_ordinary_flight_without_satellites_in_moderate_turbulence_keeps_out():
    # Flight 8 of the study came 51 m within: the wind was wrong by 2.9 m/s at the loss.
    keys = {"fault.kind": "satellite_navigation", "fault.satellite_navigation_s": 60}
    name = "sea_turbulence_moderate"
    row = fly(name, flight_id=f"{name}_00007", flights=8, **keys).row
    assert row["outcome"] == "completed"
    assert row["min_distance_m"] >= row["keepout_radius_m"]


def test_in_steady_wind_every_premise_holds(tmp_path):
    # Before the crab angles of turns counted, the wind's ratio was above 1 in nearly every flight.
    study = load_study("sea_wind", ("flights=2",))
    run_study(study, "sea_wind", tmp_path, executor_factory=InProcessExecutor)
    rows = pd.read_csv(tmp_path / "summary.csv", keep_default_na=False)
    assert set(rows.premises_exceeded) == {"none"}
    assert (rows.premise_wind_ratio_max.astype(float) > 0.2).all()
