"""What a report shows of a Monte Carlo study: the bound on a keep-out violation, distributions and
sensitivity.
"""

import math
from typing import Any

import numpy as np

from common.columns import Column
from common.intervals import CONFIDENCE, clopper_pearson, percent
from reports.document.blocks import Block, Heading, Section, Table, Text
from reports.document.chart import Chart, Line, Panel, upright
from reports.document.palette import Meaning
from reports.document.panels import histogram
from reports.monte_carlo.names import FROM_THE_CENTRE, documented_units, input_name
from reports.monte_carlo.subset import Record, ending_table, subset_headline, subset_sections
from reports.run.columns import Array, clearance, radii_differ
from reports.run.run_data import RunData
from reports.run.trials import measured_from, shape_words


def violation_table(statistics: Record) -> Table:
    """Return how many flights violated the keep-out area, and the interval of that probability."""
    level = percent(statistics["interval_confidence"])
    counted = [
        ("Flights with a measurement", "measured"),
        ("All, those of unknown end counted as violations", "pessimistic"),
    ]
    return Table(
        caption="Flights that violated the keep-out area, and the interval of that probability.",
        head=[
            "Counted",
            "Flights",
            "Violations",
            "Fraction",
            f"Probability, two-sided at {level}",
            f"At most, one-sided at {level}",
        ],
        rows=[_fraction(name, statistics["violation"][key]) for name, key in counted],
        widths=[2.4, 0.7, 0.7, 0.8, 1.9, 1.5],
    )


def _fraction(name: str, found: Record) -> list[str]:
    known = found["share"] is not None
    return [
        name,
        f"{found['flights']:,}",
        f"{found['events']:,}",
        percent(found["share"]) if known else "–",
        f"{percent(found['low'])} to {percent(found['high'])}",
        percent(found["upper"]),
    ]


def quantile_table(run: RunData, statistics: Record, *, several_radii: bool) -> Table:
    """Return quantiles of each figure, each with its interval; distances are beyond r_min where the
    flights have several.
    """
    without = FROM_THE_CENTRE if several_radii else ("crossing_clearance_m",)
    figures = {
        run.column(name): found
        for name, found in statistics["figures"].items()
        if name not in without
    }
    every = sorted(
        {quantile["probability"] for figure in figures.values() for quantile in figure["quantiles"]}
    )
    rows = []
    for figure, found in figures.items():
        quantiles = {quantile["probability"]: quantile for quantile in found["quantiles"]}
        missing = f", {found['missing']:,} {figure.missing}" if found["missing"] else ""
        cells = [_quantile(figure, quantiles.get(probability)) for probability in every]
        rows.append([figure.label, f"{found['known']:,}{missing}", *cells])
    head = ["Figure", "Flights", *(percent(probability) for probability in every)]
    return Table(
        caption="Quantiles of each figure, each with its interval.",
        head=head,
        rows=rows,
        widths=[1.5, 0.9, *([1.1] * len(every))],
        print_size_pt=6.5,
    )


def _quantile(figure: Column, quantile: Record | None) -> str:
    if quantile is None or quantile["value"] is None:
        return "–"
    # The interval stands below its quantile: beside it there is no room for most.
    return (
        f"{figure.text(quantile['value'])}\n({figure.text(quantile['low'])} to"
        f" {figure.text(quantile['high'])})"
    )


def left_out_rows(run: RunData, sensitivity: Record) -> list[str]:
    """Return, in sentences, which figures have no indices and which inputs have none."""
    without: dict[str, list[str]] = {}
    for key, found in sensitivity.items():
        if found["message"]:
            # Figures with other numbers of known flights have one reason: only its end is the same.
            reason = str(found["message"]).rpartition("; ")[2]
            flights = f"{found['flights']:,} flight{'s' * (found['flights'] != 1)}"
            without.setdefault(reason, []).append(f"{run.column(key).title} ({flights})")
    lines = [
        f"No sensitivity indices of {'; '.join(names)}: {reason}."
        for reason, names in without.items()
    ]
    reasons = {
        (key, why)
        for found in sensitivity.values()
        if not found["message"]
        for key, why in found["left_out"].items()
    }
    return [*lines, *(f"{input_name(key)} has no index: {why}." for key, why in sorted(reasons))]


