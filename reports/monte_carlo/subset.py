"""What a report shows of a subset simulation: the probability of a rare violation, its levels, and
the inputs near it.
"""

from typing import Any

import numpy as np

from common.columns import Column
from common.intervals import percent
from common.run_layout import SUMMARY
from reports.document.blocks import Block, Heading, Section, Table, Text
from reports.document.chart import Chart, Line, Panel, between, upright
from reports.document.tables import Cell, number, pairs_table, rows_table
from reports.monte_carlo.names import Units, input_name, input_unit
from reports.run.columns import Array

Record = dict[str, Any]

FEW_RENEWALS = 0.05
"""Fraction of accepted renewals below which the seed decides: intervals were too narrow in tests
from there on.
"""


def subset_sections(statistics: Record, units: Units, clearance: Column) -> list[Section]:
    """Return the sections of a study by subset simulation."""
    return [
        Section(
            anchor="study",
            title="Probability of a keep-out violation",
            nav_title="Probability",
            blocks=[
                Text(method_words(statistics)),
                _probability_table(statistics),
                *curve_chart(statistics, clearance),
                Heading("How the flights ended"),
                ending_table(statistics),
            ],
        ),
        Section(
            anchor="levels",
            title="Levels of the subset simulations",
            nav_title="Levels",
            blocks=_levels(statistics),
        ),
        Section(
            anchor="drivers",
            title=_near(statistics),
            nav_title="Inputs",
            blocks=_inputs(statistics, units),
        ),
    ]


def subset_headline(statistics: Record) -> str:
    """Return what a study by subset simulation bounds, in a sentence: not what its flights, which
    it leads, have in common.
    """
    found, confidence = statistics["violation"], percent(statistics["confidence"])
    bound = f"at most {percent(found['pessimistic']['upper'])} at {confidence} confidence"
    if found["reached"]:
        return (
            f"Keep-out violation with a probability of {percent(found['estimate'])} in a flight,"
            f" {bound}, by subset simulation"
        )
    return f"Subset simulation reached no keep-out violation: a probability of {bound} in a flight"


def curve_chart(statistics: dict[str, Any], clearance: Column) -> list[Chart]:
    """Return the probability of coming closer than a distance, over that distance; none if no
    distance was reached by all.
    """
    points = statistics["curve"]
    if len(points) < 2:
        return []
    x, estimate, low, high = (
        _column(points, name) for name in ("clearance_m", "estimate", "low", "high")
    )
    floor = 0.5 * float(low.min())
    panel = Panel(
        x_label=clearance.label,
        y_label="Probability of a flight that comes closer [-]",
        lines=[
            between(x, low, high, "interval", "sky", "solid"),
            Line(x=x, y=estimate, label="estimate", colour="blue"),
            upright(0.0, (floor, 1.5), "r_min"),
        ],
        log_y=True,
        y_range=(floor, 1.5),
    )
    caption = (
        "Probability that the closest approach of a flight lies below a distance beyond r_min, from"
        " all levels, with its two-sided interval at each distance. The curve ends where a"
        " simulation has nothing nearer."
    )
    return [Chart(name="rare-curve", caption=caption, panels=[panel], panel_height=0.42)]


_METHOD = (
    "The interval is that of the mean of a log-normal distribution (Cox, with Student's t), from"
    " the scatter of the simulations, or from the correlation within their chains (Au and Beck),"
    " whichever is larger. What lies apart from all flights of a level is not found by chains; a"
    " search (falsify) is the other way to look for it. Flights of further levels are led towards"
    " violations: their share is no probability."
)
_REACHED = "{reached} of {repeats} independent subset simulations reached a violation."
_NEAREST = "Their nearest flights stayed {nearest} m beyond r_min."
_OUTSIDE = "{outside:,} points outside of the declared speed ratios were sampled again."
_UNKNOWN = (
    "The end of {unknown:,} flights of the first levels is unknown; with each as a violation the"
    " bound is {upper}."
)


