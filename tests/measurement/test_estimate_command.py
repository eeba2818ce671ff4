"""The command from a CSV file to its directory, and what it refuses."""

import json
import re

import numpy as np
import pandas as pd
import pytest
from crossings import flight
from logged_flights import run

from measurement.estimate.__main__ import main
from measurement.estimate.flight_log.config import LogConfig
from measurement.estimate.flight_log.csv_file import read_flight
from measurement.estimate.flight_log.places import EARTH_RADIUS_M

BRIEFLY = pytest.mark.usefixtures("briefly")


def test_a_flight_is_estimated_printed_and_written(logged, capsys):
    assert run(logged) == 0
    printed = capsys.readouterr().out
    assert re.search(
        r"fuel sulphur content 0\.\d{3} % m/m, 95 % interval 0\.\d{3} to 0\.\d{3} %\n", printed
    )
    assert "standard uncertainty (1 sigma) 0." in printed
    assert "+-" not in printed
    assert "above the limit of 0.10 %; probability above it: more than 99.9 %" in printed
    assert "below the limit of 0.50 %" in printed
    out = logged.parent / "out"
    manifest, record = (
        json.loads((out / name).read_text(encoding="utf-8"))
        for name in ("manifest.json", "estimate.json")
    )
    assert manifest["study"] == "measurement"
    found = record["estimate"]
    assert found["low_percent"] < 0.3 < found["high_percent"]
    assert [row["elapsed_s"] for row in record["over_time"]][-1] == 300.0
    assert record["time_to_verdict_s"]["0.1"] <= 120.0
    assert record["other"]["method"] == "areas"
    samples = pd.read_csv(out / "samples.csv")
    assert len(samples) == 301
    assert {
        "co2_excess_ppm",
        "so2_excess_ppb",
        "fit_ppb",
        "residual_ppb",
        "north_m",
        "height_m",
        "so2_true_ppb",
    } <= set(samples)
    assert sorted(path.name for path in out.iterdir()) == [
        "estimate.json",
        "manifest.json",
        "samples.csv",
    ]


@BRIEFLY
def test_readings_that_no_channel_uses_are_said(logged, capsys):
    own = "[instrument.channels.so2]\ncross = { no = 0.015, no2 = -0.16 }\n[instrument.channels.co2]\n[instrument.channels.no2]\n"
    config = logged.parent / "own.toml"
    config.write_text(own, encoding="utf-8")
    assert (
        main(
            [
                str(logged),
                "--config",
                str(config),
                "--out",
                str(logged.parent / "out"),
                "--no-report",
            ]
        )
        == 0
    )
    printed = capsys.readouterr().out
    assert "NO is not used to correct SO2" in printed
    assert "add a table channels.no\n" in printed
    assert "NO2 is not used" not in printed
    assert run(logged) == 0
    assert "not used" not in capsys.readouterr().out


@BRIEFLY
def test_columns_units_and_places_are_mapped(logged, capsys):
    table = pd.read_csv(logged)
    renamed = pd.DataFrame({
        "Zeit": pd.Timestamp("2024-05-01T12:00:00Z") + pd.to_timedelta(table["time_s"], unit="s"),
        "SO2 [ppm]": table["so2_ppb"] / 1000.0,
        "CO2": table["co2_ppm"],
        "NO": table["no_ppb"],
        "NO2": table["no2_ppb"],
        "lat": 54.0 + np.degrees(table["north_m"] / EARTH_RADIUS_M),
        "lon": 8.0 + np.degrees(table["east_m"] / EARTH_RADIUS_M / np.cos(np.radians(54.0))),
    })  # fmt: skip
    other = logged.parent / "other.csv"
    renamed.to_csv(other, index=False)
    config = logged.parent / "other.toml"
    config.write_text(
        'instrument = "electrochemical"\n[columns]\ntime = "Zeit"\nso2 = "SO2 [ppm]"\nco2 = "CO2"\nno = "NO"\nno2 = "NO2"\n'
        'latitude = "lat"\nlongitude = "lon"\n[scale]\nso2 = 1000.0\n',
        encoding="utf-8",
    )
    assert run(logged) == 0
    expected = json.loads((logged.parent / "out" / "estimate.json").read_text(encoding="utf-8"))[
        "estimate"
    ]
    assert (
        main(
            [
                str(other),
                "--config",
                str(config),
                "--out",
                str(logged.parent / "mapped"),
                "--no-report",
            ]
        )
        == 0
    )
    found = json.loads((logged.parent / "mapped" / "estimate.json").read_text(encoding="utf-8"))[
        "estimate"
    ]
    assert found["fsc_percent"] == pytest.approx(expected["fsc_percent"], rel=1e-9)
    samples = pd.read_csv(logged.parent / "mapped" / "samples.csv")
    # A degree is kept to 1e-16 of itself and the file to six digits.
    for name in ("north_m", "east_m"):
        np.testing.assert_allclose(samples[name], table[name], rtol=0.0, atol=0.01, err_msg=name)
    capsys.readouterr()


