"""The sniffer on board: what it reads of a flight, and what that says of the fuel."""

import numpy as np
import pytest
from scipy.stats import norm

from measurement.emission import expected_fsc, fuel_preset
from scenarios.engine.task import Task
from scenarios.experiment.requests import Experiment
from scenarios.flight_runner import FlightRunner
from scenarios.planning.spreads import PredictedSpreads
from scenarios.scenario.files import load_study
from tests.run_tables import history_in

pytestmark = pytest.mark.slow

# Astern of a ship on a straight course, where the kinematic vehicle settles within a minute or two.
QUICK = (
    "fidelity=kinematic",
    "reports.interval_s=[0,0]",
    "sensors={}",
    "following={}",
    "start.place_m=[-250,-120]",
    "start.course_deg=-90",
    "wind.speed_mps=2",
    "wind.from_deg=0",
    "vessel.speed_mps=10",
    "flight.after_settling_s=60",
)


def flown(*overrides, every_step=False):
    scenario = load_study("sulphur", (*QUICK, *overrides))
    work = FlightRunner(
        experiments=(Experiment("sulphur", scenario),),
        histories=1,
        setup=None,
        spreads=PredictedSpreads(),
    )
    result = work.run(Task(number=0, every_step=every_step))
    (row,) = result.tables["summary.csv"]
    return row, history_in(result), result


@pytest.fixture(scope="module")
def slow():
    return flown()


def test_truth_and_reading_are_columns_of_the_time_history(slow):
    row, history, _ = slow
    assert row["outcome"] == "completed"
    for gas in ("so2", "no", "no2"):
        assert {f"{gas}_ppb", f"{gas}_reading_ppb"} <= set(history)
    # The sensor reads once a second, and the history has ten samples of a second: each reading
    # stands for ten.
    changes = np.diff(history["co2_reading_ppm"]) != 0.0
    assert 0.08 < np.count_nonzero(changes) / len(changes) <= 0.1
    # Clean air on the way there, and smoke at the crossings; the reading of a cell of 4 s is lower
    # and wider.
    settled = history[history["time_s"] > row["settling_time_s"]]
    assert settled["co2_ppm"].max() > 500.0
    assert 430.0 < settled["co2_reading_ppm"].max() < settled["co2_ppm"].max()
    assert settled["co2_ppm"].min() == pytest.approx(420.0, abs=0.1)


def test_a_flight_that_is_replayed_with_every_step_has_the_same_figures(slow):
    row, history, _ = slow
    again, every, _ = flown(every_step=True)
    # Wall times alone differ; a figure that is not a number is not equal to itself.
    assert {key: repr(value) for key, value in again.items() if key != "wall_time_s"} == {
        key: repr(value) for key, value in row.items() if key != "wall_time_s"
    }
    assert len(every) == 2 * len(history) - 1
    assert np.array_equal(every["co2_reading_ppm"][::2], history["co2_reading_ppm"])


def test_a_background_adds_co2_to_the_air_and_changes_nothing_else(slow):
    row, history, _ = slow
    hazy_row, hazy, _ = flown("air.background=haze", "air.background_ppm=5", "air.background_s=20")
    assert (history["co2_background_ppm"] == 420.0).all()
    background = hazy["co2_background_ppm"] - 420.0
    # Ten correlation times or so: the standard deviation is known to a third.
    assert 2.0 < background.std() < 8.0
    added = (hazy["co2_ppm"] - history["co2_ppm"]).to_numpy()
    assert added == pytest.approx(background.to_numpy(), abs=1e-6)
    others = ["north_m", "east_m", "so2_ppb", "so2_reading_ppb", "no2_reading_ppb"]
    assert hazy[others].equals(history[others])
    # What is said of the exhaust is not of the air around it.
    for name in ("dose_per_pass_ppm_s", "smoke_passes", "fsc_expected_percent"):
        assert hazy_row[name] == pytest.approx(row[name], rel=1e-9)
    # The analyst does not know of it, and has another result.
    assert hazy_row["fsc_percent"] != row["fsc_percent"]


def test_gases_are_in_the_ratio_of_the_emission(slow):
    _, history, _ = slow
    excess = history[history["co2_ppm"] > 450.0]
    ratio = (excess["so2_ppb"] - 0.2) / (excess["co2_ppm"] - 420.0)
    # 32.06/12.011 x 0.87/10: the factor of Balzani Loov et al., Atmos. Meas. Tech. 7 (2014), at 87
    # % carbon.
    expected = expected_fsc(fuel_preset("mgo", 0.1)) / 0.2322
    assert np.allclose(ratio, expected, rtol=2e-4)


def test_a_rule_says_whether_the_ship_is_suspect_and_changes_nothing_else(slow):
    row = slow[0]
    with_rule = flown("payload.rule=eca_0.15")[0]
    z = (0.15 - 0.10) / with_rule["fsc_uncertainty_percent"]
    assert with_rule["suspect_false_alarm"] == pytest.approx(norm.sf(z), rel=1e-6)
    assert with_rule["sulphur_suspect"] == (with_rule["fsc_percent"] >= 0.15)
    assert "sulphur_suspect" not in row
    assert {name: with_rule[name] for name in ("fsc_percent", "sulphur_verdict")} == {
        name: row[name] for name in ("fsc_percent", "sulphur_verdict")
    }
