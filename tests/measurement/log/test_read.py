"""The log of a flight: files, times, readings and places that are read, and that are refused."""

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from crossings import flight

from measurement.errors import MeasurementError
from measurement.gases import GASES, UNITS
from measurement.log.config import COLUMNS, LogConfig, read_config
from measurement.log.read import EARTH_RADIUS_M, read_flight
from measurement.sniffer.spec import sensor_preset

PAGE = Path(__file__).parents[3] / "docs" / "howto" / "measuring.md"
ROWS = "".join(f"{t}.0,2.5,420.1\n" for t in range(9))
HEAD = "time_s,so2_ppb,co2_ppm\n"
ELECTROCHEMICAL = LogConfig(instrument=sensor_preset("electrochemical"))


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
    table["latitude_deg"] = 57.0 + table.pop("north_m") / 111_195.0
    table["longitude_deg"] = 11.0 + table.pop("east_m") / 60_560.0
    table.to_csv(logged, index=False)


def since(start):
    return pd.Timestamp(start) + pd.to_timedelta(np.arange(301), unit="s")


# Files


@pytest.mark.parametrize(
    ("content", "quoted"),
    [
        ("", ["empty"]),
        (HEAD, ["0 readings"]),
        ("\x00\x01\x02", []),
        ("time_s,so2_ppb\n1,2\n", ["no CO2 column 'co2_ppm', but 'time_s', 'so2_ppb'"]),
        ("time_s,so2_ppb,so2_ppb,co2_ppm\n1,2,2,420\n", ["'so2_ppb'", "twice"]),
        (HEAD + ROWS.replace("\n", ",7\n"), ["more values", "time_s,so2_ppb,co2_ppm"]),
        (HEAD + ROWS.replace(".", ","), ["write decimals with a point"]),
        (ROWS, ["no head line", "time_s, so2_ppb, co2_ppm"]),
        (HEAD + '"' + ROWS, ["quotation mark in line 2"]),
        (HEAD + '0.0,"2,5",420\n', ["'so2_ppb' has '2,5' in row 2", "as in 2.5"]),
        (HEAD + "1,2,420\n2,inf,420\n", ["'so2_ppb' is infinite in row 3"]),
        (HEAD + "1,two,420\n", ["'so2_ppb' has 'two' in row 2"]),
        (HEAD + "soon,2,420\n", ["'soon'", "'time_s'", "row 2"]),
    ],
)
def test_a_file_that_is_no_log_is_refused(tmp_path, content, quoted):
    path = tmp_path / "flight.csv"
    path.write_text(content, encoding="utf-8")
    line = refusal(path)
    for words in quoted:
        assert words in line
    # Neither pandas' number of a column nor its words.
    assert "0.0.1" not in line
    assert "C error: Expected" not in line


