"""Tables of the searches of a trial, a row per variant."""

import math
from collections.abc import Callable

import numpy as np

from common.intervals import CONFIDENCE, percent, shared_interval
from measurement.estimate.verdict import COVERAGE
from measurement.gases import MASS_PERCENT
from measurement.plume.fluctuating_plume import FOUND_WITHIN
from reports.document.blocks import Table
from reports.document.tables import Cell, number, rows_table
from reports.finding.variants import Variant
from reports.run.columns import Array, column

_TOLD = "told"
"""Variant that knows the axis, if the run has it."""


def search_table(variants: list[Variant]) -> Table:
    """Return how soon each variant found its plumes, how often it hit them, and what it measured of
    the fuel.
    """
    told = next((variant for variant in variants if variant.name == _TOLD), None)

    def over(name: str) -> Callable[[Variant], str]:
        return lambda of: _over(of, told, name)

    cells = [
        Cell("Variant", lambda of: of.name, width=1.5),
        Cell("Flights", lambda of: len(of.rows), "{:,.0f}", 0.7),
        Cell(
            f"Found within {FOUND_WITHIN / 60.0:g} min",
            lambda of: percent(of.share_found(FOUND_WITHIN)),
        ),
        Cell("Time to find, median [s]", lambda of: seconds_words(float(np.median(of.times)))),
        Cell("95 % quantile [s]", lambda of: seconds_words(of.latest), width=0.8),
        Cell("Hits after found", hits_words, width=0.9),
        Cell(
            f"Sulphur error, rms [{MASS_PERCENT}]",
            lambda of: _rms(column(of.rows, "fsc_percent") - column(of.rows, _EXPECTED)),
            "{:.4f}",
        ),
        Cell(
            f"Sulphur 1σ stated, median [{MASS_PERCENT}]",
            lambda of: _median(column(of.rows, "fsc_uncertainty_percent")),
            "{:.4f}",
            1.2,
        ),
        Cell("1σ over known", over("fsc_uncertainty_percent"), width=0.8),
        Cell("Its noise over known", over("fsc_noise_percent"), width=0.9),
    ]
    return rows_table(variants, cells, caption=_SEARCHES)


_EXPECTED = "fsc_expected_percent"

_SEARCHES = (
    "How soon plumes were found, how often they were hit, and what was measured of the sulphur."
    " Over known: beside the same cases with a known axis, median of the pairs."
)


def height_table(variants: list[Variant]) -> Table | None:
    """Return how well the height of the axis was known after 3 minutes; none where no flight has an
    estimate then.
    """
    rows = []
    for variant in variants:
        error, deviation = (
            column(variant.rows, f"axis_height_{of}_3min_m") for of in ("error", "deviation")
        )
        known = np.isfinite(error) & np.isfinite(deviation)
        if not known.any():
            continue
        held = np.abs(error[known]) <= COVERAGE * deviation[known]
        interval = shared_interval(held, variant.rows.loc[known, "seed"], CONFIDENCE)
        rows.append([
            variant.name,
            f"{len(held):,}",
            number(float(np.mean(error[known])), "{:+.1f}"),
            number(_rms(error), "{:.1f}"),
            number(_median(deviation), "{:.1f}"),
            percent(float(held.mean())),
            f"{percent(interval.low)} to {percent(interval.high)}",
        ])  # fmt: skip
    return (
        Table(
            caption="Height of the axis after 3 minutes on the orbit: error, and how often the"
            " stated 95 % interval held it.",
            head=[
                "Variant",
                "Flights",
                "Bias [m]",
                "Error, rms [m]",
                "Stated 1σ, median [m]",
                "Covered",
                "Interval of that",
            ],
            rows=rows,
            widths=[1.5, 0.7, 0.8, 1.0, 1.2, 0.8, 1.4],
        )
        if rows
        else None
    )


def seconds_words(value: float) -> str:
    """Return a time to find to a second; infinite ones are those of plumes that were not found."""
    return f"{value:.0f}" if math.isfinite(value) else "not found"


def hits_words(variant: Variant) -> str:
    """Return the share of a variant's passes that hit the plume once it was found, the mean over
    its flights.
    """
    shares = column(variant.rows, "hit_rate_found")
    known = shares[np.isfinite(shares)]
    return percent(float(np.mean(known))) if len(known) else "–"


def _rms(values: Array) -> float | None:
    known = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(known**2))) if len(known) else None


def _median(values: Array) -> float | None:
    known = values[np.isfinite(values)]
    return float(np.median(known)) if len(known) else None


def _over(variant: Variant, told: Variant | None, name: str) -> str:
    if told is None or name not in variant.rows or name not in told.rows:
        return "–"
    return number(_median(variant.beside(told, name)), "{:.2f}")