@BRIEFLY
def test_an_instrument_of_ones_own_has_its_response_found(logged, capsys):
    (logged.parent / "instrument.toml").write_text(
        "limits_percent = [0.2]\n[instrument]\ntitle = 'Mine'\n[instrument.channels.so2]\ncross = { no = 0.015, no2 = -0.16 }\n"
        "[instrument.channels.co2]\nt90_s = 4.0\nnoise = 1.0\n[instrument.channels.no]\n[instrument.channels.no2]\n",
        encoding="utf-8",
    )
    assert run(logged) == 0
    assert "Mine" in capsys.readouterr().out
    record = json.loads((logged.parent / "out" / "estimate.json").read_text(encoding="utf-8"))
    assert [verdict["limit_percent"] for verdict in record["estimate"]["verdicts"]] == [0.2]
    assert record["other"] is None
    assert record["estimate"]["so2_t90_s"] == pytest.approx(20.0, abs=4.0)


def test_rows_may_end_in_a_comma(logged):
    config = LogConfig()
    expected = read_flight(logged, config)
    lines = logged.read_text(encoding="utf-8").splitlines()
    logged.write_text(
        "\n".join([lines[0], *(f"{line}," for line in lines[1:])]) + "\n", encoding="utf-8"
    )
    found = read_flight(logged, config)
    np.testing.assert_array_equal(found.readings.time, expected.readings.time)
    np.testing.assert_array_equal(found.readings.values, expected.readings.values)


def test_a_compressed_log_is_read(logged):
    compressed = logged.with_name("flight.csv.gz")
    pd.read_csv(logged).to_csv(compressed, index=False)
    np.testing.assert_array_equal(
        read_flight(compressed, LogConfig()).readings.values,
        read_flight(logged, LogConfig()).readings.values,
    )


@BRIEFLY
def test_seconds_since_1970_are_written_in_full(logged):
    table = pd.read_csv(logged)
    table["time_s"] += 1714560000.25
    table.to_csv(logged, index=False)
    assert run(logged) == 0
    written = pd.read_csv(logged.parent / "out" / "samples.csv")
    np.testing.assert_array_equal(written["time_s"], table["time_s"])


def test_a_latitude_beyond_the_pole_is_refused_with_its_row(logged, capsys):
    table = pd.read_csv(logged).drop(columns=["north_m", "east_m"])
    table["latitude_deg"], table["longitude_deg"] = 55.0, 11.0
    table.loc[3, "latitude_deg"] = 95.0
    table.to_csv(logged, index=False)
    assert run(logged) == 2
    told = capsys.readouterr().err
    # The head line is row 1.
    assert "flight.csv': latitude is 95 deg in row 5; it must be -90 to 90" in told
    assert told.count("\n") == 1


