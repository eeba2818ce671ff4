"""Figures of flights that measured the fuel: how the method does, and what a trajectory is worth to
a sensor.
"""

import numpy as np
import pandas as pd

from measurement.gases import MASS_PERCENT
from reports.document.chart import Chart, Line, Panel, Style, between, upright
from reports.document.palette import Meaning, series_colour
from reports.document.panels import level
from reports.document.ship_map import SEEN_FROM, ship_panel
from reports.measurement.data import Record, measured_minutes, share_read
from reports.run.columns import Array, Mask, column
from reports.run.run_data import RunData
from reports.run.surroundings import Surroundings
from reports.run.time_history import about_the_plume

_METHODS = {"fsc": "regression", "areas_fsc": "areas"}
"""What the columns of each method begin with."""

_POINTS_MAX = 4000
"""Points of a track at most."""

_AXES = {
    "crossing_interval_mean_s": "Crossing interval [s]",
    "crossing_distance_mean_m": "Crossing distance [m]",
}

_BARS_MAX = 60
"""Flights of a sensor up to which their 95 % intervals are drawn as error bars."""

_WIDE = 10.0
"""Largest sulphur content over the smallest from which on axes are logarithmic; of a fuel without
any they are not.
"""

_EDGE, _ASIDE = 1.12, 0.05
"""Ordinate of results below the scale, over its lower limit; and how far flights of one fuel stand
aside, over its content.
"""

_FUELS_MIN, _OF_EACH_MIN = 3, 4
"""Fuels of an operating curve at least, and flights of each in the median: intervals of fewer fill
the panel.
"""


def error_chart(rows: pd.DataFrame) -> Chart:
    """Return the result of each flight against what a perfect instrument reads, by method."""
    panels: list[Panel] = []
    below = dict.fromkeys(_METHODS.values(), 0)
    expected = rows["fsc_expected_percent"]
    ends = np.array([0.8, 1.25]) * [float(expected.min()), float(expected.max())]
    wide = bool(ends[1] > _WIDE * ends[0] > 0.0)
    for prefix, title in _METHODS.items():
        lines, limits = [], _positive(rows, prefix) if wide else None
        for number, (sensor, group) in enumerate(rows.groupby("sensor")):
            shown, colour = (
                _side_by_side(column(group, "fsc_expected_percent")),
                series_colour(number),
            )
            found, low, high = (
                column(group, f"{prefix}_{end}percent") for end in ("", "low_", "high_")
            )
            # What lies below a logarithmic scale, as all that is not above 0, stands at its lower
            # edge.
            cut = found < limits[0] if limits else np.zeros(len(group), dtype=bool)
            found = np.where(cut, _EDGE * limits[0] if limits else found, found)
            error = (
                np.maximum([found - low, high - found], 0.0) if len(group) <= _BARS_MAX else None
            )
            parts: dict[Style, tuple[str, Mask]] = {
                "points": (str(sensor), ~cut),
                "diamonds": (f"{sensor}, below the scale", cut),
            }
            for style, (label, which) in parts.items():
                bars = None if error is None else error[:, which]
                if which.any():
                    lines.append(
                        Line(
                            x=shown[which],
                            y=found[which],
                            label=label,
                            colour=colour,
                            style=style,
                            error=bars,
                        )
                    )
            below[title] += int(np.count_nonzero(cut))
        lines.append(Line(x=ends, y=ends, label="perfect", colour="black", style="dash"))
        panels.append(
            Panel(
                x_label=f"A perfect instrument [{MASS_PERCENT}]",
                y_label=f"Measured [{MASS_PERCENT}]", title=title, lines=lines,
                log_x=wide, log_y=wide, y_range=limits,
            )
        )  # fmt: skip
    caption = "What flights measured over what a perfect instrument reads."
    if rows.duplicated(["sensor", "fsc_expected_percent"]).any():
        caption += " Flights of one sensor and fuel are drawn side by side."
    if any(below.values()):
        counted = ", ".join(f"{count} by {title}" for title, count in below.items() if count)
        caption += f" Diamonds at the lower edge: results below the scale, {counted}."
    return Chart(name="sulphur-errors", caption=caption, panels=panels, columns=2, panel_height=0.4)


def _positive(rows: pd.DataFrame, prefix: str) -> tuple[float, float]:
    expected, found = rows["fsc_expected_percent"], column(rows, f"{prefix}_percent")
    return 0.2 * float(expected.min()), 1.5 * max(
        float(expected.max()), *found[np.isfinite(found)].tolist(), 0.0
    )


def _side_by_side(expected: Array) -> Array:
    """Return abscissae of one sensor's flights, those of one fuel beside each other in the order of
    their numbers.
    """
    shown = expected.copy()
    for value in np.unique(expected):
        same = np.flatnonzero(expected == value)
        if len(same) > 1:
            shown[same] *= 1.0 + _ASIDE * np.linspace(-1.0, 1.0, len(same))
    return shown


