"""Figures of a convergence study. Thousands of trajectories become some hundred points."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt
import pandas as pd

from reports.convergence.data import CONVERGED, REFERENCES, ConvergenceData, Law, predicted
from reports.document.chart import Chart, Line, Panel, Style
from reports.run.columns import Array

CURVE_POINTS = 200
"""Points of a cumulative curve at most."""
HISTORY_POINTS = 500
"""Points of a time history at most."""
DISTANCE_BINS = 20
"""Bins of start distances at most."""
BIN_TRAJECTORIES = 20
"""Trajectories for each bin, on average, above two bins."""
PANEL_HEIGHT = 0.32
HISTORIES_PER_LAW = 6
DISTANCE_SHOWN_MIN_M, TIME_SHOWN_MIN_S, RATIO_SHOWN_MIN = 1e-3, 1.0, 1e-2
"""Floors of logarithmic axes: distances go to zero, and a start inside the settling band is settled
at once.
"""


def settling_charts(data: ConvergenceData) -> list[Chart]:
    """Return the figures of when trajectories settle, for the laws of which any did."""
    laws = [law for law in data.laws if data.of(law)["settling_time_s"].notna().any()]
    if not laws:
        return []
    return [_cumulative(data, laws), _over_distance(data, laws), *_over_predicted(data, laws)]


def history_chart(
    data: ConvergenceData, name: str, caption: str, *, converged: bool
) -> Chart | None:
    """Return distances over time, of some of the trajectories that were kept: of those that
    converged, or of those that did not.
    """
    lines = {law.name: _histories(data, law, converged=converged) for law in data.laws}
    limits = _around([line.y for drawn in lines.values() for line in drawn])
    panels = [
        Panel(
            x_label="Time [s]",
            y_label="Distance [m]",
            title=title,
            lines=drawn,
            log_y=True,
            y_range=limits,
        )
        for title, drawn in lines.items()
        if drawn
    ]
    if not panels:
        return None
    return Chart(
        name=name, caption=caption, panels=panels, columns=len(panels), panel_height=PANEL_HEIGHT
    )


def _histories(data: ConvergenceData, law: Law, *, converged: bool) -> list[Line]:
    rows = data.of(law)
    kept = rows[[(law.key, number) in data.kept for number in rows["trajectory"]]]
    lines = []
    chosen = kept[(kept["outcome"] == CONVERGED) == converged].head(HISTORIES_PER_LAW)
    for _, row in chosen.sort_values("reference", kind="stable").iterrows():
        history = data.run.trajectory(law.key, int(row["trajectory"]))
        if history is not None:
            finite = history[np.isfinite(history["distance_m"])]
            known = finite.iloc[_thinned(len(finite), HISTORY_POINTS)]
            distance = np.maximum(_column(known, "distance_m"), DISTANCE_SHOWN_MIN_M)
            name, colour, style = REFERENCES[str(row["reference"])]
            lines.append(
                Line(
                    x=_column(known, "time_s"),
                    y=distance,
                    label=f"{name} reference",
                    colour=colour,
                    style=style,
                )
            )
    return [line for line in lines if len(line.x)]


def _cumulative(data: ConvergenceData, laws: Sequence[Law]) -> Chart:
    return Chart(
        name="settling",
        caption="Fraction of all trajectories that have settled, over time since their start; a curve that ends below 100 % leaves"
        " out those that never did.",
        panels=_curves(data, laws, _times, "Settling time [s]", "Settled [%]"),
        columns=len(laws),
        panel_height=PANEL_HEIGHT,
    )


def _times(rows: pd.DataFrame) -> Array:
    return np.maximum(_column(rows, "settling_time_s"), TIME_SHOWN_MIN_S)


def _over_predicted(data: ConvergenceData, laws: Sequence[Law]) -> list[Chart]:
    def ratio(rows: pd.DataFrame) -> Array:
        known = predicted(rows)
        ratios: Array = _column(known, "settling_time_s") / _column(
            known, "settling_time_predicted_s"
        )
        return np.maximum(ratios, RATIO_SHOWN_MIN)

    panels = _curves(data, laws, ratio, "Measured over predicted [-]", "Trajectories [%]")
    if not panels:
        return []
    return [
        Chart(
            name="predicted",
            caption="Settling time measured over that predicted: fraction of the trajectories up to each ratio. 1 is as predicted"
            " by the motion averaged over the reference's turns.",
            panels=panels,
            columns=len(panels),
            panel_height=PANEL_HEIGHT,
        )
    ]


def _curves(
    data: ConvergenceData,
    laws: Sequence[Law],
    values: Callable[[pd.DataFrame], Array],
    x_label: str,
    y_label: str,
) -> list[Panel]:
    """Return a panel per law with a cumulative curve per kind of reference, over logarithmic
    abscissae alike.
    """
    lines = {law.name: _law_curves(data, law, values) for law in laws}
    limits = _around([line.x for curves in lines.values() for line in curves])
    return [
        Panel(
            x_label=x_label,
            y_label=y_label,
            title=name,
            lines=curves,
            log_x=True,
            x_range=limits,
            y_range=(0.0, 103.0),
        )
        for name, curves in lines.items()
        if curves
    ]


def _law_curves(
    data: ConvergenceData, law: Law, values: Callable[[pd.DataFrame], Array]
) -> list[Line]:
    lines = []
    for reference in data.references:
        name, colour, style = REFERENCES[reference]
        x, fraction = cumulative(values(data.of(law, reference)))
        if len(x):
            lines.append(
                Line(x=x, y=100.0 * fraction, label=f"{name} reference", colour=colour, style=style)
            )
    return lines


def cumulative(values: Array) -> tuple[Array, Array]:
    """Return some of the values in rising order, and which fraction of all is no larger.

    What is not a number counts among all. The first value comes twice, first with 0, for the curve
    to rise from there.
    """
    known = np.sort(values[np.isfinite(values)])
    ranks = _thinned(len(known), CURVE_POINTS)
    fraction = (ranks + 1.0) / max(1, len(values))
    return np.append(known[:1], known[ranks]), np.append(np.zeros(len(known[:1])), fraction)


def _over_distance(data: ConvergenceData, laws: Sequence[Law]) -> Chart:
    panels = [_distance_panel(data, law) for law in laws]
    limits = _around([line.y for panel in panels for line in panel.lines])
    return Chart(
        name="distance",
        caption=f"Settling time over the distance at the start, of those that settled, in up to {DISTANCE_BINS} bins of distance."
        " The prediction, by the motion averaged over the reference's turns, is drawn by its median.",
        panels=[replace(panel, y_range=limits) for panel in panels],
        columns=len(panels),
        panel_height=PANEL_HEIGHT,
    )


def _distance_panel(data: ConvergenceData, law: Law) -> Panel:
    settled = data.of(law).dropna(subset=["settling_time_s"])
    farthest = float(data.rows["start_distance_m"].max())
    count = min(max(len(settled) // BIN_TRAJECTORIES, 2), DISTANCE_BINS)
    number = np.minimum(
        _column(settled, "start_distance_m") * count / farthest, count - 1.0
    ).astype(int)
    bins = np.unique(number)

    def line(name: str, fraction: float, label: str, colour: str, style: Style) -> Line:
        values = np.maximum(_column(settled, name), TIME_SHOWN_MIN_S)
        y = np.array([_quantile(values[number == i], fraction) for i in bins])
        return Line(x=(bins + 0.5) * farthest / count, y=y, label=label, colour=colour, style=style)

    return Panel(
        x_label="Start distance [m]",
        y_label="Settling time [s]",
        title=law.name,
        lines=[
            line("settling_time_s", 1.0, "slowest", "grey", "diamonds"),
            line("settling_time_s", 0.9, "90 % are faster", "sky", "solid"),
            line("settling_time_s", 0.1, "10 % are faster", "sky", "dot"),
            line("settling_time_s", 0.5, "median", "blue", "solid"),
            line("settling_time_predicted_s", 0.5, "predicted", "black", "dash"),
        ],
        x_range=(0.0, 1.03 * farthest),
        log_y=True,
    )


def _thinned(count: int, most: int) -> npt.NDArray[np.int64]:
    """Return indices of so many values at most, the first and the last among them."""
    return np.unique(np.round(np.linspace(0, count - 1, min(most, count))).astype(np.int64))


def _around(curves: Sequence[Array]) -> tuple[float, float] | None:
    """Return the powers of ten that lie around all values, as limits of a logarithmic axis; none
    without values.
    """
    values = np.concatenate([*curves, np.empty(0)])
    known = values[np.isfinite(values)]
    if not len(known):
        return None
    low, high = math.floor(math.log10(known.min())), math.ceil(math.log10(known.max()))
    return 10.0**low, 10.0 ** max(high, low + 1)


def _quantile(values: Array, fraction: float) -> float:
    known = values[np.isfinite(values)]
    return float(np.quantile(known, fraction)) if len(known) else math.nan


def _column(frame: pd.DataFrame, name: str) -> Array:
    return frame[name].to_numpy(dtype=np.float64)