CURVE_POINTS = 400
"""Points of a cumulative curve at most."""

_FARTHEST = 0.005
"""Fraction of flights, the farthest, that go into the last bar of a histogram."""

_NEARER = 0.9
"""Fraction of flights that the curve of the nearest goes up to."""


_KEPT = (
    "Flights by their closest approach beyond r_min, the farthest half per cent in the last bar;"
    " and the share that came as near, log scale, with intervals of its quantiles, cut at {nearer}."
    " The farthest came to {farthest:.0f} m."
)


def spread_charts(run: RunData, statistics: dict[str, Any]) -> list[Chart]:
    """Return how the clearances of the flights are spread."""
    rows = run.summary
    near = clearance(rows)
    counted_near = histogram(
        [(_gathered(near), "flights", Meaning.FLOWN)],
        run.column("clearance_m").label,
        [(0.0, "r_min")],
    )
    if counted_near is None:
        return []
    kept = Chart(
        name="clearance",
        caption=_KEPT.format(nearer=percent(_NEARER), farthest=np.nanmax(near)),
        panels=[counted_near, _tail(near, statistics, run.column("clearance_m"))],
        columns=2,
        panel_height=0.4,
    )
    return [kept]


def _gathered(values: Array) -> Array:
    """Return known values with the farthest few moved to where the others end."""
    known = values[np.isfinite(values)]
    return np.minimum(known, np.quantile(known, 1.0 - _FARTHEST)) if len(known) else known


def _tail(near: Array, statistics: dict[str, Any], of: Column) -> Panel:
    x, fraction = cumulative(near)
    every = statistics["figures"]["clearance_m"]["quantiles"]
    quantiles = [q for q in every if q["probability"] <= 0.5 and None not in (q["low"], q["high"])]
    gap = np.nan
    ends = np.array([end for q in quantiles for end in (q["low"], q["high"], gap)])
    heights = np.array(
        [
            height
            for q in quantiles
            for height in (100.0 * q["probability"], 100.0 * q["probability"], gap)
        ]
    )
    least = 100.0 * float(fraction[0])
    far = float(np.quantile(near[np.isfinite(near)], _NEARER))
    nearest = min(0.0, float(x[0]))
    return Panel(
        x_label=of.label,
        y_label="Flights as near or nearer [%]",
        lines=[
            Line(x=x, y=100.0 * fraction, label="flights", colour=Meaning.FLOWN),
            Line(x=ends, y=heights, label="interval of a quantile", colour="black"),
            upright(0.0, (0.7 * least, 100.0), "r_min"),
        ],
        log_y=True,
        x_range=(nearest - 0.04 * (far - nearest), far),
        y_range=(0.7 * least, 130.0),
    )


def cumulative(values: Array) -> tuple[Array, Array]:
    """Return rising values, all of the lowest and ever fewer of the others, and the fraction of all
    known up to each.
    """
    known = np.sort(values[np.isfinite(values)])
    ranks = np.unique(np.geomspace(1.0, len(known), CURVE_POINTS).round().astype(np.int64))
    return known[ranks - 1], ranks / len(known)


INPUTS_MAX = 12
"""Inputs that have bars."""


def driver_charts(run: RunData, statistics: dict[str, Any]) -> list[Chart]:
    """Return bars of the sensitivity indices of each figure that has any, the largest delta
    first.
    """
    return [
        _bars(key, run.column(key).title, found)
        for key, found in statistics["sensitivity"].items()
        if found["inputs"]
    ]