def method_words(statistics: Record) -> str:
    """Return what the probability of a keep-out violation rests on."""
    simulations, found = statistics["simulations"], statistics["violation"]
    nearest = _range([of["levels"][-1]["nearest_m"] for of in simulations], "{:.1f}")
    outside = sum(of["levels"][0]["outside"] for of in simulations)
    unknown, upper = found["first_levels_unknown"], percent(found["pessimistic"]["upper"])
    sentences = [
        (_REACHED, True),
        (_NEAREST, not found["reached"]),
        (_OUTSIDE, outside),
        (_UNKNOWN, unknown),
    ]
    said = " ".join(words for words, holds in sentences if holds).format(
        reached=found["reached"],
        repeats=found["repeats"],
        nearest=nearest,
        outside=outside,
        unknown=unknown,
        upper=upper,
    )
    return f"{said} {_METHOD}"


def _probability_table(statistics: Record) -> Table:
    found, plain = statistics["violation"], statistics["violation"]["first_levels"]
    level = percent(statistics["confidence"])
    return Table(
        caption="The probability of a keep-out violation, by subset simulation and by its first"
        " levels alone.",
        head=[
            "By",
            "Flights",
            "Violations",
            "Probability",
            f"Two-sided at {level}",
            f"At most, one-sided at {level}",
        ],
        rows=[
            [
                f"{found['repeats']} subset simulations",
                f"{statistics['flights']['done']:,}",
                f"{found['events']:,}",
                percent(found["estimate"]) if found["reached"] else "–",
                f"{percent(found['low'])} to {percent(found['high'])}",
                percent(found["upper"]),
            ],
            [
                "Their first levels alone, plain sampling",
                f"{plain['flights']:,}",
                f"{plain['events']:,}",
                "–" if plain["share"] is None else percent(plain["share"]),
                f"{percent(plain['low'])} to {percent(plain['high'])}",
                percent(plain["upper"]),
            ],
        ],
        widths=[2.2, 0.7, 0.8, 1.0, 1.9, 1.5],
    )


def ending_table(statistics: Record) -> Table:
    """Return how flights ended, and which are of unknown end."""
    unknown = statistics["flights"]["unknown"]
    rows = [
        ["Outcomes", _counted(statistics["outcomes"])],
        ["Modes at the end", _counted(statistics["modes_at_end"])],
        *(
            [f"Of unknown end: {outcome.replace('_', ' ')}", _flights(found)]
            for outcome, found in unknown.items()
        ),
    ]
    return pairs_table(rows)


def _counted(counts: dict[str, int]) -> str:
    return (
        ", ".join(f"{count:,} {word.replace('_', ' ')}" for word, count in counts.items()) or "none"
    )


def _flights(found: Record) -> str:
    more = found["flights"] - len(found["flight_ids"])
    return f"{found['flights']:,}: {', '.join(found['flight_ids'])}" + (
        f" and {more:,} more, in {SUMMARY}" if more else ""
    )


_LEVELS = (
    "The first level is a plain random sample. The flights of each further level grow in Markov"
    " chains from the nearest of the level before, and stay at least as near; the probability is"
    " the product of the fractions that passed. Inputs and noise move by small steps, the seed of"
    " the turbulence is renewed as a whole: the last three columns say how many moves were"
    " accepted. Where simulations differ, the smallest and the largest figure are shown."
)


def _levels(statistics: Record) -> list[Block]:
    simulations = statistics["simulations"]
    deepest = max(len(simulation["levels"]) for simulation in simulations)
    levels = [
        [of["levels"][i] for of in simulations if len(of["levels"]) > i] for i in range(deepest)
    ]
    cells = [
        Cell("Level", lambda of: str(levels.index(of) + 1), width=0.5),
        Cell("Simulations", lambda of: str(len(of)), width=0.8),
        Cell("Within r_min plus [m]", _below, width=1.2),
        Cell(
            "Nearest flight beyond r_min [m]",
            lambda of: _range([level["nearest_m"] for level in of], "{:.1f}"),
            width=1.3,
        ),
        Cell("Flights", lambda of: f"{sum(level['flights'] for level in of):,}", width=0.7),
        Cell("Fraction that passed [%]", _passed, width=1.1),
        Cell("Inputs", lambda of: _accepted(of, "accepted", "moved"), width=0.6),
        Cell("Noise", lambda of: _accepted(of, "blended_accepted", "blended"), width=0.6),
        Cell("Seed", lambda of: _accepted(of, "renewed_accepted", "renewed"), width=0.6),
    ]
    return [
        Text(_LEVELS),
        rows_table(levels, cells, caption="The levels of the subset simulations."),
        *(Text(line) for line in _warnings(simulations)),
    ]


