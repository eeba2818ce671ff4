"""Figures of a measured fuel sulphur content: of a table of samples and of an estimate's record,
wherever they come from.
"""

import numpy as np
import pandas as pd

from measurement.gases import ASSUMED_LEAST, CARBON_FRACTION, MASS_PERCENT, fsc_factor, limit_words
from reports.document.axes import in_kilometres
from reports.document.chart import Chart, Line, Note, Panel, between
from reports.document.palette import Meaning
from reports.document.panels import around, level
from reports.document.ship_map import on_map
from reports.measurement.data import (
    SINCE,
    Record,
    after_gap,
    errors,
    finite,
    in_parts,
    over_time,
    value,
)
from reports.run.columns import Array, column
from reports.run.time_history import thinned

POINTS_MAX = 2500
"""Samples of a figure at most."""

_TIME, _FSC = "Time [s]", f"Fuel sulphur content [{MASS_PERCENT}]"


_ABOVE = 0.06
"""Height of a limit's word above its line, over that of the panel."""

_BAR = 0.72
"""Height of a bar, over the distance between two."""

_ALL = "all together"
_BARS = {_ALL: (_ALL, "black"), "noise": ("noise: falls with further passes", "orange")}
"""Label and colour of bars that are no common error's."""

_ASPECT = 1.8
"""Width of a track's plan over its height."""

_LONG = 4.0
"""Ratio of length to width of a track from which on its plan is not drawn to one scale."""


def over_time_chart(record: Record, since: str = SINCE) -> Chart | None:
    """Return the sulphur content and its 95 % interval over time, with the limits; None where there
    never was an estimate.

    Parameters
    ----------
    record : of the estimate
    since : what the time is counted from, in words that go on "since"
    """
    table = over_time(record)
    if len(table) < 2:
        return None
    time, low, high, found = (
        column(table, name) for name in ("elapsed_s", "low_percent", "high_percent", "fsc_percent")
    )
    limits = [float(verdict["limit_percent"]) for verdict in record["estimate"]["verdicts"]]
    lines = [
        between(time, low, high, "95 % interval", Meaning.FLOWN),
        Line(x=time, y=found, label="estimate", colour=Meaning.FLOWN),
    ]
    top = 1.25 * max(
        float(np.max(found)),
        float(high[-1]),
        *(limit for limit in limits if limit < 2.0 * float(high[-1])),
    )
    shown = [limit for limit in limits if limit < top]
    lines += [level(time, limit, "limit", Meaning.LIMIT) for limit in shown]
    # The legend would have the same dashes for each.
    notes = [
        Note(
            x=float(time[-1]),
            y=limit + (_ABOVE if limit < 0.9 * top else -_ABOVE) * top,
            text=f"limit {limit_words(limit)} ",
            align="right",
        )
        for limit in shown
    ]
    if record.get("true_percent") is not None:
        lines.append(level(time, value(record, "true_percent"), "a perfect instrument", "black"))
    # An estimate may be below 0, though its interval is cut there.
    y_range = (1.25 * min(0.0, float(np.min(found))), top)
    panel = Panel(
        x_label=f"Time since {since} [s]",
        y_label=_FSC,
        lines=lines,
        notes=notes,
        y_range=y_range,
        x_range=(0.0, float(time[-1])),
    )
    caption = "Fuel sulphur content from all readings up to a time, with its 95 % interval."
    return Chart(name="fsc-over-time", caption=caption, panels=[panel], panel_height=0.21)


def budget_chart(record: Record) -> Chart | None:
    """Return the parts of the standard uncertainty as bars; None where there are none."""
    parts = errors(record)
    if not parts:
        return None
    parts = [*parts, (_ALL, value(record["estimate"], "total_percent"))]
    lines, notes = [], []
    for i, (name, size) in enumerate(parts):
        row = float(len(parts) - 1 - i)
        edges = np.array([-1.0, -1.0, 1.0, 1.0, -1.0]) * 0.5 * _BAR + row
        label, colour = _BARS.get(name, ("common errors: do not fall", "blue"))
        lines.append(
            Line(
                x=np.array([0.0, size, size, 0.0, 0.0]),
                y=edges,
                label=label,
                colour=colour,
                fill=True,
            )
        )
        notes.append(Note(x=size, y=row, text=f"  {size:.4f}", align="left"))
    widest = max(size for _, size in parts)
    panel = Panel(
        x_label=f"Standard uncertainty [{MASS_PERCENT}]",
        y_label="Part",
        lines=lines,
        notes=notes,
        x_range=(0.0, 1.18 * widest),
        y_range=(-0.6, len(parts) - 0.4),
        y_names=[(float(len(parts) - 1 - i), name) for i, (name, _) in enumerate(parts)],
    )
    return Chart(
        name="budget",
        caption="Parts of the standard uncertainty, 1σ; they add in squares.",
        panels=[panel],
        panel_height=0.26,
    )


