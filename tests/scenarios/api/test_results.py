"""What flights and runs hold: tables with units, figures, exports, reports, and nothing left on
disk.
"""

import gc
import json
import math
import tempfile
from pathlib import Path

import pandas as pd
import pyarrow.feather
import pytest
from matplotlib.figure import Figure

from common.intervals import clopper_pearson, upper_bound
from scenarios import fly, run
from scenarios.api.scenario import load
from scenarios.api.statistics import statistics_of
from scenarios.errors import InputError

SHORT = {
    "title": "Short <b>flights</b>",
    "fidelity": "kinematic",
    "sweep": {"nu": [0.3, 0.5]},
    "guidance": {"rate_hz": 5.0},
    "flight": {"crossings": 2, "log_rate_hz": 5.0},
    "criteria": {"crossing_interval_error": False, "tracking_error_rms_m": False},
}

SAMPLED = {
    "title": "Sampled",
    "study": "monte_carlo",
    "extends": "operational",
    "fidelity": "kinematic",
    "flights": 8,
    "guidance": {"rate_hz": 5.0},
    "flight": {"crossings": 1, "log_rate_hz": 5.0},
    "draws": [{"key": "wind.speed_mps", "uniform": [0.0, 4.0]}],
}


SEARCHED = {key: value for key, value in SAMPLED.items() if key != "flights"} | {"study": "falsify"}


@pytest.fixture(scope="module")
def study():
    return run(SHORT, jobs=1, histories=1)


@pytest.fixture(scope="module")
def flight():
    return fly(SHORT, nu=0.5)


def test_tables_have_the_units_of_their_columns(flight):
    assert flight.row.attrs["units"]["min_distance_m"] == "m"
    assert flight.row.attrs["units"]["epsilon_per_m"] == "1/m"
    assert flight.crossings.attrs["units"]["angle_deg"] == "deg"
    assert set(flight.history.attrs["units"]) == set(flight.history.columns)
    assert flight.history.attrs["units"]["heading_rate_rad_s"] == "rad/s"
    assert flight.history.attrs["meanings"]["roll_rad"] == "roll"


def test_what_is_changed_in_a_table_changes_no_flight_and_no_report():
    made = run(SHORT, jobs=1, histories=1)
    nearest, crossings, page = (
        made.flights["nu_0.50"].row["min_distance_m"],
        made.flights["nu_0.50"].crossings,
        made.report(),
    )
    made.summary["min_distance_m"] /= 1000.0
    made.summary["flight_id"] = "mine"
    made.crossings["time_s"] = 0.0
    assert list(made.flights) == ["nu_0.30", "nu_0.50"]
    assert made.flights["nu_0.50"].row["min_distance_m"] == nearest
    assert made.flights["nu_0.50"].crossings.equals(crossings)
    assert made.report() == page


def test_a_flight_says_how_it_ended(flight):
    assert flight.met
    assert flight.kept_out
    assert flight.reasons == ()
    strict = fly(
        SHORT, nu=0.5, criteria={"crossing_distance_m": [1.0, 2.0], "tracking_error_end_m": 1e-9}
    )
    assert not strict.met
    assert len(strict.reasons) == 2
    assert strict.kept_out


def test_a_reason_is_a_whole_sentence_with_its_remedy():
    (reason,) = fly(SHORT, nu=0.5, flight={"duration_max_s": 5.0}).reasons
    assert reason.startswith(
        "did not settle within 5 s: fly longer (flight.duration_max_s) or start closer"
    )


def test_a_flight_that_cannot_be_flown_is_a_flight_with_its_reason():
    # A vessel that outruns the UAV has no solution.
    infeasible = fly(SHORT, nu=1.5)
    assert infeasible.row["outcome"] == "infeasible"
    assert infeasible.reasons == (infeasible.row["message"],)
    for use in (
        lambda: infeasible.history,
        infeasible.plot,
        lambda: infeasible.export("flight.kmz"),
    ):
        with pytest.raises(InputError, match="has no time history"):
            use()
    assert "infeasible" in infeasible._repr_html_()


