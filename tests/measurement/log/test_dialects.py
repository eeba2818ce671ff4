"""Logs as loggers and spreadsheets write them: each is the log of one flight, and is read as it."""

import numpy as np
import pandas as pd
import pytest

from measurement.errors import MeasurementError
from measurement.log.config import read_config
from measurement.log.read import read_flight

NAMES = '[columns]\ntime = "Zeit"\nso2 = "SO2 [ppb]"\nco2 = "CO2 [%]"\nno = "NO [ppb]"\nno2 = "NO2 [ppb]"\n'
START = pd.Timestamp("2026-03-14T09:15:00Z")


@pytest.fixture
def expected(logged):
    """The flight as the plain log has it."""
    return read_flight(logged, read_config(logged.parent / "instrument.toml"))


@pytest.fixture
def table(logged):
    """The log's table under names of another language, with CO2 in per cent."""
    plain = pd.read_csv(logged)
    return pd.DataFrame(
        {
            "Zeit": START + pd.to_timedelta(plain["time_s"], unit="s"),
            "SO2 [ppb]": plain["so2_ppb"],
            "CO2 [%]": plain["co2_ppm"] / 1e4,
            "NO [ppb]": plain["no_ppb"],
            "NO2 [ppb]": plain["no2_ppb"],
        }
    )


def read(table, tmp_path, config="", encoding="utf-8", **how):
    """Write a table, and read it with a configuration."""
    log, toml = tmp_path / "other.csv", tmp_path / "other.toml"
    log.write_bytes(table.to_csv(index=False, **how).encode(encoding))
    toml.write_text(f'instrument = "electrochemical"\n{NAMES}{config}', encoding="utf-8")
    return read_flight(log, read_config(toml))


def is_the_flight(found, expected):
    time, values = expected.readings.time, expected.readings.values
    np.testing.assert_allclose(found.readings.time - found.readings.time[0], time, atol=1e-6)
    np.testing.assert_allclose(found.readings.values, values, rtol=1e-9)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "latin-1"])
def test_a_european_log_is_read(table, expected, tmp_path, encoding):
    table["Zeit"] = table["Zeit"].dt.tz_convert("Europe/Berlin").map(pd.Timestamp.isoformat)
    # From 0 to 360: 91 degrees west.
    table["Breite"], table["Länge"] = 27.5, 269.0
    places = "" if encoding == "utf-16" else 'latitude = "Breite"\nlongitude = "Länge"\n'
    found = read(table, tmp_path, places, encoding=encoding, sep=";", decimal=",")
    is_the_flight(found, expected)
    # 10:15 in Berlin in winter.
    assert found.about.first_utc == START.to_pydatetime()
    assert found.about.first_position == ((27.5, -91.0) if places else None)


def test_masses_of_sulphur_dioxide_are_read_as_such(table, expected, tmp_path):
    # 2.663 ug/m3 per ppb at 20 deg C and 1013.25 hPa: M p/(R T).
    table["SO2 [ppb]"] *= 64.064 * 101325.0 / (8.314462618 * 293.15) / 1000.0
    found = read(table, tmp_path, '[units]\nso2 = "ug/m3"\n')
    np.testing.assert_allclose(
        found.readings.values[:, 0], expected.readings.values[:, 0], rtol=1e-6
    )
    cold = read(table, tmp_path, '[units]\nso2 = "ug/m3"\ntemperature_c = 0\n')
    assert cold.readings.values[50, 0] / found.readings.values[50, 0] == pytest.approx(
        273.15 / 293.15
    )


def seconds(factor):
    return lambda times: [f"{factor * time.timestamp():.0f}" for time in times]


@pytest.mark.parametrize(
    ("begin", "written"),
    [
        (START, seconds(1)),
        (START, seconds(1000)),
        (START, seconds(1_000_000)),
        # Over midnight.
        (pd.Timestamp("2026-03-14T23:58:00Z"), lambda times: times.strftime("%H:%M:%S")),
    ],
    ids=["s", "ms", "us", "time of day"],
)
def test_seconds_since_1970_and_times_of_day_are_those_of_the_date_of_the_flight(
    table, expected, tmp_path, begin, written
):
    times = begin + pd.to_timedelta(expected.readings.time, unit="s")
    table["Zeit"] = written(times)
    found = read(table, tmp_path, "[flight]\ndate = 2026-03-14\n")
    is_the_flight(found, expected)
    assert found.about.first_utc == begin.to_pydatetime()
    assert found.about.last_utc == times[-1].to_pydatetime()
    if begin == START:
        with pytest.raises(MeasurementError, match="but the log begins at 2026-03-14"):
            read(table, tmp_path, "[flight]\ndate = 2026-03-15\n")


def test_a_row_of_units_and_lines_above_the_head_are_read(table, expected, logged):
    head, rest = table.to_csv(index=False, sep="\t").split("\n", 1)
    names = head.replace(" [ppb]", "").replace(" [%]", "")
    logged.write_text(f"UAV 3\n# flight 7\n{names}\n\tppb\t%\tppb\tppb\n{rest}", encoding="utf-8")
    toml = logged.parent / "units.toml"
    config = NAMES.replace(" [ppb]", "").replace(" [%]", "")
    toml.write_text(f'instrument = "electrochemical"\n{config}', encoding="utf-8")
    found = read_flight(logged, read_config(toml))
    is_the_flight(found, expected)
    assert found.about.scale == {"co2": 1e4}


def test_a_leap_second_is_left_out_and_said(table, tmp_path, expected):
    begin = pd.Timestamp("2016-12-31T23:59:00Z")
    times = begin + pd.to_timedelta(expected.readings.time, unit="s")
    cells = times.strftime("%Y-%m-%dT%H:%M:%SZ").to_list()
    cells[60] = "2016-12-31T23:59:60Z"
    table["Zeit"] = cells
    found = read(table, tmp_path)
    assert len(found.readings.time) == len(expected.readings.time) - 1
    assert "leap seconds left out: 1" in found.about.table
