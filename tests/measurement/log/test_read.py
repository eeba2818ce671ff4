"""The log of a flight: files, times, readings and places that are read, and that are refused."""

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from crossings import flight

from measurement.errors import MeasurementError
from measurement.gases import UNITS
from measurement.log.config import COLUMNS, LogConfig, read_config
from measurement.log.read import read_flight
from measurement.sniffer.spec import sensor_preset

PAGE = Path(__file__).parents[3] / "docs" / "howto" / "measuring.md"
ROWS = "".join(f"{t}.0,2.5,420.1\n" for t in range(9))
HEAD = "time_s,so2_ppb,co2_ppm\n"
ELECTROCHEMICAL = LogConfig(instrument=sensor_preset("electrochemical"))
METRES_PER_DEGREE = 111_195.0


def refusal(path, config=ELECTROCHEMICAL):
    """Return the one line by which a log is refused; it names the file, and once."""
    with pytest.raises(MeasurementError) as error:
        read_flight(path, config)
    line = str(error.value)
    assert "\n" not in line
    assert line.startswith(f"'{path}': ")
    assert line.count(str(path)) == 1
    return line


def changed(logged, rows=None, **columns):
    """Write other values into some rows of a log's columns, or into all rows."""
    table = pd.read_csv(logged)
    for name, value in columns.items():
        if rows is None:
            table[name] = value
        else:
            table.loc[rows, name] = value
    table.to_csv(logged, index=False)


def in_degrees(logged):
    table = pd.read_csv(logged)
    table["latitude_deg"] = 57.0 + table.pop("north_m") / METRES_PER_DEGREE
    table["longitude_deg"] = 11.0 + table.pop("east_m") / 60_560.0
    table.to_csv(logged, index=False)


def since(start):
    return pd.Timestamp(start) + pd.to_timedelta(np.arange(301), unit="s")


# Files