def channels_chart(samples: pd.DataFrame, x_label: str = _TIME) -> Chart:
    """Return readings over time, with the truth where it is known, and SO2 at the common response
    with what CO2 explains of it.
    """
    rows = in_parts(thinned(samples, POINTS_MAX))
    time = column(rows, "time_s")
    panels = [
        Panel(x_label=x_label, y_label=f"{name} [{unit}]", lines=_readings(rows, time, gas, unit))
        for gas, name, unit in (("co2", "CO2", "ppm"), ("so2", "SO2", "ppb"))
    ]
    nox = [
        Line(x=time, y=column(rows, f"{gas}_ppb"), label=label, colour=colour)
        for gas, label, colour in (("no", "NO", "green"), ("no2", "NO2", "plum"))
        if f"{gas}_ppb" in rows
    ]
    if nox:
        panels.append(Panel(x_label=x_label, y_label="NOx [ppb]", lines=nox))
    equal = [
        Line(
            x=time,
            y=column(rows, "so2_excess_ppb"),
            label="SO2, corrected and equalised",
            colour="orange",
        ),
        Line(x=time, y=column(rows, "fit_ppb"), label="what CO2 explains", colour="black"),
    ]
    panels.append(Panel(x_label=x_label, y_label="ΔSO2 [ppb]", lines=equal))
    caption = (
        "Readings. ΔSO2, above the background. Orange: SO2, corrected and smoothed to the slowest"
        " sensor; black: CO2, smoothed alike, times the slope."
    )
    if not np.isfinite(column(rows, "co2_ppm")).all():
        caption += (
            " Lines end where the log has no readings, and where a channel of another delay has"
            " none yet or no more."
        )
    return Chart(
        name="channels", caption=caption, panels=panels, columns=2, share_x=True, panel_height=0.125
    )


def _readings(rows: pd.DataFrame, time: Array, gas: str, unit: str) -> list[Line]:
    lines = [Line(x=time, y=column(rows, f"{gas}_{unit}"), label="reading", colour="blue")]
    true = column(rows, f"{gas}_true_{unit}")
    return [Line(x=time, y=true, label="truth", colour="grey"), *lines] if finite(true) else lines


def regression_chart(samples: pd.DataFrame, record: Record) -> Chart | None:
    """Return SO2 over CO2 at one response, with the slope, and the sulphur content of groups of
    passes.
    """
    found = _by_regression(record)
    # A sample that is interpolated has no reading, and is no evidence.
    rows = thinned(samples[np.isfinite(column(samples, "co2_ppm"))], POINTS_MAX)
    co2, so2 = column(rows, "co2_excess_ppm"), column(rows, "so2_excess_ppb")
    slope = value(found, "slope_ppb_per_ppm")
    if not finite(co2, so2) or not np.isfinite(slope):
        return None
    ends = np.array([float(np.nanmin(co2)), float(np.nanmax(co2))])
    # The line goes through the mean of both.
    middle_co2, middle_so2 = (
        float(np.nanmean(column(samples, name))) for name in ("co2_excess_ppm", "so2_excess_ppb")
    )
    scatter = Panel(
        x_label="CO2 excess [ppm]",
        y_label="SO2 excess [ppb]",
        title="Samples at one response",
        lines=[
            Line(x=co2, y=so2, label="sample", colour="blue", style="points"),
            Line(
                x=ends,
                y=middle_so2 + slope * (ends - middle_co2),
                label=f"slope {slope:.3f} ppb/ppm",
                colour="black",
            ),
        ],
    )
    panels = [scatter, *_groups(record)]
    factor = fsc_factor(float(record.get("carbon") or CARBON_FRACTION))
    assumed = value(found, "assumed_percent")
    corrected = (
        f", and {assumed:+.3f} % for NO and NO2 that the log does not have"
        if abs(assumed) >= ASSUMED_LEAST
        else ""
    )
    caption = (
        "SO2 over CO2 without background, at the response of the slowest channel; the sulphur"
        f" content by regression is {factor:.4f} times the slope{corrected}."
        + " Groups of passes: neighbouring ones together, with their noise, 1σ."
        * (len(panels) > 1)
    )
    return Chart(
        name="regression", caption=caption, panels=panels, columns=len(panels), panel_height=0.21
    )