def test_a_figure_has_the_track_and_the_histories(flight):
    figure = flight.plot()
    assert isinstance(figure, Figure)
    titles = [ax.get_title() for ax in figure.axes]
    assert titles[0] == "The whole flight"
    assert "Distance\n[m]" in [ax.get_ylabel() for ax in figure.axes]


def test_a_time_history_is_exported_whole(flight, tmp_path):
    for suffix, read in (
        (".csv", pd.read_csv),
        (".parquet", pd.read_parquet),
        (".arrow", pyarrow.feather.read_feather),
    ):
        pd.testing.assert_frame_equal(
            read(flight.export(tmp_path / f"flight{suffix}")), flight.history, check_exact=True
        )
    table = pyarrow.feather.read_table(tmp_path / "flight.arrow")
    assert table.schema.field("airspeed_mps").metadata[b"unit"] == b"m/s"


def test_an_export_holds_the_flight_alone(study, tmp_path):
    recorded = next(
        flight for flight in study.flights.values() if flight.flight_id in study._data.recorded()
    )
    content = json.loads(recorded.export(tmp_path / "flight.geojson").read_text(encoding="utf-8"))
    assert content["type"] == "FeatureCollection"
    assert (
        len(recorded.export(tmp_path / "a.tracks.csv").read_text(encoding="utf-8").splitlines())
        == len(recorded.history) + 1
    )


def test_paths_and_suffixes_that_cannot_be_written_are_one_line(flight, study, tmp_path):
    with pytest.raises(InputError, match=r"'a.km' ends in '.km'; did you mean '.kmz'\?"):
        flight.export(tmp_path / "a.km")
    for name in ("a.kmz", "a.csv"):
        with pytest.raises(
            InputError,
            match=rf"{name}' cannot be written: there is no directory '.*missing'; make it",
        ):
            flight.export(tmp_path / "missing" / name)
    with pytest.raises(
        InputError, match=r"'a.txt' ends in '.txt'; a report is written as .html or .pdf"
    ):
        study.report(tmp_path / "a.txt")
    assert list(tmp_path.iterdir()) == []


def test_a_report_is_text_or_a_file(study, tmp_path):
    page = study.report()
    assert "Short &lt;b&gt;flights" in page
    assert study.report(tmp_path / "report.html") == str(tmp_path / "report.html")
    assert (tmp_path / "report.html").read_text(encoding="utf-8") == page


def test_a_notebook_shows_text_as_text(study, flight):
    for shown in (study, flight, load(SHORT).set(nu=0.4)):
        page = shown._repr_html_()
        assert "<table>" in page
        assert "<b>" not in page
    assert 'src="data:image/png;base64,' in flight._repr_html_()


def test_nothing_is_left_on_disk_nor_printed(capfd, monkeypatch, tmp_path):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.chdir(tmp_path)
    flown = fly(SHORT, nu=0.5)
    directory = flown.run.directory
    assert directory.parent == tmp_path
    assert flown.history is not None
    with pytest.raises(InputError, match=r"did you mean 'nu_0\.50'"):
        fly(SHORT, flight_id="nu_0.5")
    assert list(tmp_path.iterdir()) == [directory]
    del flown
    gc.collect()
    assert list(tmp_path.iterdir()) == []
    assert capfd.readouterr() == ("", "")


def test_a_run_directory_is_written_where_it_is_asked_for(tmp_path):
    flown = fly(SHORT, nu=0.5, out=tmp_path / "run")
    assert flown.run.directory == tmp_path / "run"
    del flown
    gc.collect()
    assert (tmp_path / "run" / "summary.csv").is_file()
    with pytest.raises(InputError, match="holds another run"):
        fly(SHORT, nu=0.5, out=tmp_path / "run")


