"""The netCDF of a run, read back: places, motion, and what was measured."""

import json
import math
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from common.columns import Column, described, to_json
from common.geodesy import LocalFrame
from common.run_layout import COLUMNS
from measurement.gases import GASES, UNITS
from tests.reports.export.placed_flight import (
    READ,
    START,
    TOLERANCE,
    assert_read,
    exported,
    off,
    track,
)

pytestmark = pytest.mark.slow

FIGURES = {
    "fsc_percent": (Column("fuel sulphur content by regression"), 0.11),
    "fsc_uncertainty_percent": (Column("standard uncertainty of the fuel sulphur content"), 0.03),
    "fsc_low_percent": (Column("lower end of the 95 % interval"), 0.05),
    "sulphur_quality": (Column("class A, B or C of the result", kind="text"), "B"),
    "sulphur_suspect": (Column("whether it is reported as suspect", kind="truth"), True),
    "glow_flux": (Column("a figure of a user's", unit="kg/(m2 s)", scale=1e-3), 7000.0),
}
"""What is found in the flight: what each column is, and its value."""


@pytest.fixture
def measured(run_path):
    """The flight with a wind as estimated on board, an estimate of the plume's height, and the
    figures of a sniffer and of a user's instrument.
    """
    path = run_path / "flights" / "a, <b>.parquet"
    history = pd.read_parquet(path)
    history = history.assign(
        wind_north_mps=3.0,
        wind_east_mps=-4.0,
        axis_height_estimated_m=40.0,
        axis_height_deviation_m=2.5,
        glow_mps=1.25,
    )
    history.to_parquet(path)
    rows = pd.read_csv(run_path / "summary.csv")
    rows.assign(**{name: value for name, (_, value) in FIGURES.items()}).to_csv(
        run_path / "summary.csv", index=False
    )
    readings = {f"{gas}_reading_{UNITS[gas]}": "reading, held until the next one" for gas in GASES}
    columns = {
        "flights": {
            **described(readings, part="sniffer"),
            **described({"glow_mps": "speed of the glow"}, part="meter.py:Meter"),
        },
        "summary.csv": described({name: of for name, (of, _) in FIGURES.items()}, part="sniffer"),
    }
    (run_path / COLUMNS).write_text(json.dumps(to_json(columns)), encoding="utf-8")
    return run_path


def opened(path):
    xarray = pytest.importorskip("xarray", reason="xarray is an extra")
    return xarray.open_dataset(path, engine="h5netcdf")


def test_it_has_the_places(run_path, truth):
    with opened(exported(run_path, "netcdf")) as data:
        assert off(np.column_stack([data["lat"], data["lon"]]), truth[0]) < TOLERANCE
        assert off(np.column_stack([data["vessel_lat"], data["vessel_lon"]]), truth[1]) < TOLERANCE
        assert data["row_size"].to_numpy().tolist() == [601]
        assert data["time"].to_numpy()[0] == np.datetime64(int(START), "s")
        assert data.attrs["history"] == "2026-06-02T08:00:00Z: plume-flight run made.toml"


def test_readings_have_the_names_and_units_of_the_conventions(measured):
    """Names of the CF standard name table, version 60 and later."""
    names = {
        "so2_reading_ppb": ("mole_fraction_of_sulfur_dioxide_in_air", "1e-9"),
        "co2_reading_ppm": ("mole_fraction_of_carbon_dioxide_in_air", "1e-6"),
        "no_reading_ppb": ("mole_fraction_of_nitrogen_monoxide_in_air", "1e-9"),
    }
    with opened(exported(measured, "netcdf")) as data:
        for name, known in names.items():
            assert (data[name].attrs["standard_name"], data[name].attrs["units"]) == known
            assert_read(data[name].to_numpy(), name)
        assert set(names) == set(READ)
        # Its instrument has none.
        assert "no2_reading_ppb" not in data


def test_the_wind_is_that_estimated_on_board_by_true_north(measured):
    row, history = pd.read_csv(measured / "summary.csv").iloc[0], track()
    frame = LocalFrame(
        math.radians(row["place_latitude_deg"]), math.radians(row["place_longitude_deg"]), 60.0
    )
    turned = frame.true_north(*frame.to_geodetic(history["north_m"], history["east_m"]))
    # Much more than the tolerance below: another frame would show.
    assert np.abs(turned).max() > 1e-5
    with opened(exported(measured, "netcdf")) as data:
        north, east = (data[f"{way}ward_wind"] for way in ("north", "east"))
        for of, way in ((north, "north"), (east, "east")):
            assert of.attrs["standard_name"] == f"{way}ward_wind"
            assert of.attrs["units"] == "m s-1"
        # The wind of 5 m/s blows to 4 east and 3 north in the frame.
        blows_to = np.arctan2(east, north) - math.atan2(-4.0, 3.0)
        assert np.hypot(north, east).to_numpy() == pytest.approx(np.full(601, 5.0))
        assert blows_to.to_numpy() == pytest.approx(-turned, abs=1e-9)


def test_an_estimate_names_what_says_how_uncertain_it_is(measured):
    with opened(exported(measured, "netcdf")) as data:
        sulphur = data["fsc_percent"]
        assert (sulphur.dims, sulphur.attrs["units"]) == (("trajectory",), "percent")
        assert sulphur.to_numpy() == pytest.approx([0.11])
        beside = sulphur.attrs["ancillary_variables"].split()
        assert beside == ["fsc_uncertainty_percent", "fsc_low_percent"]
        assert [float(data[name].to_numpy()[0]) for name in beside] == [0.03, 0.05]
        assert data["sulphur_quality"].to_numpy().tolist() == [b"B"]
        assert data["sulphur_suspect"].to_numpy().tolist() == [1.0]
        height = data["axis_height_estimated_m"]
        assert (height.dims, height.attrs["units"]) == (("obs",), "m")
        assert height.attrs["ancillary_variables"] == "axis_height_deviation_m"
        assert set(data["axis_height_deviation_m"].to_numpy()) == {2.5}


def test_what_a_users_instrument_fills_is_there_without_another_line(measured):
    with opened(exported(measured, "netcdf")) as data:
        assert data["glow_mps"].attrs["units"] == "m s-1"
        assert data["glow_mps"].attrs["long_name"] == "speed of the glow"
        assert set(data["glow_mps"].to_numpy()) == {1.25}
        # In the unit that the column says, which is the recorded value times its scale.
        assert data["glow_flux"].attrs["units"] == "kg m-2 s-1"
        assert data["glow_flux"].to_numpy() == pytest.approx([7.0])


@pytest.mark.parametrize("run_path", ["date line"], indirect=True)
def test_it_keeps_to_the_conventions(measured, tmp_path):
    pytest.importorskip("xarray", reason="xarray is an extra")
    pytest.importorskip("compliance_checker", reason="compliance-checker is for developers")
    path = exported(measured, "netcdf")
    # In another process: packages of the checker warn as they are imported.
    checker = Path(sys.executable).with_name("compliance-checker")
    checked = subprocess.run(
        [checker, "-t", "cf:1.8", path],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "HOME": str(tmp_path)},
    )
    assert "All tests passed!" in checked.stdout, checked.stdout + checked.stderr
