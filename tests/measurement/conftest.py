"""A logged flight for the tests of the command."""

import functools

import numpy as np
import pandas as pd
import pytest
from crossings import flight

from measurement.log.analysis import analyse


@pytest.fixture
def logged(tmp_path):
    readings, _ = flight("electrochemical", 0.3, 4)
    table = pd.DataFrame(
        {
            "time_s": readings.time,
            "so2_ppb": readings.values[:, 0],
            "co2_ppm": readings.values[:, 1],
            "no_ppb": readings.values[:, 2],
            "no2_ppb": readings.values[:, 3],
            "north_m": 6.0 * readings.time,
            "east_m": 50.0 * np.sin(0.33 * readings.time),
            "height_m": 60.0,
            "so2_true_ppb": 1.0,
        }
    )
    path = tmp_path / "flight.csv"
    table.to_csv(path, index=False)
    (tmp_path / "instrument.toml").write_text('instrument = "electrochemical"\n', encoding="utf-8")
    return path


@pytest.fixture
def briefly(monkeypatch):
    """Have the command estimate after one, two and five minutes, and not at fifteen times more for
    a curve: it takes a quarter.
    """
    monkeypatch.setattr("measurement.log.command.analyse", functools.partial(analyse, points=0))
