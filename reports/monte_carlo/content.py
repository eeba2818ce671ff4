"""What a report shows of a Monte Carlo study: the bound on a keep-out violation, distributions and
sensitivity.
"""

import math
from typing import Any

from common.intervals import CONFIDENCE, clopper_pearson, percent
from reports.document.blocks import Block, Heading, Section, Text
from reports.monte_carlo.driver_charts import driver_charts
from reports.monte_carlo.names import documented_units
from reports.monte_carlo.spread_charts import spread_charts
from reports.monte_carlo.subset import subset_headline, subset_sections
from reports.monte_carlo.tables import ending_table, left_out_rows, quantile_table, violation_table
from reports.run.columns import radii_differ
from reports.run.run_data import RunData
from reports.run.trials import measured_from, shape_words

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
    # That of a study that was looked at repeatedly is its own.
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
        # Of figures that have indices: few flights have none.
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