@pytest.mark.parametrize(
    ("config", "message"),
    [
        ("instrument = 'nose'", "instrument.toml': instrument is 'nose'; there are alphasense_a4"),
        ("instrument = 3", "instrument is 3; give the name of a preset"),
        (
            "instrument = 'laserr'",
            "instrument is 'laserr'; did you mean 'laser'? there are alphasense_a4",
        ),
        (
            "limit_percent = 0.1",
            "has the key 'limit_percent'; did you mean 'limits_percent'? it may have carbon",
        ),
        ("zone = 1", "has the key 'zone'; it may have carbon"),
        ("carbon = 'much'", "carbon is 'much'"),
        (
            "carbon = 87",
            "instrument.toml': carbon is 87; a fuel's mass share of carbon must be 0.5 to 0.95",
        ),
        (
            "limits_percent = [-1]",
            "instrument.toml': limits_percent is [-1]; give one or more numbers above 0, up to 10 % m/m",
        ),
        ("limits_percent = []", "limits_percent is []"),
        (
            "limits_percent = [0.5, 0.1, 0.1]",
            "limits_percent is [0.5, 0.1, 0.1]; give each limit once",
        ),
        (
            "[instrument.channels.so2]\ngain = 0.03",
            "instrument.toml': channel 'so2' of instrument 'instrument': gain of so2 is 0.03",
        ),
        (
            "[instrument.channels.so2]\nt90_s = -3",
            "instrument.toml': channel 'so2' of instrument 'instrument': t90 is -3 s",
        ),
        (
            "[instrument.channels.so2]\nt90 = 3",
            "has the key 't90'; did you mean 't90_s'? it may have",
        ),
        ("method = 'magic'", "method is 'magic'"),
        ("limits_percent = 0.1", "limits_percent is 0.1; give a list"),
        ("[columns]\nso3 = 'x'", "[columns] has the key 'so3'"),
        ("[columns]\nso2 = 3", "columns.so2 is 3; give a name"),
        (
            "[columns]\nso2 = 'co2_ppm'",
            "[columns] has the column 'co2_ppm' for so2 and for co2; name another one for either",
        ),
        ("[columns]\nso2 = 'SO2'", "has no SO2 column 'SO2', but 'time_s', 'so2_ppb'"),
        ("[columns]\ntime = 'when'", "has no time column 'when'"),
        ("[columns]\nno = 'NOx'", "has no NO column 'NOx'"),
        ("[columns]\nlongitude = 'lon'", "has no longitude column 'lon'"),
        ("[columns]\ntime = 'when'", 'correct time = "when" in [columns] of the configuration'),
        ("[scale]\nso2 = 0", "scale of so2 is 0; it must be positive"),
        ("[scale]\nco2 = 0.01", "flight.csv': CO2 has a median of 4"),
        ("missing = -9999", "missing is -9999; give a list of numbers, as in [-9999]"),
        ("[", "is not TOML"),
    ],
)
def test_configurations_with_mistakes_are_refused_in_one_line(logged, capsys, config, message):
    (logged.parent / "instrument.toml").write_text(config, encoding="utf-8")
    assert run(logged) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert message in told
    assert not (logged.parent / "out").exists()


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "is empty; it needs a head line and a row per reading"),
        ("time_s,so2_ppb\n1,2\n", "has no CO2 column 'co2_ppm', but 'time_s', 'so2_ppb'"),
        ("time_s,so2_ppb,co2_ppm\n", "has a head line and 0 readings; it needs a row per reading"),
        (
            "time_s,so2_ppb,so2_ppb ,co2_ppm\n1,2,2,420\n",
            "has the column 'so2_ppb' twice; rename or remove one of them",
        ),
        ("time_s,so2_ppb,co2_ppm\n1,2,420\n2,inf,420\n", "column 'so2_ppb' is infinite in row 3"),
        (
            "time_s,so2_ppb,co2_ppm\n1,two,420\n",
            "column 'so2_ppb' has 'two' in row 2; it must hold numbers",
        ),
        ("time_s,so2_ppb,co2_ppm\nsoon,2,420\n", "time 'soon' in column 'time_s' cannot be read"),
        (
            "time_s,so2_ppb,co2_ppm\n1,2,420\n",
            "flight.csv': the record has 1 samples; it needs at least 8",
        ),
        (
            "time_s,so2_ppb,co2_ppm\n" + "".join(f"{t},2,4\n" for t in range(99)),
            "CO2 has a median of 4 ppm",
        ),
        (
            "time_s,so2_ppb,co2_ppm\n" + "".join(f"{t},2,420,7\n" for t in range(9)),
            "more values than its head line has names",
        ),
        (
            "time_s,so2_ppb,co2_ppm\n" + "".join(f"{t},2,420\n" for t in (1, 2, 48, 39, 50)),
            "flight.csv': times do not increase: 48 s in row 4 is followed by 39 s; sort the rows by time and drop repeats",
        ),
        (
            "time_s;so2_ppb;co2_ppm\n1.0;2.0;420.0\n",
            "is separated by semicolons; separate its columns by commas, and write",
        ),
        (
            "time_s;so2_ppb;co2_ppm\n1,0;2,0;420,0\n",
            "is separated by semicolons; separate its columns by commas, and write",
        ),
        (
            "time_s\tso2_ppb\tco2_ppm\n1\t2\t420\n",
            "is separated by tabs; separate its columns by commas",
        ),
        (
            'time_s,so2_ppb,co2_ppm\n1,"2,5",420\n',
            "column 'so2_ppb' has '2,5' in row 2; it must hold numbers",
        ),
        ("\x00\x01\x02", "error: "),
    ],
)
def test_files_with_mistakes_are_refused_in_one_line(logged, capsys, content, message):
    logged.write_text(content, encoding="utf-8")
    assert run(logged) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert message in told
    assert told.count(str(logged)) <= 1