def operating_curve(statistics: Record) -> Chart | None:
    """Return the share of ships called above the limit over their fuel's sulphur; none of few
    fuels, or of few flights of each.
    """
    entries = pd.DataFrame(statistics["operating_curve"])
    if (
        not len(entries)
        or entries["fsc_fuel_percent"].nunique() < _FUELS_MIN
        or entries["flights"].median() < _OF_EACH_MIN
    ):
        return None
    lines, limits = [], sorted(set(column(entries, "limit_percent").tolist()))
    for number, ((sensor, limit), group) in enumerate(entries.groupby(["sensor", "limit_percent"])):
        called = f"{sensor}, {limit:g} %" if len(limits) > 1 else str(sensor)
        fuel = column(group, "fsc_fuel_percent")
        bounds = np.array(group["above_interval"].tolist(), dtype=np.float64)
        lines += [
            between(fuel, bounds[:, 0], bounds[:, 1], "", series_colour(number), "solid"),
            Line(
                x=fuel,
                y=column(group, "above"),
                label=f"{called}, at the end",
                colour=series_colour(number),
            ),
            Line(
                x=fuel,
                y=column(group, "above_2min"),
                label=f"{called}, after 2 min",
                colour=series_colour(number),
                style="dot",
            ),
        ]
    fuels = column(entries, "fsc_fuel_percent")
    lines += [upright(limit, (0.0, 1.0), "limit") for limit in limits]
    lines.append(level(np.array([fuels.min(), fuels.max()]), 0.05, "5 %", "grey"))
    panel = Panel(
        x_label=f"Sulphur in the fuel [{MASS_PERCENT}]",
        y_label="Called above the limit [-]",
        lines=lines,
        log_x=bool(fuels.min() > 0.0),
        y_range=(0.0, 1.0),
    )
    caption = (
        "Operating curve: the share of ships that are called above the limit, with its intervals."
    )
    return Chart(name="operating-curve", caption=caption, panels=[panel], panel_height=0.4)


def trajectory_chart(run: RunData, rows: pd.DataFrame) -> Chart | None:
    """Return the error of a minute over crossing interval and distance, where these were varied on
    purpose; otherwise None.
    """
    if not {"guidance.bank_deg", "keepout.radius_m"} & set(map(str, run.draws)):
        return None
    interval, distance = "crossing_interval_mean_s", "crossing_distance_mean_m"
    kept = [
        "sensor",
        interval,
        distance,
        "fsc_expected_percent",
        *(f"{of}_percent" for of in _METHODS),
    ]
    noise = {
        of: column(rows, f"{of}_noise_percent") * np.sqrt(measured_minutes(run, rows))
        for of in _METHODS
    }
    rows = pd.concat([rows[kept], pd.DataFrame(noise, index=rows.index)], axis=1)
    minute = f"1σ in a minute [{MASS_PERCENT}]"
    panels = [
        *(
            _scattered(rows, interval, of, minute, f"Noise, {method}")
            for of, method in _METHODS.items()
        ),
        _scattered(rows, distance, "fsc", minute, "Noise over distance, regression"),
        _shares(rows, interval),
    ]
    caption = (
        "What a trajectory is worth to a sensor: the standard deviation by noise that a minute of"
        " crossings leaves, over their interval and their distance; and the share of the truth"
        " that each method reads."
    )
    return Chart(
        name="sulphur-trajectory", caption=caption, panels=panels, columns=2, panel_height=0.36
    )


def _scattered(rows: pd.DataFrame, x: str, y: str, y_label: str, title: str) -> Panel:
    lines = [
        Line(
            x=column(group, x),
            y=column(group, y),
            label=str(sensor),
            colour=series_colour(number),
            style="points",
        )
        for number, (sensor, group) in enumerate(rows.groupby("sensor"))
    ]
    return Panel(x_label=_AXES[x], y_label=y_label, title=title, lines=lines, log_y=True)


def _shares(rows: pd.DataFrame, x: str) -> Panel:
    """Return the share of the truth that each method reads."""
    styles: dict[str, Style] = {"fsc": "points", "areas_fsc": "diamonds"}
    lines = [
        Line(
            x=column(group, x),
            y=share_read(column(group, f"{of}_percent"), column(group, "fsc_expected_percent")),
            label=f"{sensor}, {method}",
            colour=series_colour(number),
            style=styles[of],
        )
        for number, (sensor, group) in enumerate(rows.groupby("sensor"))
        for of, method in _METHODS.items()
    ]
    return Panel(
        x_label=_AXES[x], y_label="Measured over true [-]", title="Share of the truth", lines=lines
    )


def sulphur_track_chart(history: pd.DataFrame, about: Surroundings) -> Chart:
    """Return the concentration along a flight by the colour of its track: seen from the ship, and
    in height over distance.

    Parameters
    ----------
    history : of the flight once it had settled
    about : what was about it
    """
    rows = history.iloc[:: max(1, -(-len(history) // _POINTS_MAX))]
    height, above, co2 = (column(rows, name) for name in ("altitude_m", "plume_above_m", "co2_ppm"))
    right, along = about_the_plume(rows)
    distance = np.hypot(right, along)
    crossed = np.flatnonzero(np.diff(np.signbit(right)))
    axis = Line(
        x=distance[crossed], y=(height - above)[crossed],
        label="plume's mean axis, where it was crossed", colour="orange",
        style="diamonds",
    )  # fmt: skip
    track = Line(x=right, y=along, label="", colour=Meaning.FLOWN, style="points", values=co2)
    panels = [
        ship_panel(about, [track], title="Seen from the ship", shown=[track]),
        Panel(
            x_label="Distance from the ship [m]",
            y_label="Height [m]",
            title="In height",
            lines=[
                Line(
                    x=distance, y=height, label="", colour=Meaning.FLOWN, style="points", values=co2
                ),
                axis,
            ],
        ),
    ]
    caption = (
        "The true CO2 concentration, as the colour of the track; in height with the plume's mean"
        f" axis where it was crossed. {SEEN_FROM}"
    )
    return Chart(
        name="sulphur-track",
        caption=caption,
        panels=panels,
        columns=2,
        panel_height=0.4,
        scale_label="CO2 [ppm]",
    )
