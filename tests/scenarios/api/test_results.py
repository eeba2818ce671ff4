"""What flights and runs hold: tables with units, figures, exports, reports, and nothing left on
disk.
"""

import gc
import tempfile

import pandas as pd
import pyarrow.feather
import pytest

from scenarios import fly
from scenarios.errors import InputError

SHORT = {
    "title": "Short <b>flights</b>",
    "fidelity": "kinematic",
    "sweep": {"nu": [0.3, 0.5]},
    "guidance": {"rate_hz": 5.0},
    "flight": {"crossings": 2, "log_rate_hz": 5.0},
    "criteria": {"crossing_interval_error": False, "tracking_error_rms_m": False},
}


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
