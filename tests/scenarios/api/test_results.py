"""What flights and runs hold: tables with units, figures, exports, reports, and nothing left on
disk.
"""

import gc
import json
import math
import tempfile

import pandas as pd
import pyarrow.feather
import pytest

from common.intervals import clopper_pearson, upper_bound
from scenarios import fly, run
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


@pytest.fixture(scope="module")
def study():
    return run(SHORT, jobs=1, histories=1)


@pytest.fixture(scope="module")
def flight():
    return fly(SHORT, nu=0.5)


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
