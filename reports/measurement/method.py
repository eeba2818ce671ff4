"""What many flights with a sniffer show of the method: verdicts right, wrong and open, the relative
error of each instrument, and how often the stated interval holds the truth.
"""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import pandas as pd

from common.intervals import CONFIDENCE, clopper_pearson, percent
from measurement.estimate.verdict import ABOVE, OPEN
from measurement.gases import MASS_PERCENT, limit_words
from reports.document.blocks import Block, Card, Heading, Table, Text, UndecidedCard
from reports.document.chart import Chart, Line, Panel, Style, between, upright
from reports.document.palette import Meaning, series_colour
from reports.document.panels import level
from reports.document.ship_map import SEEN_FROM, ship_panel
from reports.document.tables import Cell, number, rows_table
from reports.measurement.data import METHODS, Record, measured_minutes, share_read
from reports.run.columns import Array, Mask, column, flights_flown
from reports.run.run_data import RunData
from reports.run.surroundings import Surroundings
from reports.run.time_history import about_the_plume
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
"""Ratio of the largest sulphur content to the smallest from which on axes are logarithmic; they are
not where a fuel has no sulphur.
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
        for i, (sensor, group) in enumerate(rows.groupby("sensor")):
            shown, colour = (
                _side_by_side(column(group, "fsc_expected_percent")),
                series_colour(i),
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
    for i, ((sensor, limit), group) in enumerate(entries.groupby(["sensor", "limit_percent"])):
        called = f"{sensor}, {limit:g} %" if len(limits) > 1 else str(sensor)
        fuel = column(group, "fsc_fuel_percent")
        bounds = np.array(group["above_interval"].tolist(), dtype=np.float64)
        lines += [
            between(fuel, bounds[:, 0], bounds[:, 1], "", series_colour(i), "solid"),
            Line(
                x=fuel,
                y=column(group, "above"),
                label=f"{called}, at the end",
                colour=series_colour(i),
            ),
            Line(
                x=fuel,
                y=column(group, "above_2min"),
                label=f"{called}, after 2 min",
                colour=series_colour(i),
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
            colour=series_colour(i),
            style="points",
        )
        for i, (sensor, group) in enumerate(rows.groupby("sensor"))
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
            colour=series_colour(i),
            style=styles[of],
        )
        for i, (sensor, group) in enumerate(rows.groupby("sensor"))
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


_FEW = 8
"""Flights below which there are no statistics."""

_VERDICTS = (
    "Verdicts on the sulphur limit from {flights:,} flights: {right:,} right, {wrong:,} wrong,"
    " {open:,} open, {without:,} without a result"
)

_COMPARED = (
    "Each result is compared with what a perfect instrument would read. That is less than the fuel"
    " holds, because some sulphur leaves as sulphate. Share read: mean result / mean truth."
    " Predicted: by the closed form of passes that overlap in the slow channel. Covered: share of"
    " intervals that contain the truth."
)


def measured_flights(run: RunData) -> pd.DataFrame:
    """Return the rows of the flights that have a result."""
    rows = run.summary
    return rows[rows["fsc_percent"].notna()] if "fsc_percent" in rows else rows.iloc[:0]


def is_of_the_method(run: RunData) -> bool:
    """Return whether a run shows the method: several of its flights have a result."""
    return len(measured_flights(run)) > 1


def method_headline(run: RunData) -> str:
    """Return how many verdicts were right, wrong and open."""
    return _VERDICTS.format(**sulphur_verdicts(run))


def sulphur_verdicts(run: RunData) -> dict[str, int]:
    """Return the numbers of flights whose verdict on the fuel is ``right``, ``wrong`` or ``open``,
    of those ``without`` a result, and of all with a sniffer (``flights``).
    """
    rows = measured_flights(run)
    right, wrong, is_open = _verdicts(rows)
    sniffed = len(flights_flown(run.summary))
    return {
        "flights": sniffed,
        "right": int(right.sum()),
        "wrong": int(wrong.sum()),
        "open": int(is_open.sum()),
        "without": sniffed - len(rows),
    }


def _verdicts(rows: pd.DataFrame) -> tuple[Mask, Mask, Mask]:
    """Return which verdicts are right, wrong and open; a fuel at the limit is not above it."""
    called = rows["sulphur_verdict"].to_numpy()
    fuel, limit = (column(rows, name) for name in ("fsc_fuel_percent", "sulphur_limit_percent"))
    is_open = called == OPEN
    right = ~is_open & ((called == ABOVE) == (fuel > limit))
    return right, ~is_open & ~right, is_open


def method_cards(run: RunData) -> list[Card]:
    """Return how many verdicts were wrong and open, the relative error of each instrument with the
    flight that has the largest, and how many intervals hold the truth.
    """
    rows, counts = measured_flights(run), sulphur_verdicts(run)
    decided = counts["right"] + counts["wrong"]
    most = clopper_pearson(counts["wrong"], decided, CONFIDENCE).high
    held = int(_held(rows).sum())
    wrong = Card(
        "Wrong verdicts",
        f"{counts['wrong']:,} of {decided:,}",
        note=f"rate below {percent(most)} at {percent(CONFIDENCE)}" if decided else "",
    )
    limits = sorted(rows["sulphur_limit_percent"].unique())
    of_limits = " and ".join(map(limit_words, limits))
    is_open = UndecidedCard("Open verdicts", f"{counts['open']:,} of {len(rows):,}", of_limits)
    name = "95 % intervals that hold what a perfect instrument reads"
    return [
        wrong,
        *([is_open] if counts["open"] else []),
        *_errors(rows),
        Card(name, f"{held:,} of {len(rows):,}"),
    ]


def _held(rows: pd.DataFrame) -> Mask:
    names = ("fsc_low_percent", "fsc_expected_percent", "fsc_high_percent")
    low, expected, high = (column(rows, name) for name in names)
    held: Mask = (low <= expected) & (expected <= high)
    return held


def _errors(rows: pd.DataFrame) -> Iterator[Card]:
    """Yield the median relative error of each instrument, and the flight with the largest."""
    for sensor, group in rows.groupby("sensor"):
        shares = share_read(column(group, "fsc_percent"), column(group, "fsc_expected_percent"))
        errors = np.abs(shares - 1.0)
        known = np.isfinite(errors)
        if not known.any():
            continue
        worst = group[known].iloc[int(np.argmax(errors[known]))]
        yield Card(
            f"Relative error, {sensor}, median",
            percent(float(np.median(errors[known]))),
            note=f"largest {percent(float(errors[known].max()))}: {worst['flight_id']}",
        )


def verdict_table(rows: pd.DataFrame) -> Table:
    """Return how many verdicts were right, wrong and open, by limit and instrument."""
    groups = []
    for (limit, sensor), group in rows.groupby(["sulphur_limit_percent", "sensor"]):
        right, wrong, is_open = (int(of.sum()) for of in _verdicts(group))
        groups.append(
            {"limit": limit, "sensor": sensor, "right": right, "wrong": wrong, "open": is_open}
        )
    return rows_table(
        groups,
        [
            Cell(f"Limit [{MASS_PERCENT}]", "limit", "{:g}"),
            Cell("Sensor", "sensor", width=2.0),
            *(Cell(name.capitalize(), name, "{:,.0f}") for name in ("right", "wrong", "open")),
        ],
        caption="Verdicts by limit: right where they agree with the fuel. A fuel at the limit is"
        " not above it.",
        left_columns=2,
    )


def method_blocks(run: RunData, name: Name) -> list[Block]:
    """Return verdicts and errors of the flights that measured the fuel; ``name`` is that of a
    flight.
    """
    rows, statistics = measured_flights(run), run.sulphur
    if len(rows) < _FEW or statistics is None:
        return [verdict_table(rows), flight_table(rows, name)]
    trajectories = trajectory_chart(run, rows)
    designed: list[Block] = [] if trajectories is None else [Heading("Trajectories"), trajectories]
    curve = operating_curve(statistics)
    return [
        verdict_table(rows),
        Text(_COMPARED),
        accuracy_table(statistics),
        error_chart(rows),
        *designed,
        Heading("Ships called above the limit"),
        *([curve] if curve is not None else []),
        calls_table(statistics),
        Heading("How well the plume was hit"),
        hit_table(rows),
    ]
