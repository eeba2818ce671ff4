"""Logs with rows that no sensor and no receiver has written are refused, or read, with a line that
names the rows.
"""

import json

import numpy as np
import pandas as pd
import pytest
from logged_flights import run


def with_values(logged, column, rows, value):
    table = pd.read_csv(logged)
    table.loc[rows, column] = value
    table.to_csv(logged, index=False)


def refusal(logged, capsys):
    """Return the one line by which a log is refused."""
    assert run(logged) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    return error


@pytest.mark.parametrize(
    ("column", "rows", "value", "told"),
    [
        (
            "so2_ppb",
            [20],
            50000.0,
            "SO2 is 50000 ppb in row 22; its sensor reads 20000 ppb at most (range_high)",
        ),
        (
            "so2_ppb",
            [20, 30],
            50000.0,
            "SO2 is 50000 ppb in row 22, and 1 more; its sensor reads 20000 ppb at most",
        ),
        ("co2_ppm", [40], 6000.0, "CO2 is 6000 ppm in row 42; its sensor reads 5000 ppm at most"),
    ],
)
def test_a_reading_beyond_the_range_of_its_sensor_is_refused_with_its_row(
    logged, capsys, column, rows, value, told
):
    with_values(logged, column, rows, value)
    error = refusal(logged, capsys)
    assert told in error
    assert "leave such a cell empty" in error


def test_a_calibration_with_air_without_co2_is_refused_with_its_row(logged, capsys):
    # Zero air is 420 ppm below the background, more than a plume is above it: it drew the slope to
    # 0.
    with_values(logged, "co2_ppm", range(40, 60), 2.0)
    error = refusal(logged, capsys)
    # Air has 250 ppm at least; noise of 1 ppm, a zero of 5 ppm (1 sigma) and 1 ppm for what is not
    # stated, 8 times: 42 ppm.
    assert (
        "CO2 is 2 ppm in row 42, and 19 more are as low; air, noise, zero and other gases explain 208 ppm at least"
        in error
    )
    assert "or is of a calibration from which the sensor has not recovered, leave it empty" in error


@pytest.mark.usefixtures("briefly")
def test_a_reading_at_the_end_of_the_range_is_saturated(logged, capsys):
    with_values(logged, "so2_ppb", [20], 20000.0)
    assert run(logged) == 0
    assert "SO2 is saturated at 20000 ppb" in capsys.readouterr().out


def test_times_of_the_day_without_marks_are_refused_with_the_row_of_a_new_minute(logged, capsys):
    # The log has 301 rows, a second apart: from 10:00:30 on five minutes begin.
    clock = pd.Timestamp("2026-06-01T10:00:30") + pd.to_timedelta(np.arange(301), unit="s")
    with_values(logged, "time_s", range(301), clock.strftime("%H%M%S").astype(int))
    words = "times in column 'time_s' go from 100059 to 100100 (row 32), and so at each of 5 minutes: they are hours, minutes and"
    assert words in refusal(logged, capsys)


@pytest.mark.usefixtures("briefly")
@pytest.mark.parametrize("gap", [(), range(60, 100)])
def test_seconds_are_no_times_of_the_day_even_where_one_gap_is_as_a_new_minute_is(logged, gap):
    table = pd.read_csv(logged).iloc[:160]
    table.drop(index=[*gap]).to_csv(logged, index=False)
    assert run(logged) == 0


def in_degrees(logged):
    table = pd.read_csv(logged)
    table["latitude_deg"] = 57.0 + table.pop("north_m") / 111_195.0
    table["longitude_deg"] = 11.0 + table.pop("east_m") / 60_560.0
    table.to_csv(logged, index=False)


@pytest.mark.usefixtures("briefly")
def test_places_of_a_receiver_without_a_fix_are_missing_and_told(logged, capsys):
    in_degrees(logged)
    for column in ("latitude_deg", "longitude_deg"):
        with_values(logged, column, [0, *range(50, 60)], 0.0)
    assert run(logged) == 0
    told = "11 rows, from row 2 to row 61, are at latitude 0 and longitude 0, as of a receiver without a fix: taken as missing"
    assert f"places: {told}" in capsys.readouterr().out
    out = logged.parent / "out"
    flight = json.loads((out / "estimate.json").read_text(encoding="utf-8"))["flight"]
    assert flight["place_remark"] == told
    assert flight["first_position"][0] == pytest.approx(57.0, abs=0.1)
    # The fixture flies north at 6 m/s and 50 m to either side.
    samples = pd.read_csv(out / "samples.csv")
    assert np.hypot(samples["north_m"], samples["east_m"]).max() < 2000.0


