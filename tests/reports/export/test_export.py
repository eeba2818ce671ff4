"""Exporters: the project's own, and one that a user adds in a file."""

import sys

import numpy as np
import pandas as pd
import pytest

from common.errors import PluginError
from reports.build import export_run
from reports.errors import ReportError
from reports.output import write_flight
from reports.run.run_data import read_run
from tests.in_process import run_command
from tests.run_tables import write_manifest

OWN = """
from pathlib import Path


class FlightList:
    suffix = ".flights.txt"

    def write(self, run, path):
        path.write_text("\\n".join(run.summary["flight_id"]), encoding="utf-8")


class Unfit:
    suffix = ".txt"
"""


@pytest.fixture
def run_path(tmp_path):
    """Return a run of two flights; the first one has a time history."""
    path = tmp_path / "run"
    (path / "flights").mkdir(parents=True)
    manifest = {
        "format": 1,
        "study": "flights",
        "name": "small",
        "config": {},
        "flights_planned": 2,
    }
    write_manifest(path, manifest)
    pd.DataFrame({"flight_id": ["nu_0.50", "nu_1.00"], "nu": [0.5, 1.0]}).to_csv(
        path / "summary.csv", index=False
    )
    time = np.arange(3.0)
    flown = {"time_s": time, "north_m": 7.0 * time, "east_m": 0.0 * time, "altitude_m": 60.0 + time}
    flown |= {"vessel_north_m": 0.0 * time, "vessel_east_m": 10.0 * time}
    pd.DataFrame(flown).to_parquet(path / "flights" / "nu_0.50.parquet")
    return path


def test_tracks_are_exported_with_the_vessel_that_was_flown_about(run_path):
    (path,) = export_run(run_path, "tracks_csv", "nu_0.50")
    assert path.name == "small.nu_0.50.tracks.csv"
    (path,) = export_run(run_path, "tracks_csv")
    assert path == run_path / "export" / "small.tracks.csv"
    tracks = pd.read_csv(path)
    assert list(tracks["flight_id"]) == ["nu_0.50"] * 3
    assert list(tracks["north_m"]) == [0.0, 7.0, 14.0]
    # Nothing is known of velocities here, and they stay empty.
    assert list(tracks["vessel_east_m"]) == [0.0, 10.0, 20.0]
    assert tracks["velocity_north_mps"].isna().all()


@pytest.mark.parametrize("exporter", ["tracks_csv", "geojson"])
def test_a_time_history_that_cannot_be_read_is_named_and_the_status_is_1(run_path, exporter):
    (run_path / "flights" / "nu_1.00.parquet").write_bytes(
        (run_path / "flights" / "nu_0.50.parquet").read_bytes()[:200]
    )
    ended = run_command("reports.build", run_path, "--export", exporter)
    assert ended.status == 1
    assert "nu_1.00.parquet is gone or cannot be read; the export lacks it" in ended.errors
    assert "export: " in ended.out
    # Of the other flight alone nothing is missing.
    assert (
        run_command("reports.build", run_path, "--export", exporter, "--flight", "nu_0.50").status
        == 0
    )


def test_a_flight_is_written_where_the_packages_of_another_format_are_missing(
    run_path, monkeypatch, tmp_path
):
    for package in ("xarray", "h5netcdf"):
        monkeypatch.setitem(sys.modules, package, None)
    run = read_run(run_path)
    for suffix in (".csv", ".parquet", ".tracks.csv"):
        write_flight(run, "nu_0.50", tmp_path / f"flight{suffix}")
        assert (tmp_path / f"flight{suffix}").stat().st_size > 0
    with pytest.raises(
        ReportError, match="netcdf needs the packages xarray and h5netcdf; install the extra"
    ):
        write_flight(run, "nu_0.50", tmp_path / "flight.nc")


def test_a_user_adds_an_exporter_in_a_file_of_one_class(run_path, tmp_path):
    (tmp_path / "mine.py").write_text(OWN, encoding="utf-8")
    (path,) = export_run(run_path, f"{tmp_path / 'mine.py'}:FlightList")
    assert path.name == "small.flights.txt"
    assert path.read_text(encoding="utf-8").split() == ["nu_0.50", "nu_1.00"]
    with pytest.raises(PluginError, match=r"has no method write\(\)"):
        export_run(run_path, f"{tmp_path / 'mine.py'}:Unfit")


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("suffix = '/../x'\n    def write(self, run, path): ...", "has suffix = '/../x'"),
        (
            "suffix = '.x'\n    def __init__(self, a): ...\n    def write(self, run, path): ...",
            "missing 1 required positional",
        ),
        (
            "suffix = '.x'\n    def write(self, run, path): ...",
            "wrote no file; an exporter writes to the path that it is given",
        ),
        (
            "suffix = '.x'\n    def write(self, run, path): raise RuntimeError('a\\nb')",
            "Part': RuntimeError: a",
        ),
    ],
)
def test_what_is_wrong_with_a_users_exporter_is_no_damage_of_the_run(
    run_path, tmp_path, body, words
):
    (tmp_path / "mine.py").write_text(f"class Part:\n    {body}\n", encoding="utf-8")
    with pytest.raises(ReportError) as refused:
        export_run(run_path, f"{tmp_path / 'mine.py'}:Part")
    assert words in str(refused.value)
    assert "damaged" not in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_run_without_time_histories_has_no_tracks(run_path):
    (run_path / "flights" / "nu_0.50.parquet").unlink()
    with pytest.raises(ReportError, match="has no time histories of flights"):
        export_run(run_path, "tracks_csv")
    assert list((run_path / "export").iterdir()) == []


def test_an_export_that_cannot_be_written_is_one_line(run_path, tmp_path, monkeypatch):
    def fails(*_):
        raise ValueError("a time runs backwards")

    monkeypatch.setattr("reports.export.tracks_csv.TracksCsv.write", fails)
    with pytest.raises(
        ReportError,
        match=r"^flight 'nu_0.50' could not be written as 'a.tracks.csv': ValueError: a time runs b",
    ):
        write_flight(read_run(run_path), "nu_0.50", tmp_path / "a.tracks.csv")
    # A folder that cannot be made, whoever runs the test: there is a file of its name.
    (run_path / "export").write_text("", encoding="utf-8")
    with pytest.raises(
        ReportError, match=r"export' cannot be written: File exists; check permissions and space"
    ):
        export_run(run_path, "tracks_csv")
