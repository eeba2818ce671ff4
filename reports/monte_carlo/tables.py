"""Tables of a Monte Carlo study."""

from typing import Any

from common.columns import Column
from common.intervals import percent
from common.run_layout import SUMMARY
from reports.document.blocks import Table
from reports.document.tables import pairs_table
from reports.monte_carlo.names import FROM_THE_CENTRE, input_name
from reports.run.run_data import RunData

Record = dict[str, Any]


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
            # One reason for figures of which other numbers of flights are known: only its end is
            # the same.
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