def _bars(key: str, title: str, found: dict[str, Any]) -> Chart:
    inputs = found["inputs"][:INPUTS_MAX]
    more = len(found["inputs"]) - len(inputs)
    left_out = f" {more} inputs have a smaller δ." if more else ""
    of = f" of {found['known']:,}" if found["known"] > found["flights"] else ""
    names = [input_name(index["key"]) for index in inputs]
    return Chart(
        name=f"drivers-{key.replace('_', '')}",
        caption=f"{title}: {found['flights']:,} flights{of}.{left_out}",
        panels=[
            _index_panel(inputs, "delta", found["delta_floor"], "Borgonovo's δ [-]", names, title),
            _index_panel(
                inputs,
                "first_order",
                found["first_order_floor"],
                "First-order index S₁ [-]",
                [""] * len(names),
                "",
            ),
        ],
        columns=2,
        panel_height=0.12 + 0.025 * len(inputs),
    )


def _index_panel(
    inputs: list[dict[str, Any]],
    name: str,
    floor: float,
    x_label: str,
    names: list[str],
    title: str,
) -> Panel:
    value = np.array([index[name] for index in inputs])
    error = np.array([index[f"{name}_error"] for index in inputs])
    place = np.arange(len(inputs))[::-1].astype(np.float64)
    above = value - error > floor
    lines = [
        _bar_line(value[mask], place[mask], label, colour)
        for mask, label, colour in (
            (above, "above the noise floor", "blue"),
            (~above, "not above it", "grey"),
        )
        if mask.any()
    ]
    ends = np.column_stack([value - error, value + error, np.full(len(value), np.nan)]).ravel()
    reach = (-0.6, len(inputs) - 0.4)
    lines += [
        Line(x=ends, y=np.repeat(place, 3), label="interval", colour="black"),
        upright(floor, reach, "noise floor"),
    ]
    low, high = min(0.0, float((value - error).min())), max(floor, float((value + error).max()))
    return Panel(
        x_label=x_label,
        y_label="Input",
        title=title,
        lines=lines,
        x_range=(low - 0.02 * (high - low), high + 0.05 * (high - low)),
        y_range=reach,
        y_names=list(zip(place.tolist(), names, strict=True)),
    )


def _bar_line(values: Array, places: Array, label: str, colour: str) -> Line:
    """Return bars from 0, which one outline encloses: from bar to bar it runs along 0."""
    x = np.column_stack([np.zeros(len(values)), values, values, np.zeros(len(values))]).ravel()
    y = np.column_stack([places - 0.32, places - 0.32, places + 0.32, places + 0.32]).ravel()
    return Line(x=x, y=y, label=label, colour=colour, fill=True)


_PROBABILITIES = (
    "Probability of violation {violation}, of loss {loss}, of not finishing {unfinished},"
    " at {confidence} confidence"
)


def probabilities(run: RunData) -> str:
    """Return the probabilities of a violation, of a loss and of a flight that does not finish; no
    word of flights without a vessel.
    """
    statistics, counts = run.statistics or {}, run.verdict.counts
    if run.verdict.whole.closest is None:
        return ""
    if statistics.get("method") == "subset":
        return subset_headline(statistics)
    # A study that was looked at repeatedly has another confidence.
    level = float(statistics.get("interval_confidence", CONFIDENCE))
    return _PROBABILITIES.format(
        violation=_probability(run, level, counts.violated, counts.unknown),
        loss=_probability(run, level, counts.lost),
        unfinished=_probability(run, level, counts.done - counts.completed),
        confidence=percent(level),
    )


def _probability(run: RunData, level: float, events: int, unknown: int = 0) -> str:
    """Return the share of flights with an event and the interval of its probability, which has each
    unknown flight as one at its upper end.

    Flights that share what is random count as one.
    """
    done, bound = run.verdict.counts.done, run.verdict.whole.bound
    samples = bound.samples if bound else done
    low = clopper_pearson(math.floor(events * samples / done), samples, level).low
    high = clopper_pearson(math.ceil((events + unknown) * samples / done), samples, level).high
    return f"{percent(events / done)} ({100.0 * low:.3g} to {percent(high)})"