def _below(levels: list[Record]) -> str:
    return _range([level.get("below_m") for level in levels], "{:.1f}", none="any")


def _passed(levels: list[Record]) -> str:
    return _range([100.0 * level["probability"] for level in levels], "{:.3g}")


def _range(values: list[Any], form: str, none: str = "–") -> str:
    known = [value for value in values if value is not None]
    if not known:
        return none
    least, most = form.format(min(known)), form.format(max(known))
    return least if least == most else f"{least} to {most}"


def _accepted(levels: list[Record], accepted: str, tried: str) -> str:
    count = sum(level[tried] for level in levels)
    return percent(sum(level[accepted] for level in levels) / count) if count else "–"


_STALLED = "{stalled} of {all} simulations ended early: all flights of a level were equally near."
_FEW_RENEWED = (
    "Only {share} of the renewals of the seed were accepted in the last levels: the turbulence's"
    " seed decides which flights come near, and the interval may be too narrow. Use more flights"
    " per level (subset.flights_per_level)."
)


def _warnings(simulations: list[Record]) -> list[str]:
    lines = []
    if stalled := sum(simulation["stalled"] for simulation in simulations):
        lines.append(_STALLED.format(stalled=stalled, all=len(simulations)))
    last = [simulation["levels"][-1] for simulation in simulations]
    tried, accepted = (
        sum(level[name] for level in last) for name in ("renewed", "renewed_accepted")
    )
    if tried and accepted < FEW_RENEWALS * tried:
        lines.append(_FEW_RENEWED.format(share=percent(accepted / tried)))
    return lines


def _near(statistics: Record) -> str:
    return (
        "Inputs of flights with a violation"
        if statistics["violation"]["reached"]
        else "Inputs of the nearest flights"
    )


_INPUTS = (
    "How the inputs of flights {which} are distributed, against how they are declared: the distance"
    " is the largest difference of the two cumulative distributions (Kolmogorov). The noise floor,"
    " {floor:.2f}, is the largest distance of some inputs without any effect that moved too."
)


def _inputs(statistics: Record, units: Units) -> list[Block]:
    which = "with a violation" if statistics["violation"]["reached"] else "of the last level"
    text = _INPUTS.format(which=which, floor=statistics["noise_floor"])
    return [Text(text), input_table(statistics, units)]


def input_table(statistics: Record, units: Units) -> Table:
    """Return the inputs with their distances, and how their values differ."""
    rows = [
        [_named(entry, units), f"{entry['distance']:.2f}", *_values(entry)]
        for entry in statistics["inputs"]
    ]
    return Table(
        caption="Inputs by how much their values near a violation differ from the others.",
        head=["Input", "Distance [-]", "As declared", "Near the event"],
        rows=rows,
        widths=[2.0, 0.8, 2.0, 2.0],
        prose=True,
    )


def _named(entry: Record, units: Units) -> str:
    unit = input_unit(entry["key"], units)
    return input_name(entry["key"]) + (f" [{unit}]" if entry["edges"] else "")


def _values(entry: Record) -> tuple[str, str]:
    if entry["edges"]:
        return number(entry["median"], "median {:.3g}"), number(
            entry["median_near"], "median {:.3g}"
        )
    shares = [
        ", ".join(
            f"{name.replace('_', ' ')} {percent(share)}"
            for name, share in zip(entry["names"], entry[which], strict=True)
        )
        for which in ("declared", "near")
    ]
    return shares[0], shares[1]


def _column(entries: list[dict[str, Any]], name: str) -> Array:
    return np.array([entry[name] for entry in entries], dtype=np.float64)
