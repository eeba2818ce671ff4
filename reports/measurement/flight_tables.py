"""Tables of flights that measured the fuel: their results, and how the method does."""

from collections.abc import Mapping
from typing import Any

import pandas as pd

from common.intervals import percent
from measurement.gases import MASS_PERCENT
from reports.document.blocks import Table
from reports.document.tables import Cell, number, rows_table
from reports.measurement.data import METHODS, Record
from reports.run.trials import Name

_SENSOR = Cell("Sensor", "sensor", width=1.4)


def interval_words(row: "pd.Series[Any]") -> str:
    """Return the ends of the 95 % interval of a flight's sulphur content [% m/m]."""
    ends = (row["fsc_low_percent"], row["fsc_high_percent"])
    return " to ".join(number(end, "{:.3f}") for end in ends)


def flight_table(rows: pd.DataFrame, name: Name) -> Table:
    """Return a row per flight: result, uncertainty, verdict."""
    cells = [
        Cell("Flight", name, width=2.2),
        _SENSOR,
        Cell(f"Fuel [{MASS_PERCENT}]", "fsc_fuel_percent", "{:.3f}", 0.8),
        Cell(f"Perfect [{MASS_PERCENT}]", "fsc_expected_percent", "{:.3f}", 0.9),
        Cell(f"Measured [{MASS_PERCENT}]", "fsc_percent", "{:.3f}"),
        Cell(f"95 % interval [{MASS_PERCENT}]", interval_words, width=1.5),
        Cell("Quality", "sulphur_quality", width=0.7),
        Cell("P(above)", "probability_above", "{:.3f}", 0.8),
        Cell("Verdict", "sulphur_verdict", width=0.8),
    ]
    return rows_table(
        (row for _, row in rows.iterrows()),
        cells,
        caption="The flights, a row each: result, uncertainty and verdict.",
        left_columns=2,
        breakable=True,
    )


def _share(key: str) -> Any:
    """Return what writes a share in per cent; a dash where there is none."""

    def cell(entry: Mapping[str, Any]) -> str:
        return "–" if entry[key] is None else percent(entry[key])

    return cell


def _interval(key: str) -> Any:
    return lambda entry: " to ".join(percent(bound) for bound in entry[key])


def accuracy_table(statistics: Record) -> Table:
    """Return bias, spread and coverage by sensor and method."""
    cells = [
        Cell("Sensor", "sensor", width=1.6),
        Cell("Method", lambda entry: METHODS[entry["method"]], width=2.1),
        Cell("Flights", "flights", "{:,.0f}", 0.7),
        Cell(f"Bias [{MASS_PERCENT}]", "bias_percent", "{:+.4f}"),
        Cell("Share read", _share("share_read"), width=0.92),
        Cell("Predicted", _share("share_predicted"), width=1.1),
        Cell(f"Spread, 1σ [{MASS_PERCENT}]", "spread_percent", "{:.4f}"),
        Cell(f"Stated, 1σ [{MASS_PERCENT}]", "stated_percent", "{:.4f}"),
        Cell(f"Of it noise [{MASS_PERCENT}]", "stated_noise_percent", "{:.4f}"),
        Cell("Covered", _share("coverage"), width=0.95),
        Cell(
            f"Interval at {percent(statistics['confidence'])}",
            _interval("coverage_interval"),
            width=1.7,
        ),
    ]
    return rows_table(
        [entry for entry in statistics["accuracy"] if entry["fsc_fuel_percent"] is None],
        cells,
        caption="Bias, spread and coverage, by sensor and method.",
        left_columns=2,
    )


def calls_table(statistics: Record) -> Table:
    """Return how often ships of each fuel were called above the limit."""
    cells = [
        _SENSOR,
        Cell(f"Fuel [{MASS_PERCENT}]", "fsc_fuel_percent", "{:g}", 0.8),
        Cell(f"Limit [{MASS_PERCENT}]", "limit_percent", "{:g}", 0.8),
        Cell("Flights", "flights", "{:,.0f}", 0.7),
        Cell("Called above", _share("above")),
        Cell("Interval", _interval("above_interval"), width=1.5),
        Cell("Above after 2 min", _share("above_2min"), width=1.2),
        Cell("Open at the end", _share("open")),
    ]
    return rows_table(
        statistics["operating_curve"],
        cells,
        caption="How often ships of each fuel were called above the limit.",
        breakable=True,
    )


_HITS = {
    "plume_axis_crossings": ("Crossings of the plume's mean axis, with smoke or without", "{:.0f}"),
    "smoke_passes": ("Of these with smoke", "{:.0f}"),
    "hit_rate": ("Share of these that hit the plume, peak above 0.6 of its axis [-]", "{:.2f}"),
    "axis_height_error_rms_m": ("Height off the plume's axis, rms [m]", "{:.1f}"),
    "seconds_in_plume_s": ("Time in the plume [s]", "{:.0f}"),
    "dose_per_pass_ppm_s": ("CO2 dose of a pass [ppm s]", "{:.0f}"),
    "co2_signal_to_noise": ("CO2 signal to noise [-]", "{:.0f}"),
    "verdict_time_s": ("Time to a verdict, of flights that reached one [s]", "{:.0f}"),
}
"""Figures of passes by their columns: title and pattern."""


def hit_table(rows: pd.DataFrame) -> Table:
    """Return figures of the passes: over all flights, median and the tenth that is worst on either
    side.
    """

    def quantile(share: float) -> Any:
        return lambda name: number(rows[name].quantile(share), _HITS[name][1])

    cells = [
        Cell("Figure", lambda name: _HITS[name][0], width=3.0),
        Cell("Lowest tenth", quantile(0.1)),
        Cell("Median", quantile(0.5)),
        Cell("Highest tenth", quantile(0.9)),
        Cell("Flights", lambda name: rows[name].notna().sum(), "{:,.0f}", 0.8),
    ]
    return rows_table([name for name in _HITS if name in rows], cells)