def _by_regression(record: Record) -> Record:
    """Return the estimate by regression, also where the result is by areas."""
    found: list[Record] = [record["estimate"], record.get("other") or {}]
    return next((of for of in found if of.get("method") == "regression"), found[0])


def _groups(record: Record) -> list[Panel]:
    found = _by_regression(record)
    percent, deviation = (
        np.array(found.get(name) or [], dtype=np.float64)
        for name in ("pass_percent", "pass_deviation_percent")
    )
    if len(percent) < 2:
        return []
    number = np.arange(1.0, len(percent) + 1.0)
    lines = [
        Line(
            x=number,
            y=percent,
            label="group of passes",
            colour="blue",
            style="points",
            error=deviation,
        ),
        level(number, value(found, "fsc_percent"), "all passes", "black"),
    ]
    return [
        Panel(
            x_label="Group of passes",
            y_label=_FSC,
            title="Groups of passes",
            lines=lines,
            x_range=around(number),
            x_whole=True,
        )
    ]


def logged_track_chart(samples: pd.DataFrame) -> Chart | None:
    """Return the CO2 reading along the track in plan, and in height over distance; None where the
    place is not known.
    """
    rows = _dense(samples)
    north, east, height, co2 = (
        column(rows, name) for name in ("north_m", "east_m", "height_m", "co2_ppm")
    )
    panels = []
    if finite(north, east):
        lines = _coloured(east, north, co2)
        sides = sorted(
            (float(np.nanmax(north) - np.nanmin(north)), float(np.nanmax(east) - np.nanmin(east)))
        )
        plan = Panel(x_label="East [m]", y_label="North [m]", title="In plan", lines=lines)
        # A long and narrow track is not drawn to one scale, and is no map.
        panels.append(
            in_kilometres(
                on_map(plan, north=0.0, aspect=_ASPECT) if sides[1] < _LONG * sides[0] else plan
            )
        )
        distance = np.concatenate([[0.0], np.nancumsum(np.hypot(np.diff(north), np.diff(east)))])
        if finite(height):
            lines = _coloured(distance, height, co2)
            panels.append(
                in_kilometres(
                    Panel(
                        x_label="Distance flown [m]",
                        y_label="Height [m]",
                        title="In height",
                        lines=lines,
                    )
                )
            )
    if not panels:
        return None
    caption = (
        "CO2 reading by the colour of the track. The reading is late by the delay and the"
        " response of its channel."
    )
    if len(rows) < POINTS_MAX:
        caption += " Where the log has no readings, no track is drawn."
    return Chart(
        name="track",
        caption=caption,
        panels=panels,
        columns=len(panels),
        panel_height=0.22,
        scale_label="CO2 [ppm]",
    )


def _dense(samples: pd.DataFrame) -> pd.DataFrame:
    """Return ``POINTS_MAX`` rows between the samples, by which a track is a line, and not the dots
    of a stroboscope.

    There is no row in a gap of the log.
    """
    time = column(samples, "time_s")
    places = np.linspace(float(time[0]), float(time[-1]), POINTS_MAX)
    read = ~after_gap(samples)[np.searchsorted(time, places)]
    rows = {str(name): np.interp(places, time, column(samples, str(name))) for name in samples}
    return pd.DataFrame(rows).loc[read & np.isfinite(rows["co2_ppm"])]


def _coloured(x: Array, y: Array, co2: Array) -> list[Line]:
    """Return a track with the reading by its colour."""
    return [Line(x=x, y=y, label="", colour="blue", style="points", values=co2)]