@pytest.mark.parametrize(
    ("scenario", "words"),
    [
        (
            SHORT,
            "'scenario' has 2 flights; name one of them by flight_id (nu_0.30 to nu_0.50), set nu to a single number, or use run",
        ),
        (
            "monte_carlo",
            "has 1000 flights; name one of them by flight_id (monte_carlo_00000 to monte_carlo_00999), or use run",
        ),
        ("sweep_nu", "by flight_id (nu_0.00 to nu_0.95)"),
        (42, "scenario is 42, of type int; give the name of a catalog scenario"),
        (["sweep_nu"], "scenario is ['sweep_nu'], of type list; give"),
        (SEARCHED, "whose flights cannot be flown one by one; use run"),
        ("convergence", "whose flights cannot be flown one by one; use run"),
        ("sweep_un", "unknown scenario 'sweep_un'; did you mean 'sweep_nu'?"),
        ("missing.toml", "no scenario file 'missing.toml'"),
        ({"title": "Mine", "sead": 1}, "unknown key 'sead'; did you mean 'seed'?"),
        (
            {"title": "Mine", "extends": "sweep_un"},
            "scenario: extends: unknown scenario 'sweep_un'",
        ),
        (
            SHORT | {"following": {"standoff_m": 3.0}},
            "key 'following.standoff_m' has no effect here",
        ),
    ],
)
def test_a_scenario_of_which_no_one_flight_can_be_flown_is_refused(scenario, words):
    with pytest.raises(InputError) as refused:
        fly(scenario)
    assert words in str(refused.value)


def test_a_study_of_no_flights_has_its_table():
    study = run(
        "convergence", ensemble={"trajectories": 3, "distance_max_m": 60.0, "samples": 0}, jobs=1
    )
    assert study.flights == {}
    assert len(study.summary) == 6  # each with both laws of the catalog's scenario


def test_statistics_are_an_object_with_the_bounds_of_the_file(tmp_path):
    study = run(SAMPLED, jobs=1, out=tmp_path / "run")
    found = study.statistics
    content = json.loads((tmp_path / "run" / "statistics.json").read_text(encoding="utf-8"))
    assert found.content == content
    violation = found.violation
    interval = clopper_pearson(violation.events, violation.flights, found.confidence)
    assert (violation.low, violation.high) == (interval.low, interval.high)
    assert violation.upper == upper_bound(violation.events, violation.flights, found.confidence)
    assert (found.flights, violation.flights) == (8, 8)
    # Eight flights do not bound a quantile of 1 %: its limit is not a number.
    assert math.isnan(found.quantile("min_distance_m", 0.01).low)
    # numpy's quantile of an even number of values: the mean of the two in the middle.
    assert found.quantile("min_distance_m", 0.5).value == pytest.approx(
        study.summary["min_distance_m"].median(), rel=1e-12
    )
    with pytest.raises(
        InputError,
        match=r"no quantile 0.3 of 'min_distance_m'; it has those of 0.01, 0.05, 0.5, 0.95, 0.99",
    ):
        found.quantile("min_distance_m", 0.3)
    with pytest.raises(
        InputError, match=r"no quantile 0.5 of 'distance'; figures are min_distance_m"
    ):
        found.quantile("distance", 0.5)


def test_statistics_of_subset_simulation_have_the_same_names():
    content = {
        "confidence": 0.95,
        "flights": {"done": 300, "measured": 299, "unknown": {}},
        "outcomes": {"completed": 300},
        "violation": {
            "estimate": 1e-5,
            "low": 1e-6,
            "high": 1e-4,
            "upper": 8e-5,
            "events": 4,
            "pessimistic": {"upper": 0.01},
        },
    }
    found = statistics_of(content)
    assert (found.violation.estimate, found.violation.upper, found.violation.flights) == (
        1e-5,
        8e-5,
        299,
    )
    assert (found.violation_at_most, found.quantiles) == (0.01, {})


def test_a_study_without_statistics_has_none(study):
    assert study.statistics is None


def test_a_path_is_a_scenario(tmp_path):
    (tmp_path / "mine.toml").write_text(
        'title = "Mine"\nfidelity = "kinematic"\nflight.crossings = 1\n', encoding="utf-8"
    )
    assert load(tmp_path / "mine.toml").name == "mine"
    assert load(Path(tmp_path / "mine.toml"), nu=0.25).changes == ("vessel.speed_ratio=0.25",)
