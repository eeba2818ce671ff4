"""Logs with rows that no sensor and no receiver has written are refused, or read, with a line that names the rows."""

import pandas as pd
import pytest
from logged_flights import run


def with_values(logged, column, rows, value):
    table = pd.read_csv(logged)
    table.loc[rows, column] = value
    table.to_csv(logged, index=False)


@pytest.mark.parametrize(
    ("column", "rows", "value", "told"),
    [
        ("so2_ppb", [20], 50000.0, "SO2 is 50000 ppb in row 22; its sensor reads 20000 ppb at most (range_high)"),
        ("so2_ppb", [20, 30], 50000.0, "SO2 is 50000 ppb in row 22, and 1 more; its sensor reads 20000 ppb at most"),
        ("co2_ppm", [40], 6000.0, "CO2 is 6000 ppm in row 42; its sensor reads 5000 ppm at most"),
    ],
)
def test_a_reading_beyond_the_range_of_its_sensor_is_refused_with_its_row(logged, capsys, column, rows, value, told):
    with_values(logged, column, rows, value)
    assert run(logged) == 2
    error = capsys.readouterr().err
    assert told in error
    assert "leave such a cell empty" in error
    assert error.count("\n") == 1


@pytest.mark.usefixtures("briefly")
def test_a_reading_at_the_end_of_the_range_is_saturated(logged, capsys):
    with_values(logged, "so2_ppb", [20], 20000.0)
    assert run(logged) == 0
    assert "SO2 is saturated at 20000 ppb" in capsys.readouterr().out