def monte_carlo_sections(run: RunData) -> list[Section]:
    """Return the sections of a run with ``statistics.json``, and none of any other."""
    statistics = run.statistics
    if statistics is None:
        return []
    if statistics.get("method") == "subset":
        return subset_sections(
            statistics, documented_units(run.manifest), run.column("clearance_m")
        )
    return [
        Section(
            anchor="study",
            title="Probability of a keep-out violation",
            nav_title="Probability",
            blocks=_shown(statistics),
        ),
        Section(
            anchor="spread",
            title="Distributions",
            nav_title="Distributions",
            blocks=_spread(run, statistics),
        ),
        # A study of few flights has no indices.
        *(
            [
                Section(
                    anchor="drivers",
                    title="Sensitivity",
                    nav_title="Sensitivity",
                    blocks=_drivers(run, statistics),
                )
            ]
            if any(found["inputs"] for found in statistics["sensitivity"].values())
            else []
        ),
    ]


def _shown(statistics: dict[str, Any]) -> list[Block]:
    looks = statistics["look_number"]
    looked = [] if looks is None else [Text(_LOOKED.format(looks=looks, **_levels(statistics)))]
    return [
        Text(_BOUND),
        *looked,
        violation_table(statistics),
        Heading("How the flights ended"),
        ending_table(statistics),
    ]


_BOUND = (
    "The one-sided bound is that of Clopper and Pearson. It is on flights sampled as these were, in"
    " this simulation, and says nothing of what the simulation leaves out. It is that of"
    " independent flights; for inputs from a low-discrepancy design it is too high as a rule."
    " Flights of unknown end are those without a measurement or out of control."
)
_LOOKED = (
    "The study was evaluated up to {looks} times, to stop once it knew enough: for all evaluations"
    " together to hold with {confidence}, bounds and intervals are made with"
    " {interval_confidence}."
)


def _levels(statistics: dict[str, Any]) -> dict[str, str]:
    """Return the confidences of a study in words."""
    return {name: percent(statistics[name]) for name in ("confidence", "interval_confidence")}


def _spread(run: RunData, statistics: dict[str, Any]) -> list[Block]:
    several = radii_differ(run.summary)
    where = (
        "beyond each flight's own r_min"
        if several
        else measured_from(shape_words(run.summary) or "sphere")
    )
    text = _QUANTILES.format(where=where, **_levels(statistics))
    return [
        Text(text),
        quantile_table(run, statistics, several_radii=several),
        *spread_charts(run, statistics),
    ]


_QUANTILES = (
    "Quantiles of the flights' figures. The interval in brackets contains the quantile of all such"
    " flights with {interval_confidence} confidence, whatever the distribution (from order"
    " statistics); a dash where there are too few flights for that side. Keep-out figures count"
    " from a flight's first second, the others from settling. Distances are {where}."
)


def _drivers(run: RunData, statistics: dict[str, Any]) -> list[Block]:
    return [
        Text(_INDICES.format(**_levels(statistics))),
        *(Text(line) for line in left_out_rows(run, statistics["sensitivity"])),
        *driver_charts(run, statistics),
    ]


_INDICES = (
    "Borgonovo's δ says how much the distribution of a figure changes once an input is known: 0"
    " not at all, 1 completely. The first-order index S₁ is the fraction of the figure's variance"
    " that the input explains by itself. Of a finite number of flights neither is 0 for an input"
    " that does nothing: the noise floor is the largest index of some that do nothing, and what"
    " matters has an interval above it. The interval of S₁ holds the true index with {confidence};"
    " it is wide where few flights decide on the index. The interval of δ is that of as many"
    " resamples of the flights, and holds the true index less often, as δ comes out a tenth too"
    " low of some hundred flights."
)