@pytest.mark.parametrize(
    ("name", "content", "quoted"),
    [
        ("cut.csv.gz", b"\x1f\x8b\x08", "Compressed file ended"),
        ("no.csv.gz", b"\x1f\x8btime_s", "cannot be unpacked"),
        ("image.csv", b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR", "not a table as text"),
    ],
)
def test_bytes_that_are_no_text_are_refused(tmp_path, name, content, quoted):
    (tmp_path / name).write_bytes(content)
    assert quoted in refusal(tmp_path / name)


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


@pytest.mark.parametrize(
    ("config", "quoted"),
    [
        ("so2 = 'SO2'", ["no SO2 column 'SO2', but 'time_s', 'so2_ppb'", 'correct so2 = "SO2"']),
        ("time = 'when'", ["no time column 'when'", 'correct time = "when"']),
    ],
)
def test_a_column_that_the_configuration_names_has_to_be_there(logged, config, quoted):
    path = logged.parent / "columns.toml"
    path.write_text(f"[columns]\n{config}\n", encoding="utf-8")
    for words in quoted:
        assert words in refusal(logged, read_config(path))


def test_columns_units_and_places_are_mapped(logged):
    table = pd.read_csv(logged)
    renamed = pd.DataFrame(
        {
            "Zeit": since("2024-05-01T12:00:00Z"),
            "SO2 [ppm]": table["so2_ppb"] / 1000.0,
            "CO2": table["co2_ppm"],
            "NO": table["no_ppb"],
            "NO2": table["no2_ppb"],
            "lat": 54.0 + np.degrees(table["north_m"] / EARTH_RADIUS_M),
            "lon": 8.0 + np.degrees(table["east_m"] / EARTH_RADIUS_M / np.cos(np.radians(54.0))),
        }
    )
    other, config = logged.with_name("other.csv"), logged.with_name("other.toml")
    renamed.to_csv(other, index=False)
    config.write_text(
        '[columns]\ntime = "Zeit"\nso2 = "SO2 [ppm]"\nco2 = "CO2"\nno = "NO"\nno2 = "NO2"\n'
        'latitude = "lat"\nlongitude = "lon"\n[scale]\nso2 = 1000.0\n'
        '[units]\nco2 = "ppm"\nno = "ppb"\nno2 = "ppb"\n',
        encoding="utf-8",
    )
    found = read_flight(other, read_config(config))
    expected = read_flight(logged, ELECTROCHEMICAL)
    np.testing.assert_allclose(found.readings.time, expected.readings.time, rtol=1e-12)
    np.testing.assert_allclose(found.readings.values, expected.readings.values, rtol=1e-12)
    # A degree is kept to 1e-16 of itself, and the file to 17 digits.
    for name in ("north_m", "east_m"):
        np.testing.assert_allclose(found.place[name], table[name], rtol=0.0, atol=1e-6)


def test_every_name_that_columns_may_have_is_documented_with_its_unit_and_its_usual_column():
    page = PAGE.read_text(encoding="utf-8")
    table = page.partition("| column of the log unless named |")[2].partition("\n\n")[0]
    rows = re.findall(r"^\| `(\w+)` \| ([^|]+) \| `(\w+)` \|$", table, re.MULTILINE)
    assert {name: column for name, _, column in rows} == COLUMNS
    units = {name: unit.partition(",")[0] for name, unit, _ in rows}
    # Same as in the names of the usual columns.
    assert {gas: units[gas] for gas in GASES} == {gas: UNITS[gas] for gas in GASES}
    for name, unit in (("time", "seconds"), ("latitude", "degrees"), ("height", "m")):
        assert units[name] == unit


# Times


def test_times_that_do_not_increase_are_refused_with_the_row(logged):
    # Seconds of the day begin anew at midnight.
    times = (86_300.0 + pd.read_csv(logged)["time_s"]) % 86_400.0
    changed(logged, time_s=times)
    assert "86399 s in row 101 is followed by 0 s" in refusal(logged)
    logged.write_text(HEAD + "1,2,420\n2,2,420\n48,2,420\n39,2,420\n", encoding="utf-8")
    assert "48 s in row 4 is followed by 39 s" in refusal(logged)


def test_times_of_the_day_without_marks_are_refused_with_the_row_of_a_new_minute(logged):
    # The log has 301 rows, a second apart: from 10:00:30 on five minutes begin.
    changed(logged, time_s=since("2026-06-01T10:00:30").strftime("%H%M%S").astype(int))
    line = refusal(logged)
    assert "from 100059 to 100100 (row 32)" in line
    assert "5 minutes" in line


@pytest.mark.parametrize("gap", [(), range(60, 100)])
def test_seconds_are_no_times_of_the_day_even_where_one_gap_is_as_a_new_minute_is(logged, gap):
    table = pd.read_csv(logged).iloc[:160].drop(index=[*gap])
    table.to_csv(logged, index=False)
    assert len(read_flight(logged, ELECTROCHEMICAL).readings) == len(table)


def test_dates_and_times_of_digits_alone_are_no_seconds(logged):
    # As seconds they have a gap at every minute, and 100 % of the record would be gaps.
    changed(logged, time_s=since("2026-06-01T10:00:00").strftime("%Y%m%d%H%M%S"))
    assert "20260601100000" in refusal(logged)


@pytest.mark.parametrize("dates", [True, False])
def test_a_row_without_a_time_is_named(logged, dates):
    if dates:
        changed(logged, time_s=since("2026-06-01T10:00:00").astype(str))
    changed(logged, 20, time_s=np.nan)
    assert "no time in row 22" in refusal(logged)


@pytest.mark.parametrize(("row", "word"), [(301, "Mean"), (100, "time_s")])
def test_a_row_of_words_among_readings_is_named(logged, row, word):
    # A summary below the readings, and head lines of two logs in one file.
    lines = logged.read_text(encoding="utf-8").splitlines()
    lines.insert(1 + row, word + "," * lines[0].count(","))
    logged.write_text("\n".join(lines), encoding="utf-8")
    line = refusal(logged)
    assert f"'{word}'" in line
    assert f"row {row + 2}" in line


@pytest.mark.parametrize(
    ("start", "offset"), [("2026-06-01T10:00:00Z", True), ("2026-06-01T10:00:00", False)]
)
def test_times_and_first_and_last_known_place_of_a_log_are_kept(logged, start, offset):
    latitudes = [None, *(56.0 + 1e-4 * i for i in range(300))]
    changed(logged, time_s=since(start).astype(str), latitude_deg=latitudes, longitude_deg=11.5)
    about = read_flight(logged, ELECTROCHEMICAL).about
    found = about.record()
    assert (found["first_utc"], found["last_utc"], found["utc_from"]) == (
        "2026-06-01T10:00:00Z",
        "2026-06-01T10:05:00Z",
        "log",
    )
    assert about.offset is offset
    assert about.first_position == (56.0, 11.5)
    assert about.last_position == pytest.approx((56.0299, 11.5))


# Readings


@pytest.mark.parametrize(
    ("column", "rows", "value", "quoted"),
    [
        ("so2_ppb", [20, 30], 50000.0, "SO2 is 50000 ppb in row 22, and 1 more"),
        ("co2_ppm", [40], 6000.0, "CO2 is 6000 ppm in row 42; its sensor reads 5000 ppm"),
        # Air has 250 ppm at least; noise of 1 ppm, a zero of 5 ppm (1 sigma) and 1 ppm for what is
        # not stated, 8 times: 42 ppm. Zero air of a calibration drew the slope to 0.
        ("co2_ppm", range(40, 60), 2.0, "CO2 is 2 ppm in row 42, and 19 more are as low"),
        ("co2_ppm", range(40, 60), 2.0, "explain 208 ppm at least"),
    ],
)
def test_a_reading_that_its_sensor_cannot_have_is_refused_with_its_row(
    logged, column, rows, value, quoted
):
    changed(logged, rows, **{column: value})
    assert quoted in refusal(logged)


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


def test_co2_without_its_background_is_reported_as_that(logged):
    co2 = pd.read_csv(logged)["co2_ppm"] - 421.0
    assert co2.min() < 0.0
    changed(logged, co2_ppm=co2)
    assert "keep the background" in refusal(logged)


def test_an_unfiltered_cell_may_read_below_zero_for_no2_that_is_not_measured(logged):
    # 1.6 of NO2: far below the noise, and what such a cell truly reads in a plume.
    readings, spec = flight("alphasense_b4", 0.1, 4)
    so2, co2 = readings.values[:, :2].T
    assert so2.min() < -50.0
    table = pd.DataFrame({"time_s": readings.time, "so2_ppb": so2, "co2_ppm": co2})
    table.to_csv(logged, index=False)
    assert len(read_flight(logged, LogConfig(instrument=spec)).readings) == len(table)


# Places


def test_a_latitude_beyond_the_pole_is_refused_with_its_row(logged):
    changed(logged, latitude_deg=55.0, longitude_deg=11.0)
    changed(logged, 3, latitude_deg=95.0)
    # The head line is row 1.
    assert "latitude is 95 deg in row 5; it must be -90 to 90" in refusal(logged)


def test_places_of_a_receiver_without_a_fix_are_missing(logged):
    in_degrees(logged)
    changed(logged, [0, *range(50, 60)], latitude_deg=0.0, longitude_deg=0.0)
    found = read_flight(logged, ELECTROCHEMICAL)
    assert "11 rows, from row 2 to row 61," in found.about.place_remark
    assert found.about.first_position[0] == pytest.approx(57.0, abs=0.1)
    # The fixture flies north at 6 m/s and 50 m to either side.
    assert np.hypot(found.place["north_m"], found.place["east_m"]).max() < 2000.0


@pytest.mark.parametrize(
    ("column", "by"), [("north_m", 111_195.0), ("east_m", 111_195.0), ("latitude_deg", 1.0)]
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
    part = table.index >= 150
    changed(
        logged,
        latitude_deg=np.where(part, north, table["latitude_deg"]),
        longitude_deg=np.where(part, east, table["longitude_deg"]),
    )
    line = refusal(logged)
    # The head line is row 1.
    assert "the place in row 152 is " in line
    assert f"fit together with {words}: correct the places" in line


def test_a_receiver_that_is_slower_than_the_log_does_not_jump(logged):
    # A new place every 20 s, in which a fast aircraft flies 6 km: between two rows it is 6 km a
    # second.
    changed(logged, north_m=300.0 * 20.0 * (np.arange(301) // 20), east_m=0.0)
    assert len(read_flight(logged, ELECTROCHEMICAL).place) == 301
