"""Logs whose rows are faster than their sensors' readings are those readings, each once."""

import json

import numpy as np
import pytest
from crossings import crossings, plain_sniffer, read
from logged_flights import flight_table, run

from measurement.estimate.estimator import estimate
from measurement.gases import GASES
from measurement.log.config import LogConfig
from measurement.log.read import new_readings, read_flight, rows_per_reading
from measurement.sniffer.sniffer import Readings
from measurement.sniffer.spec import sensor_preset

pytestmark = pytest.mark.slow

COLUMNS = ["so2_ppb", "co2_ppm", "no_ppb", "no2_ppb"]


@pytest.mark.parametrize(("rows", "between"), [(2, "empty"), (10, "repeated")])
def test_a_log_that_is_faster_than_its_sensors_has_the_estimate_of_their_readings(
    logged, capsys, rows, between
):
    # A row per second, each with the last reading in all of the faster ones.
    table = flight_table(rows=121).loc[np.repeat(np.arange(121), rows)]
    table = table.reset_index(drop=True).assign(time_s=np.arange(121 * rows) / rows)
    if between == "empty":
        table.loc[table.index % rows != 0, COLUMNS] = np.nan
    # Two readings of NO2 are missing, each once.
    table.loc[np.arange(70 * rows, 72 * rows), "no2_ppb"] = np.nan
    table.to_csv(logged, index=False)
    assert run(logged) == 0
    words = capsys.readouterr().out
    assert f"rows: {121 * rows:,}, of which 121 have a new reading" in words
    assert "missing readings: 2 of NO2 in 121 rows" in words
    found = json.loads((logged.parent / "out" / "estimate.json").read_text(encoding="utf-8"))
    assert found["gaps"]["gaps"] == [[69.0, 72.0]]
    plain = flight_table(rows=121)
    plain.loc[[70, 71], "no2_ppb"] = np.nan
    plain.to_csv(logged, index=False)
    readings = read_flight(logged, LogConfig()).readings
    expected = estimate(readings, sensor_preset("electrochemical")).record()
    # Readings and times are the same numbers.
    assert found["estimate"] == json.loads(json.dumps(expected))


@pytest.mark.parametrize("slow", ["so2", "co2"])
def test_the_slowest_gas_sets_the_readings_and_a_faster_one_has_those_of_their_times(slow):
    fast = read(plain_sniffer(so2_noise=2.5, co2_noise=1.0, rate_hz=10.0), crossings(0.25))
    logged, i = Readings(fast.time, fast.values.copy()), GASES.index(slow)
    logged.values[:, i] = np.repeat(fast.values[::10, i], 10)[: len(fast.time)]
    found = new_readings(logged, ("so2", "co2"))
    assert found.time == pytest.approx(fast.time[::10])
    assert found.values == pytest.approx(fast.values[::10], nan_ok=True)


def test_gases_that_are_read_between_each_other_are_interpolated_at_the_times_of_one():
    # CO2 is read half a second after SO2, and its rows hold it until the next reading.
    rows, generator = np.arange(400), np.random.default_rng(0)
    so2, co2 = generator.normal(size=(2, 41))
    values = np.full((400, 4), np.nan)
    values[:, 0], values[:, 1] = so2[rows // 10], co2[(rows + 5) // 10]
    found = new_readings(Readings(rows / 10.0, values), ("so2", "co2"))
    assert found.time == pytest.approx(np.arange(40.0))
    assert found.values[1:, 0] == pytest.approx(so2[1:40])
    assert found.values[1:, 1] == pytest.approx(0.5 * (co2[1:40] + co2[2:41]))


@pytest.mark.parametrize("rows", [2, 3.5, 10, 12.4, 50])
@pytest.mark.parametrize("step", [0.1, 10.0])
def test_rows_of_a_reading_are_counted_also_where_some_readings_are_equal(rows, step):
    values = np.round(10.0 * np.random.default_rng(0).normal(size=300) / step) * step
    column = values[np.floor(np.arange(int(rows * 300)) / rows).astype(int)]
    # Rows are whole: a reading of 3.5 has 3 or 4.
    assert rows_per_reading(column) == pytest.approx(rows, abs=0.1)


@pytest.mark.parametrize("sigma", [0.02, 0.1, 0.2, 0.3, 0.5, 1.0])
def test_noise_that_rounding_hides_is_no_log_that_repeats_readings(sigma):
    for seed in range(20):
        generator = np.random.default_rng(seed)
        column = np.round(generator.uniform() + sigma * generator.normal(size=1000))
        assert rows_per_reading(column) == 1.0


@pytest.mark.parametrize("step", [20.0, 100.0])
@pytest.mark.parametrize("gas", [0, 1])
def test_passes_at_even_times_in_coarse_steps_are_no_log_that_repeats_readings(gas, step):
    # Each pass takes the reading up a step and down again.
    air = crossings(0.25, meander=0.0, interval=10.0)
    readings = read(plain_sniffer(so2_noise=2.5, co2_noise=1.0), air).values[:, gas]
    assert rows_per_reading(np.round(readings / step) * step) == 1.0
