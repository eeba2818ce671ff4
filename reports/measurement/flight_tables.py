"""Tables of flights that measured the fuel: their results, and how the method does."""

from typing import Any

import pandas as pd

from common.intervals import percent
from measurement.gases import MASS_PERCENT
from reports.document.blocks import Table
from reports.document.tables import number
from reports.measurement.data import METHODS, Record, measured_minutes, share_read
from reports.run.run_data import RunData
from reports.run.trials import Name

_BEST = 3
"""Trajectories that are listed for each sensor."""


def interval_words(row: "pd.Series[Any]") -> str:
    """Return the ends of the 95 % interval of a flight's sulphur content [% m/m]."""
    return (
        f"{number(row['fsc_low_percent'], '{:.3f}')} to {number(row['fsc_high_percent'], '{:.3f}')}"
    )


def flight_table(rows: pd.DataFrame, name: Name) -> Table:
    """Return a row per flight: result, uncertainty, verdict."""
    return Table(
        caption="The flights, a row each: result, uncertainty and verdict.",
        head=[
            "Flight",
            "Sensor",
            f"Fuel [{MASS_PERCENT}]",
            f"Perfect [{MASS_PERCENT}]",
            f"Measured [{MASS_PERCENT}]",
            f"95 % interval [{MASS_PERCENT}]",
            "Quality",
            "P(above)",
            "Verdict",
        ],
        rows=[
            [
                name(row),
                str(row["sensor"]),
                number(row["fsc_fuel_percent"], "{:.3f}"),
                number(row["fsc_expected_percent"], "{:.3f}"),
                number(row["fsc_percent"], "{:.3f}"),
                interval_words(row),
                str(row["sulphur_quality"]),
                number(row["probability_above"], "{:.3f}"),
                str(row["sulphur_verdict"]),
            ]
            for _, row in rows.iterrows()
        ],
        widths=[2.2, 1.3, 0.8, 0.9, 1.0, 1.5, 0.7, 0.8, 0.8],
        left_columns=2,
        breakable=True,
    )


def accuracy_table(statistics: Record) -> Table:
    """Return bias, spread and coverage by sensor and method."""
    rows = [entry for entry in statistics["accuracy"] if entry["fsc_fuel_percent"] is None]
    return Table(caption="Bias, spread and coverage, by sensor and method.",
        head=[
            "Sensor", "Method", "Flights", f"Bias [{MASS_PERCENT}]", "Share read", "Predicted",
            f"Spread, 1σ [{MASS_PERCENT}]",
            f"Stated, 1σ [{MASS_PERCENT}]", f"Of it noise [{MASS_PERCENT}]", "Covered",
            f"Interval at {percent(statistics['confidence'])}",
        ],
        rows=[
            [
                entry["sensor"],
                METHODS[entry["method"]],
                f"{entry['flights']:,}",
                number(entry["bias_percent"], "{:+.4f}"),
                *("–" if share is None else percent(share) for share in (entry["share_read"],
                entry["share_predicted"])),
                number(entry["spread_percent"], "{:.4f}"),
                number(entry["stated_percent"], "{:.4f}"),
                number(entry["stated_noise_percent"], "{:.4f}"),
                percent(entry["coverage"]),
                " to ".join(percent(bound) for bound in entry["coverage_interval"]),
            ]
            for entry in rows
        ],
        widths=[1.6, 2.1, 0.7, 1.0, 0.92, 1.1, 1.0, 1.0, 1.0, 0.95, 1.7],
        left_columns=2,
    )  # fmt: skip


def calls_table(statistics: Record) -> Table:
    """Return how often ships of each fuel were called above the limit."""
    return Table(
        caption="How often ships of each fuel were called above the limit.",
        head=[
            "Sensor",
            f"Fuel [{MASS_PERCENT}]",
            f"Limit [{MASS_PERCENT}]",
            "Flights",
            "Called above",
            "Interval",
            "Above after 2 min",
            "Open at the end",
        ],
        rows=[
            [
                entry["sensor"],
                f"{entry['fsc_fuel_percent']:g}",
                f"{entry['limit_percent']:g}",
                f"{entry['flights']:,}",
                percent(entry["above"]),
                " to ".join(percent(bound) for bound in entry["above_interval"]),
                percent(entry["above_2min"]),
                percent(entry["open"]),
            ]
            for entry in statistics["operating_curve"]
        ],
        widths=[1.4, 0.8, 0.8, 0.7, 1.0, 1.5, 1.2, 1.0],
        breakable=True,
    )


def hit_table(rows: pd.DataFrame) -> Table:
    """Return figures of the passes: over all flights, median and the tenth that is worst on either
    side.
    """
    named = {
        "plume_axis_crossings": (
            "Crossings of the plume's mean axis, with smoke or without",
            "{:.0f}",
        ),
        "smoke_passes": ("Of these with smoke", "{:.0f}"),
        "hit_rate": ("Share of these that hit the plume, peak above 0.6 of its axis [-]", "{:.2f}"),
        "axis_height_error_rms_m": ("Height off the plume's axis, rms [m]", "{:.1f}"),
        "seconds_in_plume_s": ("Time in the plume [s]", "{:.0f}"),
        "dose_per_pass_ppm_s": ("CO2 dose of a pass [ppm s]", "{:.0f}"),
        "co2_signal_to_noise": ("CO2 signal to noise [-]", "{:.0f}"),
        "verdict_time_s": ("Time to a verdict, of flights that reached one [s]", "{:.0f}"),
    }
    return Table(
        head=["Figure", "Lowest tenth", "Median", "Highest tenth", "Flights"],
        rows=[
            [
                title,
                *(number(rows[name].quantile(q), pattern) for q in (0.1, 0.5, 0.9)),
                f"{rows[name].notna().sum():,}",
            ]
            for name, (title, pattern) in named.items()
            if name in rows
        ],
        widths=[3.0, 1.0, 1.0, 1.0, 0.8],
    )


def best_table(run: RunData, rows: pd.DataFrame) -> Table:
    """Return the trajectories that leave the least noise after a minute, for each sensor, and what
    each method reads on them.
    """
    noise = (rows["fsc_noise_percent"] * measured_minutes(run, rows) ** 0.5).rename("minute")
    ranked = pd.concat([rows, noise], axis=1).sort_values("minute")
    best = pd.concat([group.head(_BEST) for _, group in ranked.groupby("sensor")])
    return Table(
        caption=(
            "Trajectories that leave the least noise after a minute, by sensor, and what each"
            " method reads on them."
        ),
        head=[
            "Sensor",
            "ν",
            "Interval [s]",
            "Distance [m]",
            f"1σ in a minute [{MASS_PERCENT}]",
            "Regression reads",
            "Areas read",
        ],
        rows=[
            [
                str(row["sensor"]),
                number(row["nu"], "{:.2f}"),
                number(row["crossing_interval_mean_s"], "{:.1f}"),
                number(row["crossing_distance_mean_m"], "{:.0f}"),
                number(row["minute"], "{:.4f}"),
                number(share_read(row["fsc_percent"], row["fsc_expected_percent"]), "{:.2f}"),
                number(share_read(row["areas_fsc_percent"], row["fsc_expected_percent"]), "{:.2f}"),
            ]
            for _, row in best.iterrows()
        ],
        widths=[1.6, 0.6, 0.9, 0.9, 1.3, 1.1, 0.9],
    )
