"""What a convergence study shows, at a glance."""

import math

import pandas as pd

from common.run_layout import COUNTEREXAMPLES
from reports.convergence.data import ConvergenceData, Law, failed, predicted
from reports.convergence.tables import reason
from reports.document.blocks import Card, Verdict
from reports.document.tables import number

FAILURES_NAMED = 10
"""Counter-examples that the verdict names, at most."""


def convergence_verdict(data: ConvergenceData) -> Verdict:
    """Judge a study by the laws that the theory is about, if it flew any: it holds if every
    trajectory under them converged.
    """
    rows, manifest = data.proven(), data.run.manifest
    proven = data.planned > 0
    state = manifest.get("state", "unfinished")
    counter_examples = failed(rows)
    complete = state == "complete" and len(rows) == data.planned
    if not proven:
        missed = len(failed(data.rows))
        complete = state == "complete" and not (missed or data.lost)
        headline = f"{len(data.rows) - missed:,} of {len(data.rows):,} trajectories converged, under laws that no theory covers"
    elif not len(rows):
        headline = "Nothing was flown yet"
    elif len(counter_examples):
        headline = f"{len(counter_examples):,} of {len(rows):,} trajectories did not converge"
    elif complete:
        headline = f"All {len(rows):,} trajectories converged"
    else:
        headline = f"All {len(rows):,} trajectories so far converged; {data.planned:,} are planned"
    named = [
        f"{_law(data, str(row['law'])).name}, trajectory {row['trajectory']}: {reason(row)}"
        for _, row in counter_examples.head(FAILURES_NAMED).iterrows()
    ]
    if len(counter_examples) > FAILURES_NAMED:
        named.append(f"and {len(counter_examples) - FAILURES_NAMED:,} more, in {COUNTEREXAMPLES}")
    detail = _detail(data)
    if data.lost:
        detail += f" {data.lost:,} trajectories were lost with their processes, and count as not flown; --resume flies them again."
    if state != "complete":
        detail += f" The run is {state}; continue it with --resume."
    return Verdict(
        holds=not proven or (len(rows) > 0 and not len(counter_examples)),
        complete=complete,
        headline=headline,
        detail=detail,
        failures=named,
        figures=_figures(data),
    )


def percentage(part: int, whole: int) -> str:
    """Return a part of a whole in percent, rounded down: 100 % are all."""
    return f"{math.floor(10_000.0 * part / whole) / 100.0:g} %" if whole else "none flown"


def _law(data: ConvergenceData, key: str) -> Law:
    return next(law for law in data.laws if law.key == key)


def _detail(data: ConvergenceData) -> str:
    proven = [law.name.lower() for law in data.laws if law.proven]
    states = data.rows["trajectory"].nunique()
    detail = (
        f"{states:,} random initial states, each flown with {' and '.join(proven)}."
        if proven
        else ""
    )
    for law in data.laws:
        if not law.proven:
            rows = data.of(law)
            detail += (
                " The theory says nothing of cut commands, so they have no part in this:"
                f" under {law.name.lower()}, {len(rows) - len(failed(rows)):,} of {len(rows):,} converged."
            )
    return detail.strip()


def _figures(data: ConvergenceData) -> list[Card]:
    fractions, slowest = [], []
    for law in data.laws:
        rows = data.of(law)
        share = percentage(len(rows) - len(failed(rows)), len(rows))
        limit, met = (
            ("100 %", len(rows) > 0 and not len(failed(rows))) if law.proven else ("", None)
        )
        fractions.append(Card(f"{law.name}: converged", share, limit, met))
        slowest.append(
            Card(
                f"{law.name}: slowest to settle", number(rows["settling_time_s"].max(), "{:,.0f} s")
            )
        )
    farthest = Card("Farthest start", number(data.rows["start_distance_m"].max(), "{:,.0f} m"))
    return [
        *fractions,
        farthest,
        *slowest,
        _predicted(data.proven() if data.planned else data.rows),
    ]


def _predicted(rows: pd.DataFrame) -> Card:
    known = predicted(rows)
    ratio = (known["settling_time_s"] / known["settling_time_predicted_s"]).median()
    return Card("Settling over predicted, median", number(ratio, "{:.2f}"))