@pytest.mark.parametrize("column", ["north_m", "east_m", "latitude_deg"])
def test_a_place_that_no_aircraft_reaches_is_refused_with_its_row(logged, capsys, column):
    if column == "latitude_deg":
        in_degrees(logged)
    table = pd.read_csv(logged)
    with_values(
        logged, column, [70], table[column][70] + (1.0 if column == "latitude_deg" else 111_195.0)
    )
    error = refusal(logged, capsys)
    assert (
        "the place in row 72 is 111.2 km from that in row 71, 1 s earlier, which is faster than 340 m/s"
        in error
    )
    assert "(1 of 2 such jumps)" in error


@pytest.mark.usefixtures("briefly")
def test_a_receiver_that_is_slower_than_the_log_does_not_jump(logged):
    # A new place every 20 s, in which a fast aircraft flies 6 km: between two rows it is 6 km a
    # second.
    table = pd.read_csv(logged)
    table["north_m"] = 300.0 * 20.0 * (table["time_s"] // 20.0)
    table["east_m"] = 0.0
    table.to_csv(logged, index=False)
    assert run(logged) == 0


ROWS = "".join(f"{t}.0,2.5,420.1\n" for t in range(9))
HEAD = "time_s,so2_ppb,co2_ppm\n"


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ("", "is empty; it needs a head line and a row per reading"),
        (
            "# UAV 3\n# flight 7\n" + HEAD + ROWS,
            "has in line 3 more values than its head line has names ('# UAV 3'): the first line has to name every column",
        ),
        (
            "# UAV 3\n" + HEAD + ROWS,
            "has rows with more values than its head line has names ('# UAV 3'): the first line has to",
        ),
        (HEAD + ROWS.replace(".", ","), "and write decimals with a point"),
        (
            ROWS,
            "has no head line, but numbers in its first line; add one that names every column, as in time_s, so2_ppb, co2_ppm",
        ),
        (
            ROWS.replace(".0", ".5").replace("2.5", "0.5"),
            "has no head line, but numbers in its first line",
        ),
        (
            HEAD + '"0,0","2,5","420,1"\n',
            "or 2024-05-01T12:00:00.0; write decimals with a point, as in 0.0",
        ),
        (
            HEAD + '0,"2,5",420\n',
            "it must hold numbers, or be empty; write decimals with a point, as in 2.5",
        ),
        (
            "time_s,so2_ppb,so2_ppb,co2_ppm\n1,2,2,420\n",
            "has the column 'so2_ppb' twice; rename or remove one of them",
        ),
        (HEAD + '"' + ROWS, "has a quotation mark in line 2 that is not closed; remove it"),
    ],
)
def test_a_table_that_is_no_log_is_refused_in_plain_words(logged, capsys, content, told):
    logged.write_text(content, encoding="utf-8")
    error = refusal(logged, capsys)
    assert told in error
    assert "0.0.1" not in error
    assert "C error: Expected" not in error


def test_a_clock_that_is_set_back_is_told_apart_from_rows_that_are_not_sorted(logged, capsys):
    # Seconds of the day begin anew at midnight; rows sorted by them would be of two times at once.
    table = pd.read_csv(logged)
    table.assign(time_s=(86_300.0 + table["time_s"]) % 86_400.0).to_csv(logged, index=False)
    error = refusal(logged, capsys)
    assert "86399 s in row 101 is followed by 0 s" in error
    assert "or, where the clock was set back, correct the times after it" in error


@pytest.mark.parametrize("dates", [True, False])
def test_a_row_without_a_time_is_named(logged, capsys, dates):
    table = pd.read_csv(logged)
    if dates:
        table["time_s"] = (
            pd.Timestamp("2026-06-01T10:00:00") + pd.to_timedelta(table["time_s"], unit="s")
        ).astype(str)
    table.loc[20, "time_s"] = np.nan
    table.to_csv(logged, index=False)
    error = refusal(logged, capsys)
    assert (
        error
        == f"error: '{logged}' has no time in row 22; give a time in every row, or remove the row\n"
    )


@pytest.mark.parametrize(("row", "word"), [(301, "Mean"), (100, "time_s"), (0, "s")])
def test_a_row_of_words_among_readings_is_named(logged, capsys, row, word):
    # A summary below the readings, head lines of two logs in one file, and units below the head
    # line.
    lines = logged.read_text(encoding="utf-8").splitlines()
    lines.insert(1 + row, word + "," * lines[0].count(","))
    logged.write_text("\n".join(lines), encoding="utf-8")
    assert f"time '{word}' in column 'time_s' cannot be read (row {row + 2})" in refusal(
        logged, capsys
    )


def test_dates_and_times_of_digits_alone_are_no_seconds(logged, capsys):
    # As seconds they have a gap at every minute, and 100 % of the record were gaps.
    table = pd.read_csv(logged)
    moments = pd.Timestamp("2026-06-01T10:00:00") + pd.to_timedelta(table["time_s"], unit="s")
    table.assign(time_s=moments.dt.strftime("%Y%m%d%H%M%S")).to_csv(logged, index=False)
    assert "time 20260601100000 in column 'time_s' is a date and time without marks" in refusal(
        logged, capsys
    )
