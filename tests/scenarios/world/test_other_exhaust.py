"""The plume of another ship: the sniffer reads it as well, and nothing else of the flight changes."""

import io

import numpy as np
import pandas as pd
import pytest

from aircraft.wind import constant_wind
from common.run_layout import SUMMARY, TRAFFIC, time_history_path
from measurement.gases import GASES
from scenarios.engine.task import Task
from scenarios.errors import InputError
from scenarios.experiment.requests import Experiment
from scenarios.flight_runner import FlightRunner
from scenarios.instruments.sniffer import AirSampler
from scenarios.planning.spreads import PredictedSpreads
from scenarios.scenario.files import load_study
from scenarios.world.plume import UNIFORM, exhaust_of
from scenarios.world.traffic import DisplacedVessel
from scenarios.world.vessel import SteadyVessel
from scenarios.world.world import plume_of

pytestmark = pytest.mark.slow

KINEMATIC = {
    "extends": "sulphur",
    "fidelity": "kinematic",
    "kinematic": {"heading_rate_lag_s": 0.4},
    "flight": {"after_settling_s": 60.0, "duration_max_s": 300.0},
}

EMISSION = {"ship": "container", "fuel": "hfo", "sulphur_percent": 2.6}

UPWIND = {"name": "upwind", "place_m": [681.0, 312.0], "speed_mps": 12.0}
"""In the wind of the scenario its plume lies over the orbit astern of the measured ship."""


def flown(ship, **sections):
    scenario = load_study(KINEMATIC | sections | {"traffic": [ship]}, ())
    work = FlightRunner(
        experiments=(Experiment("plumes", scenario),),
        histories=1,
        setup=None,
        spreads=PredictedSpreads(),
    )
    result = work.run(Task(number=0))
    (row,) = result.tables[SUMMARY]
    history = result.files.get(time_history_path(row["flight_id"]))
    return row, history and pd.read_parquet(io.BytesIO(history)), result.tables.get(TRAFFIC)


def test_the_air_has_the_gases_of_each_ship_at_the_same_place():
    wind = constant_wind(0.0, 7.0)
    vessel = SteadyVessel(6.0, 0.0)
    other = DisplacedVessel(SteadyVessel(6.0, 0.0), 300.0, -150.0)
    scenario = load_study(KINEMATIC | {"traffic": [UPWIND | {"emission": EMISSION}]}, ())
    plume = plume_of(scenario, vessel)
    given = scenario.traffic[0].emission
    own, others = (
        exhaust_of(
            scenario, track, plume, wind, duration=200.0, generator=np.random.default_rng(5), of=of
        )
        for track, of in ((vessel, None), (other, given))
    )
    # Across both plumes, which trail to the south-east.
    time = np.arange(60.0, 120.0, 0.1)
    place = np.column_stack(
        [6.0 * time - 100.0, np.linspace(-100.0, 500.0, len(time)), np.full(len(time), 55.0)]
    )
    rate, speed = np.tile([6.0, 10.0, 0.0], (len(time), 1)), np.full(len(time), 12.0)
    alone, both = (
        AirSampler(own, UNIFORM, beside, dynamic_pressure_fraction=0.2).advance(
            time, place, rate, speed
        )
        for beside in ((), (others,))
    )
    co2, so2 = GASES.index("co2"), GASES.index("so2")
    added = both.air - alone.air
    assert added[:, co2].max() > 1.0
    np.testing.assert_allclose(both.background_co2 - 420.0, added[:, co2], atol=1e-9)
    assert np.array_equal(alone.plume.dilution, both.plume.dilution)
    # SO2 over CO2 of another ship is that of its own fuel, 2.6 %: with 0.232 % of sulphur in the
    # fuel per ppb/ppm (measurement/gases.py), and the share of it that leaves as SO2.
    seen = added[:, co2] > 1.0
    ratio = 0.232 * added[seen, so2] / added[seen, co2]
    assert ratio == pytest.approx(np.full(seen.sum(), 2.6), rel=0.1)


def test_a_plume_of_another_ship_changes_readings_and_nothing_of_the_path():
    (row, silent, _), (beside, smoking, traffic) = (
        flown(UPWIND),
        flown(UPWIND | {"emission": EMISSION}),
    )
    gases = {name for name in silent if name.startswith(("so2", "co2", "no_", "no2"))}
    for name in set(silent) - gases:
        assert silent[name].equals(smoking[name]), name
    assert (silent["co2_background_ppm"] == 420.0).all()
    assert smoking["co2_background_ppm"].max() > 430.0
    (ship,) = traffic
    assert ship["plume_s"] > 30.0
    assert row["smoke_passes"] == beside["smoke_passes"] > 5
    # It lies over every pass: there is nothing to tell the fuel by, and the reason is said.
    assert beside["others_left_out"] == 1.0
    assert beside["sulphur_verdict"] == "open"
    assert beside["sulphur_quality"] == "C"
    assert "the plume of upwind" in beside["sulphur_reason"]
    assert "others_left_out" not in row


def test_what_another_plume_may_be_in_is_left_out_of_the_estimate():
    # It falls behind by 2 m/s, and its plume leaves the orbit in the measured time.
    slower = {"name": "slower", "place_m": [800.0, 366.0], "speed_mps": 10.0, "emission": EMISSION}
    row, history, _ = flown(
        slower,
        payload={"sensor": "fast"},
        flight={"after_settling_s": 260.0, "duration_max_s": 450.0},
    )
    measured = history["time_s"] >= row["settling_time_s"]
    assert history["co2_background_ppm"][measured].max() > 421.0
    assert 0.1 < row["others_left_out"] < 0.8
    assert row["sulphur_quality"] != "C"
    # Twice the standard uncertainty, as for a ship that is alone.
    error = abs(row["fsc_percent"] - row["fsc_expected_percent"])
    assert error < 2.0 * row["fsc_uncertainty_percent"]


def test_a_plume_that_needs_more_than_there_is_is_refused_by_its_key():
    smoking = UPWIND | {"emission": EMISSION}
    with pytest.raises(InputError, match=r"traffic\.0\.emission.* a sniffer"):
        load_study({"title": "none", "wind": {"speed_mps": 5.0}, "traffic": [smoking]}, ())
    with pytest.raises(InputError, match=r"traffic\.0\.emission\.ship"):
        load_study(KINEMATIC | {"traffic": [UPWIND | {"emission": {"fuel": "hfo"}}]}, ())
    row, *_ = flown(smoking | {"speed_mps": 40.0})
    assert row["outcome"] == "infeasible"
    assert "upwind (traffic.0.emission): " in row["message"]