@pytest.mark.parametrize(
    ("name", "content", "quoted"),
    [
        ("log.csv", "", ["empty"]),
        ("log.csv", HEAD, ["0 readings"]),
        ("log.csv", "\x00\x01\x02", []),
        ("log.csv", "time_s,so2_ppb\n1,2\n", ["no CO2 column 'co2_ppm', but 'time_s', 'so2_ppb'"]),
        ("log.csv", "time_s,so2_ppb,so2_ppb,co2_ppm\n1,2,2,420\n", ["'so2_ppb'", "twice"]),
        ("log.csv", HEAD + ROWS.replace("\n", ",7\n"), ["more values", HEAD.strip()]),
        ("log.csv", HEAD + ROWS.replace(".", ","), ["write decimals with a point"]),
        ("log.csv", ROWS, ["no head line", "time_s, so2_ppb, co2_ppm"]),
        ("log.csv", HEAD + '"' + ROWS, ["quotation mark in line 2"]),
        ("log.csv", HEAD + '0.0,"2,5",420\n', ["'so2_ppb' has '2,5' in row 2", "as in 2.5"]),
        ("log.csv", HEAD + "1,2,420\n2,inf,420\n", ["'so2_ppb' is infinite in row 3"]),
        ("log.csv", HEAD + "1,two,420\n", ["'so2_ppb' has 'two' in row 2"]),
        ("log.csv", HEAD + "soon,2,420\n", ["'soon'", "'time_s'", "row 2"]),
        ("log.csv", HEAD + "1,2,420\n2,2,420\n48,2,420\n39,2,420\n", ["48 s in row 4", "39 s"]),
        ("cut.csv.gz", b"\x1f\x8b\x08", ["Compressed file ended"]),
        ("no.csv.gz", b"\x1f\x8btime_s", ["cannot be unpacked"]),
        ("image.csv", b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR", ["not a table as text"]),
    ],
)
def test_a_file_that_is_no_log_is_refused(tmp_path, name, content, quoted):
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    line = refusal(path)
    for words in quoted:
        assert words in line
    # Neither pandas' number of a column nor its words.
    assert "0.0.1" not in line
    assert "C error: Expected" not in line


def test_a_compressed_log_and_one_whose_rows_end_in_a_comma_are_read(logged):
    expected = read_flight(logged, ELECTROCHEMICAL).readings
    compressed = logged.with_name("flight.csv.gz")
    pd.read_csv(logged).to_csv(compressed, index=False)
    head, *lines = logged.read_text(encoding="utf-8").splitlines()
    with_commas = logged.with_name("commas.csv")
    with_commas.write_text("\n".join([head, *(f"{line}," for line in lines)]), encoding="utf-8")
    for path in (compressed, with_commas):
        found = read_flight(path, ELECTROCHEMICAL).readings
        np.testing.assert_array_equal(found.time, expected.time)
        np.testing.assert_array_equal(found.values, expected.values)


def test_a_column_that_the_configuration_names_has_to_be_there(logged):
    path = logged.parent / "columns.toml"
    for name, quoted in (("so2 = 'SO2'", "no SO2 column 'SO2'"), ("time = 'when'", "no time col")):
        path.write_text(f"[columns]\n{name}\n", encoding="utf-8")
        assert quoted in refusal(logged, read_config(path))


def test_every_name_that_columns_may_have_is_documented_with_its_unit_and_its_usual_column():
    page = PAGE.read_text(encoding="utf-8")
    table = page.partition("| column of the log unless named |")[2].partition("\n\n")[0]
    rows = re.findall(r"^\| `(\w+)` \| ([^|]+) \| `(\w+)` \|$", table, re.MULTILINE)
    assert {name: column for name, _, column in rows} == COLUMNS
    units = {name: unit.partition(",")[0] for name, unit, _ in rows}
    # Same as in the names of the usual columns.
    expected = UNITS | {"time": "seconds", "latitude": "degrees", "height": "m"}
    assert {name: units[name] for name in expected} == expected


# Times


@pytest.mark.parametrize(
    ("times", "quoted"),
    [
        # Seconds of the day begin anew at midnight.
        ((86_300.0 + np.arange(301)) % 86_400.0, ["86399 s in row 101 is followed by 0 s"]),
        # The log has 301 rows, a second apart: from 10:00:30 on five minutes begin.
        (
            since("2026-06-01T10:00:30").strftime("%H%M%S").astype(int),
            ["from 100059 to 100100 (row 32)", "5 minutes"],
        ),
        # As seconds they have a gap at every minute, and 100 % of the record would be gaps.
        (since("2026-06-01T10:00:00").strftime("%Y%m%d%H%M%S"), ["20260601100000"]),
        (np.where(np.arange(301) == 20, np.nan, np.arange(301.0)), ["no time in row 22"]),
        (
            since("2026-06-01T10:00:00").astype(str).where(np.arange(301) != 20),
            ["no time in row 22"],
        ),
    ],
    ids=["midnight", "times of day", "digits", "missing second", "missing date"],
)
def test_times_that_cannot_be_are_refused_with_the_row(logged, times, quoted):
    changed(logged, time_s=times)
    line = refusal(logged)
    for words in quoted:
        assert words in line


@pytest.mark.parametrize("gap", [(), range(60, 100)])
def test_seconds_are_no_times_of_the_day_even_where_one_gap_is_as_a_new_minute_is(logged, gap):
    table = pd.read_csv(logged).iloc[:160].drop(index=[*gap])
    table.to_csv(logged, index=False)
    assert len(read_flight(logged, ELECTROCHEMICAL).readings) == len(table)


@pytest.mark.parametrize(("row", "word"), [(301, "Mean"), (100, "time_s")])
def test_a_row_of_words_among_readings_is_named(logged, row, word):
    # A summary below the readings, and head lines of two logs in one file.
    lines = logged.read_text(encoding="utf-8").splitlines()
    lines.insert(1 + row, word + "," * lines[0].count(","))
    logged.write_text("\n".join(lines), encoding="utf-8")
    line = refusal(logged)
    assert f"'{word}'" in line
    assert f"row {row + 2}" in line


@pytest.mark.parametrize("zone", ["Z", ""])
def test_times_and_first_and_last_known_place_of_a_log_are_kept(logged, zone):
    latitudes = [None, *(56.0 + 1e-4 * i for i in range(300))]
    times = since(f"2026-06-01T10:00:00{zone}").astype(str)
    changed(logged, time_s=times, latitude_deg=latitudes, longitude_deg=11.5)
    about = read_flight(logged, ELECTROCHEMICAL).about
    found = about.record()
    assert (found["first_utc"], found["last_utc"], found["utc_from"]) == (
        "2026-06-01T10:00:00Z",
        "2026-06-01T10:05:00Z",
        "log",
    )
    assert about.offset is (zone == "Z")
    assert about.first_position == (56.0, 11.5)
    assert about.last_position == pytest.approx((56.0299, 11.5))


# Readings


@pytest.mark.parametrize(
    ("rows", "columns", "quoted"),
    [
        ([20, 30], {"so2_ppb": 50000.0}, ["SO2 is 50000 ppb in row 22, and 1 more"]),
        ([40], {"co2_ppm": 6000.0}, ["CO2 is 6000 ppm in row 42; its sensor reads 5000 ppm"]),
        # Air has 250 ppm at least; noise of 1 ppm, a zero of 5 ppm (1 sigma) and 1 ppm for what is
        # not stated, 8 times: 42 ppm. Zero air of a calibration drew the slope to 0.
        (
            range(40, 60),
            {"co2_ppm": 2.0},
            ["CO2 is 2 ppm in row 42, and 19 more are as low", "explain 208 ppm at least"],
        ),
        (range(301), {"co2_ppm": -1.0}, ["keep the background"]),
        (
            [3],
            {"latitude_deg": 95.0, "longitude_deg": 11.0},
            ["latitude is 95 deg in row 5; it must be -90 to 90"],
        ),
    ],
)
def test_what_its_sensor_cannot_read_is_refused_with_its_row(logged, rows, columns, quoted):
    changed(logged, rows, **columns)
    line = refusal(logged)
    for words in quoted:
        assert words in line


@pytest.mark.parametrize(
    ("config", "column", "value", "quoted"),
    [
        (ELECTROCHEMICAL, "so2_ppb", -9999.0, "SO2 is -9999 ppb in row 102"),
        (ELECTROCHEMICAL, "co2_ppm", -999.0, "CO2 is -999 ppm in row 102"),
        (LogConfig(), "no_ppb", -9999.0, "NO is -9999 ppb in row 102"),
    ],
)
def test_a_mark_for_a_missing_reading_is_refused_unless_it_is_named(
    logged, config, column, value, quoted
):
    changed(logged, 100, **{column: value})
    line = refusal(logged, config)
    assert quoted in line
    assert "missing = [-9999]" in line
    named = LogConfig(instrument=config.instrument, missing=(value,))
    found = read_flight(logged, named).readings
    changed(logged, 100, **{column: np.nan})
    expected = read_flight(logged, config).readings
    np.testing.assert_array_equal(found.values, expected.values)


def test_an_unfiltered_cell_may_read_below_zero_for_no2_that_is_not_measured(logged):
    # 1.6 of NO2: far below the noise, and what such a cell truly reads in a plume.
    readings, spec = flight("alphasense_b4", 0.1, 4)
    so2, co2 = readings.values[:, :2].T
    assert so2.min() < -50.0
    table = pd.DataFrame({"time_s": readings.time, "so2_ppb": so2, "co2_ppm": co2})
    table.to_csv(logged, index=False)
    assert len(read_flight(logged, LogConfig(instrument=spec)).readings) == len(table)


# Places; the head line is row 1


def test_places_of_a_receiver_without_a_fix_are_missing(logged):
    metres = pd.read_csv(logged)[["north_m", "east_m"]]
    in_degrees(logged)
    changed(logged, [0, *range(50, 60)], latitude_deg=0.0, longitude_deg=0.0)
    found = read_flight(logged, ELECTROCHEMICAL)
    assert "11 rows, from row 2 to row 61," in found.about.place_remark
    assert found.about.first_position[0] == pytest.approx(57.0, abs=0.1)
    # From the first known place on; longitudes of the fixture are to 0.1 %.
    moved = found.place[["north_m", "east_m"]] - metres
    assert np.nanmax(np.ptp(moved.dropna().to_numpy(), axis=0)) < 0.2


@pytest.mark.parametrize(
    ("column", "by"),
    [("north_m", METRES_PER_DEGREE), ("east_m", METRES_PER_DEGREE), ("latitude_deg", 1.0)],
)
def test_a_place_that_no_aircraft_reaches_is_refused_with_its_row(logged, column, by):
    if column == "latitude_deg":
        in_degrees(logged)
    changed(logged, 70, **{column: pd.read_csv(logged)[column][70] + by})
    line = refusal(logged)
    assert "the place in row 72 is 111.2 km from that in row 71, 1 s earlier" in line
    assert "(1 of 2 such jumps)" in line


@pytest.mark.parametrize(
    ("mistake", "words"),
    [
        (lambda north, east: (east, north), "latitude and longitude exchanged"),
        (lambda north, east: (north, -east), "the other sign of longitude"),
        (lambda north, east: (-north, -east), "the other signs of both"),
    ],
)
def test_a_track_that_jumps_by_a_mistake_is_refused_with_the_mistake(logged, mistake, words):
    in_degrees(logged)
    table = pd.read_csv(logged)
    north, east = mistake(table["latitude_deg"], table["longitude_deg"])
    changed(logged, table.index >= 150, latitude_deg=north, longitude_deg=east)
    line = refusal(logged)
    assert "the place in row 152 is " in line
    assert f"fit together with {words}: correct the places" in line


def test_a_receiver_that_is_slower_than_the_log_does_not_jump(logged):
    # A new place every 20 s, in which a fast aircraft flies 6 km: between two rows it is 6 km a
    # second.
    changed(logged, north_m=300.0 * 20.0 * (np.arange(301) // 20), east_m=0.0)
    assert len(read_flight(logged, ELECTROCHEMICAL).place) == 301
