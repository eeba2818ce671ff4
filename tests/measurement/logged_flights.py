"""Logs of a flight behind a ship, and the command on them."""

import functools
from unittest import mock

import numpy as np
import pandas as pd
from crossings import flight

from measurement.log.analysis import analyse
from measurement.log.command import main


@functools.cache
def _readings():
    return flight("electrochemical", 0.3, 4, duration=300.0)[0]


def flight_table(rows=301, *, gases=False):
    """Return the log of a flight; with ``gases``, it has methane, black carbon and particles, and
    places in degrees.
    """
    readings = _readings()
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
    if gases:
        generator = np.random.default_rng(1)
        excess = table["co2_ppm"] - table["co2_ppm"].quantile(0.05)
        for name, level, slope, noise in (
            ("CH4 [ppm]", 1.95, 0.07, 0.004),
            ("BC [ug/m3]", 0.2, 0.12, 0.05),
            ("pn_cm3", 1500.0, 5800.0, 200.0),
        ):
            read = level + slope * excess + noise * generator.standard_normal(len(table))
            table[name] = read.round(6)
        table["latitude_deg"] = 56.0 + table.pop("north_m") / 111_195.0
        table["longitude_deg"] = 11.0 + table.pop("east_m") / 62_180.0
    return table.iloc[:rows]


def run(logged, *more, config=True, out=True):
    """Run the command without a report; over time it estimates after one minute alone."""
    with_config = ["--config", str(logged.parent / "instrument.toml")] if config else []
    to = ["--out", str(logged.parent / "out")] if out else []
    brief = functools.partial(analyse, points=0)
    with (
        mock.patch("measurement.log.command.analyse", brief),
        mock.patch("measurement.log.analysis.ELAPSED_S", (60.0,)),
    ):
        return main([str(logged), "--no-report", *to, *with_config, *more])