@BRIEFLY
def test_a_file_in_utf_16_is_to_be_saved_in_utf_8(logged, capsys):
    logged.write_text("time_s,so2_ppb,co2_ppm\n1,2,420\n", encoding="utf-16")
    assert run(logged) == 2
    assert (
        capsys.readouterr().err
        == f"error: '{logged}' is not text in UTF-8; save it as CSV in UTF-8\n"
    )


def test_co2_without_its_background_is_reported_as_that(logged, capsys):
    table = pd.read_csv(logged)
    table["co2_ppm"] -= 421.0
    table.to_csv(logged, index=False)
    assert table["co2_ppm"].min() < 0.0
    assert run(logged) == 2
    assert (
        "air has 250 to 50000 ppm: check the unit; keep the background" in capsys.readouterr().err
    )


def with_value(logged, column, row, value):
    table = pd.read_csv(logged)
    table.loc[row, column] = value
    table.to_csv(logged, index=False)


MISSING = pytest.mark.parametrize(
    ("column", "value", "told"),
    [
        ("so2_ppb", -9999.0, "SO2 is -9999 ppb in row 102; noise, zero and other gases explain -"),
        (
            "co2_ppm",
            -999.0,
            "CO2 is -999 ppm in row 102; air, noise, zero and other gases explain 2",
        ),
        ("no_ppb", -9999.0, "NO is -9999 ppb in row 102"),
    ],
)


@MISSING
@pytest.mark.parametrize("config", [True, False])
def test_a_code_for_a_missing_reading_is_refused(logged, capsys, column, value, told, config):
    with_value(logged, column, 100, value)
    assert run(logged, config=config) == 2
    error = capsys.readouterr().err
    assert told in error
    assert "leave it empty or name it in the configuration, as in missing = [-9999]" in error
    assert error.count("\n") == 1


@BRIEFLY
@MISSING
def test_a_code_for_a_missing_reading_that_is_named_is_an_empty_cell(logged, column, value, told):
    with_value(logged, column, 100, value)
    (logged.parent / "instrument.toml").write_text(
        f'instrument = "electrochemical"\nmissing = [{value}]\n', encoding="utf-8"
    )
    assert run(logged) == 0
    named = json.loads((logged.parent / "out" / "estimate.json").read_text(encoding="utf-8"))
    with_value(logged, column, 100, np.nan)
    assert run(logged) == 0
    assert (
        json.loads((logged.parent / "out" / "estimate.json").read_text(encoding="utf-8")) == named
    )
    assert named["estimate"]["quality"] != "C"


def test_readings_of_the_wrong_sign_that_no_noise_explains_are_refused(logged, capsys):
    table = pd.read_csv(logged)
    table["so2_ppb"] *= -3.0
    table.to_csv(logged, index=False)
    assert run(logged, config=False) == 2
    assert "more are as low; noise, zero and other gases explain" in capsys.readouterr().err


@BRIEFLY
def test_an_unfiltered_cell_may_read_below_zero_for_no2_that_is_not_measured(logged):
    # 1.6 of NO2: far below the noise, and what such a cell truly reads in a plume.
    readings, _ = flight("alphasense_b4", 0.1, 4)
    table = pd.DataFrame(
        {
            "time_s": readings.time,
            "so2_ppb": readings.values[:, 0],
            "co2_ppm": readings.values[:, 1],
        }
    )
    table.to_csv(logged, index=False)
    (logged.parent / "instrument.toml").write_text(
        'instrument = "alphasense_b4"\n', encoding="utf-8"
    )
    assert table["so2_ppb"].min() < -50.0
    assert run(logged) == 0


def test_files_that_are_not_there_are_refused(tmp_path, capsys):
    assert main([str(tmp_path / "none.csv"), "--no-report"]) == 2
    assert "cannot be read" in capsys.readouterr().err
    (tmp_path / "a.csv").write_text("time_s,so2_ppb,co2_ppm\n", encoding="utf-8")
    assert (
        main([str(tmp_path / "a.csv"), "--config", str(tmp_path / "none.toml"), "--no-report"]) == 2
    )
    assert "give a TOML file" in capsys.readouterr().err
