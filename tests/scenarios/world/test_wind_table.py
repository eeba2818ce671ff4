"""The mean wind from a table or from netCDF, and what is refused of them."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from flight_cases import fly, scenario

from scenarios.errors import InputError
from scenarios.scenario.sections.world import WindConfig
from scenarios.world.vessel import Place
from scenarios.world.wind import first_time, read_netcdf, tabled_wind
from scenarios.world.world import mean_wind, vessel_of

HOURLY = """time_utc,speed_mps,from_deg
2026-06-01T10:00:00Z,4.0,0
2026-06-01T11:00:00Z,8.0,0
2026-06-01T12:00:00Z,8.0,90
"""
START = 1780308000.0
"""2026-06-01T10:00:00Z (date -u -d ... +%s)."""

KATTEGAT = Place(
    latitude=math.radians(57.2), longitude=math.radians(11.3), altitude=60.0, utc=START
)


@pytest.fixture
def table(tmp_path):
    def written(text, name="wind.csv"):
        (tmp_path / name).write_text(text, encoding="utf-8")
        return str(tmp_path / name)

    return written


def wind(path, place=KATTEGAT, duration=3600.0, **changes):
    return tabled_wind(WindConfig(table=path, **changes), place, duration)


def test_an_hourly_table_is_timed_from_the_start_of_the_flight(table):
    field = wind(table(HOURLY), replace(KATTEGAT, utc=START + 1800.0))
    # From the north it blows south. After half an hour it has grown half-way to 8 m/s.
    assert field.now(0.0, 60.0) == pytest.approx((-6.0, 0.0), abs=1e-12)
    assert field.now(1800.0, 60.0) == pytest.approx((-8.0, 0.0), abs=1e-12)
    assert field.now(5400.0, 60.0) == pytest.approx((0.0, -8.0), abs=1e-12)
    assert first_time(table(HOURLY), KATTEGAT) == START


@pytest.mark.parametrize(
    ("text", "changes", "words"),
    [
        ("", {}, ["empty"]),
        (
            "height_m,speed_mps,to_deg\n10,5,0\n", {},
            ["from_deg is where the wind comes from: add 180 deg to 'to_deg', less 360 where it is more, and rename it"],
        ),
        (
            "time_utc,speed_kn,from_deg\n2026-06-01T12:00:00Z,9,0\n", {},
            ["'speed_kn' is in another unit than 'speed_mps': convert its values before you rename it"],
        ),
        ("height_m,speed_mps,from_deg\n", {}, ["no row below the header"]),
        (HOURLY + "2026-06-01T11:30:00Z,5,0\n", {}, ["line 5", "2026-06-01T11:30:00Z is before the line above", "sort"]),
        (HOURLY + "2026-06-01T13:00:00Z,-5,0\n", {}, ["line 5", "speeds go from 0 to 100 m/s"]),
        (HOURLY + "2026-06-01T13:00:00Z,5\n", {}, ["line 5", "every row has its columns"]),
        (HOURLY + "2026-06-01T13:00:00Z,5,3,90\n", {}, ["line 5 has 4 values, more values than the head line has names"]),
        (HOURLY, {"duration": 8000.0}, ["T10:00:00Z (line 2) to 2026-06-01T12:00:00Z (line 4);", "2026-06-01T12:13:20Z"]),
        ("height_m,speed_mps,from_deg\n10,5,0\n", {"roughness_m": 1e-3}, ["wind.roughness_m is given beside heights"]),
    ],
)  # fmt: skip
def test_a_table_of_no_use_is_refused_in_one_line(table, text, changes, words):
    with pytest.raises(InputError) as refusal:
        wind(table(text), **changes)
    assert "\n" not in str(refusal.value)
    for word in ["wind.csv", *words]:
        assert word in str(refusal.value)


def test_a_table_over_time_and_height_is_both(table):
    lines = ["time_utc,height_m,speed_mps,from_deg"]
    for hour in (0, 1):
        times = f"2026-06-01T{10 + hour}:00:00Z"
        lines += [f"{times},{height},{hour + height / 10},180" for height in (10, 100)]
    field = wind(table("\n".join(lines)))
    assert field.now(1800.0, 100.0) == pytest.approx((10.5, 0.0), abs=1e-12)


@pytest.mark.slow
def test_a_flight_in_a_wind_that_changes_knows_it_and_crosses_as_predicted(table):
    # From 4 m/s ahead to 8 m/s from abeam within 20 minutes.
    rows = "time_utc,speed_mps,from_deg\n2026-06-01T10:00:00Z,4.0,0\n2026-06-01T10:20:00Z,8.0,90\n"
    flight = {"crossings": 0, "duration_max_s": 900.0}
    flown = fly(wind={"table": table(rows)}, flight=flight, start={"distance_m": (400.0, 400.0)})
    row = flown.row
    assert (row["outcome"], row["keepout_violations"]) == ("completed", 0), row["message"]
    assert (row["wind_speed_mps"], row["wind_from_deg"]) == pytest.approx((4.0, 0.0), abs=1e-9)
    assert row["nu_max"] > row["nu_min"] + 0.05
    # The wind changes by up to 9 m/s in 1200 s; the filter follows 20 s behind at most.
    assert row["wind_error_rms_mps"] < 0.15
    predicted = row["crossing_interval_predicted_s"]
    assert row["crossing_interval_mean_s"] == pytest.approx(predicted, rel=0.02)
    # The plume turns with the wind: behind the vessel's motion north at 8 m/s through the air.
    given = scenario(wind={"table": table(rows)}, flight=flight)
    field = mean_wind(given, vessel_of(given))
    for time in (10.0, 500.0, 890.0):
        north, east = field.now(time, 60.0)
        axis = flown.history["plume_axis_rad"].iloc[round(10 * time)]
        off = math.remainder(axis - math.atan2(east, north - 8.0), math.tau)
        assert off == pytest.approx(0.0, abs=1e-4)


@pytest.fixture
def netcdf(tmp_path):
    """Return a function that writes winds on a grid of latitudes and longitudes at some hours."""
    xarray = pytest.importorskip("xarray", reason="xarray is an extra")
    pytest.importorskip("h5netcdf", reason="h5netcdf is an extra")

    def written(hours, latitude, longitude, **winds):
        times = np.array([f"2026-06-01T{hour}:00" for hour in hours], dtype="datetime64[ns]")
        coords = {"valid_time": times, "latitude": latitude, "longitude": longitude}
        data = {name: (tuple(coords), values) for name, values in winds.items()}
        xarray.Dataset(data, coords=coords).to_netcdf(tmp_path / "era5.nc", engine="h5netcdf")
        return str(tmp_path / "era5.nc")

    return written


def test_netcdf_of_era5_is_interpolated_at_the_place(netcdf, tmp_path):
    # As ERA5 has it: latitudes from the north, longitudes from 0 to 360, hours.
    latitude, longitude = np.array([58.0, 57.0]), np.array([11.0, 12.0])
    east = np.zeros((2, 2, 2)) + longitude - 11.0
    north = np.zeros((2, 2, 2)) + latitude[:, None] - 57.0
    north[1] += 1.0
    winds = {"u10": east, "v10": north, "u100": 2.0 * east, "v100": 2.0 * north}
    path = netcdf((10, 11), latitude, longitude, **winds)
    field = wind(path)
    # At 57.2 N, 11.3 E.
    assert field.now(0.0, 10.0) == pytest.approx((0.2, 0.3), abs=1e-6)
    assert field.now(3600.0, 100.0) == pytest.approx((2.4, 0.6), abs=1e-6)
    (tmp_path / "no.nc").write_bytes(b"no")
    refused = (
        (path, replace(KATTEGAT, latitude=0.0), "latitudes go from 57 to 58 deg"),
        (path, replace(KATTEGAT, latitude=math.nan), "place.latitude_deg"),
        (str(tmp_path / "no.nc"), KATTEGAT, r"no\.nc: cannot be read as netCDF"),
    )
    for file, place, words in refused:
        with pytest.raises(InputError, match=words):
            wind(file, place)
    with pytest.raises(InputError, match="a time and u10 with v10"):
        wind(netcdf((10, 11), latitude, longitude, u10=east))


@pytest.mark.parametrize(
    ("first", "last", "at"),
    [(0.0, 360.0, -0.1), (-180.0, 180.0, 179.9), (350.0, 370.1, 5.0), (-190.0, -169.9, 175.0)],
)
def test_netcdf_has_the_wind_of_a_longitude_however_its_grid_counts_it(netcdf, first, last, at):
    longitudes = np.arange(first, last, 0.25)
    # Towards the east at one m/s per degree east of a longitude.
    east = np.broadcast_to((longitudes - at + 180.0) % 360.0 - 180.0, (1, 2, len(longitudes)))
    winds = {"u10": east, "v10": np.ones_like(east)}
    path = netcdf((10,), np.array([57.0, 58.0]), longitudes, **winds)
    found = read_netcdf(Path(path), 57.2, at)[2]
    assert found[0] == pytest.approx(np.array([[1.0, 0.0]]), abs=1e-9)
