"""The sniffer on board, one of the project's and one of a user: what it reads of a flight, and its
verdict.
"""

from pathlib import Path

import numpy as np
import pytest
from flight_cases import flown_study
from scipy.stats import norm

from measurement.emission import expected_fsc, fuel_preset
from measurement.estimate.repeated import RepeatedVerdict
from scenarios.errors import InputError
from scenarios.instruments.fuel_estimate import repeated_figures, with_verdict
from scenarios.scenario.files import load_study

pytestmark = pytest.mark.slow


def row(content):
    """Return the figures of a whole flight, with a standard uncertainty of 0.025 %."""
    figures = {"fsc_percent": content, "fsc_noise_percent": 0.015, "fsc_uncertainty_percent": 0.025}
    return figures | {"sulphur_quality": "B", "sulphur_verdict": "open"}


def looked(*contents):
    """Return a verdict on 0.10 % after looks with a standard uncertainty of 0.04 %."""
    verdict = RepeatedVerdict(0.10)
    for content in contents:
        verdict.look(content, noise=0.035, total=0.04, admitted=True)
    return verdict


def test_the_end_of_a_flight_is_its_last_look_and_spends_what_is_left():
    early, late = looked(0.1), looked(0.1)
    # 2.0 standard uncertainties above the limit: as a further look it stays open, as the last one
    # it does not.
    assert early.look(0.15, noise=0.015, total=0.025, admitted=True) == "open"
    figures = repeated_figures(late, row(0.15))
    assert (figures["sulphur_verdict"], figures["verdict_looks"]) == ("above", 2)
    assert 1.645 < figures["verdict_guard"] < early.guard


@pytest.mark.parametrize("verdict", ["above", "open"])
def test_a_document_tells_the_verdict_of_the_row_and_leaves_the_rest(verdict):
    given = {"estimate": {"fsc_percent": 0.2, "verdicts": [{"verdict": "below"}]}, "carbon": 0.87}
    found = with_verdict(given, verdict)
    assert found["estimate"] == {"fsc_percent": 0.2, "verdicts": [{"verdict": verdict}]}
    assert given["estimate"]["verdicts"] == [{"verdict": "below"}]
    assert with_verdict(None, verdict) is None


# Astern of a ship on a straight course, where the kinematic vehicle settles within a minute or two.
QUICK = (
    "fidelity=kinematic", "reports.interval_s=[0,0]", "sensors={}", "following={}",
    "start.place_m=[-250,-120]", "start.course_deg=-90", "wind.speed_mps=2", "wind.from_deg=0",
    "vessel.speed_mps=10", "flight.after_settling_s=60",
)  # fmt: skip


@pytest.fixture(scope="module")
def slow():
    flown = flown_study("sulphur", *QUICK)
    return flown.row, flown.history


def test_truth_and_reading_are_columns_of_the_time_history(slow):
    row, history = slow
    assert row["outcome"] == "completed"
    for gas in ("so2", "no", "no2"):
        assert {f"{gas}_ppb", f"{gas}_reading_ppb"} <= set(history)
    # The sensor reads once a second, and the history has ten samples of a second.
    changes = np.diff(history["co2_reading_ppm"]) != 0.0
    assert 0.08 < np.count_nonzero(changes) / len(changes) <= 0.1
    # Clean air on the way there, and smoke at the crossings; the reading of a cell of 4 s is lower
    # and wider.
    settled = history[history["time_s"] > row["settling_time_s"]]
    assert settled["co2_ppm"].max() > 500.0
    assert 430.0 < settled["co2_reading_ppm"].max() < settled["co2_ppm"].max()
    assert settled["co2_ppm"].min() == pytest.approx(420.0, abs=0.1)
    excess = history[history["co2_ppm"] > 450.0]
    ratio = (excess["so2_ppb"] - 0.2) / (excess["co2_ppm"] - 420.0)
    # 32.06/12.011 x 0.87/10: the factor of Balzani Loov et al., Atmos. Meas. Tech. 7 (2014), at 87
    # % carbon.
    expected = expected_fsc(fuel_preset("mgo", 0.1)) / 0.2322
    assert np.allclose(ratio, expected, rtol=2e-4)


def test_a_flight_that_is_replayed_with_every_step_has_the_same_figures(slow):
    row, history = slow
    again = flown_study("sulphur", *QUICK, every_step=True)
    # Wall times alone differ; a figure that is not a number is not equal to itself.
    figures = [
        {key: repr(of[key]) for key in of if key != "wall_time_s"} for of in (row, again.row)
    ]
    assert figures[0] == figures[1]
    assert len(again.history) == 2 * len(history) - 1
    assert np.array_equal(again.history["co2_reading_ppm"][::2], history["co2_reading_ppm"])


def test_a_background_and_a_rule_change_nothing_else(slow):
    row, history = slow
    air = ("air.background=haze", "air.background_ppm=5", "air.background_s=20")
    flown = flown_study("sulphur", *QUICK, *air, "payload.rule=eca_0.15")
    hazy_row, hazy = flown.row, flown.history
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
    # The analyst does not know of the haze, and has another result.
    assert hazy_row["fsc_percent"] != row["fsc_percent"]
    z = (0.15 - 0.10) / hazy_row["fsc_uncertainty_percent"]
    assert hazy_row["suspect_false_alarm"] == pytest.approx(norm.sf(z), rel=1e-6)
    assert hazy_row["sulphur_suspect"] == (hazy_row["fsc_percent"] >= 0.15)
    assert "sulphur_suspect" not in row


EXAMPLE = str(Path(__file__).parents[3] / "docs" / "examples" / "own_ship.toml")
QUICK_EXAMPLE = (
    "fidelity=kinematic", "reports.interval_s=[0,0]", "sensors={}", "start.place_m=[-250,-120]",
    "start.course_deg=-90", "wind.speed_mps=2", "wind.from_deg=0", "flight.after_settling_s=60",
)  # fmt: skip


def test_the_example_measures_with_its_own_sniffer_beside_its_own_ship():
    flown = flown_study(EXAMPLE, *QUICK_EXAMPLE)
    assert flown.row["sensor"] == "own cells"
    # Two readings a second: each stands for five of the ten rows.
    changed = (flown.history["co2_reading_ppm"].diff() != 0.0).mean()
    assert 0.17 < changed <= 0.21
    study = load_study(EXAMPLE)
    config = study.model_dump(mode="json")
    assert (study.source_height, config["emission"]["ship"]["stack_height"]) == (22.0, 22.0)
    assert config["payload"]["sensor"]["channels"]["so2"]["t90_s"] == 15.0


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("emission.ship.stak_height=3", "has the key 'stak_height'; did you mean 'stack_height'?"),
        ("emission.ship.stroke=2.5", "stroke of ferry of 5 MW is 2.5; it must be 2 or 4"),
        ("emission.ship=5", "emission.ship: value is 5; give the name of a ship, or a table"),
        ("emission.ship.stack_height=300", "leaves a funnel at 10 to 200 m: set"),
        ("payload.sensor.channels.so2.t90=3", "channel 'so2' of instrument 'own cells' has"),
        ("payload.sensor={}", "an invalid table: instrument 'own sniffer' has no channels"),
    ],
)
def test_a_table_of_no_use_is_refused_in_one_line(override, words):
    with pytest.raises(InputError) as refused:
        load_study(EXAMPLE, [override])
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)
