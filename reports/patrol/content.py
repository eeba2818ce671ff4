"""The report of patrols: how many ships were served, with what verdicts, and what an oracle would
have done.
"""

import math

import numpy as np

from common.patrols import PatrolCounts
from common.verdict import MET
from reports.design.section import innerloop_section
from reports.document.blocks import Card, Findings, Heading, Section, Text, Verdict
from reports.document.tables import parameter_blocks, vehicle_flown
from reports.flights.parameter_tables import distribution
from reports.patrol.charts import patrol_chart, time_lines
from reports.patrol.data import Patrols, read_patrols
from reports.patrol.tables import oracle_table, ship_table
from reports.run.columns import Array, column
from reports.run.run_data import RunData

_SHOWN = 12
"""Patrols of which map and ships are shown."""

_ORACLE = (
    "The oracle knows how long each ship takes: as long as a flight beside her that is told where her plume is, or as the patrol's"
    " own where that took less. It orders the ships for the most verdicts within the endurance, and then for the earliest end, as"
    " the patrol does: of few ships it tries all orders, of many it finds a good one by insertion. It never goes round a ship."
)


def patrol_content(run: RunData) -> Findings:
    """Return the findings of patrols."""
    patrols = read_patrols(run)
    flown = [(i, patrol) for i, patrol in enumerate(patrols.patrols) if len(patrol.phases)]
    charts = [(i, patrol_chart(patrol), ship_table(patrol, i)) for i, patrol in flown[:_SHOWN]]
    sections = [
        Section(
            anchor="patrols",
            title="Patrols and the oracle",
            nav_title="Patrols",
            blocks=[
                Text(_ORACLE),
                oracle_table(patrols),
                *([time_lines(patrols)] if len(flown) > 1 else []),
            ],
        ),
        Section(
            anchor="ships",
            title="Ships",
            blocks=[
                block
                for i, chart, table in charts
                for block in (Heading(f"Patrol {i}"), chart, table)
            ],
        ),
        *([innerloop_section(run.innerloop)] if run.innerloop else []),
        Section(
            anchor="parameters", title="Parameters", blocks=parameter_blocks(run, _sampled(run))
        ),
    ]
    patrols_flown = f"{len(patrols.patrols)} patrol{'s' * (len(patrols.patrols) != 1)}"
    counts = patrols.counts
    served = f"{counts.served} of {counts.ships} ships were served."
    words = f"{patrols_flown} of {vehicle_flown(run)}, {counts.hours:.1f} h in all: {served}"
    return Findings(
        flown=words,
        verdict=_verdict(patrols),
        picture=charts[0][1] if charts else None,
        sections=sections,
    )


def _sampled(run: RunData) -> dict[str, str]:
    """Return how each key is sampled that is, for every patrol or for every ship."""
    return {
        sample["key"]: distribution(sample, "patrol")
        for sample in run.manifest["config"].get("draws", [])
    }


def _verdict(patrols: Patrols) -> Verdict:
    rows, counts = patrols.run.summary, patrols.counts
    violations = counts.violations
    return Verdict(
        holds=counts.holds,
        complete=counts.met and patrols.run.verdict.exit_status == MET,
        headline=_headline(counts),
        detail=f"{counts.served} of {counts.ships} ships were served in {counts.hours:.1f} h, {counts.per_hour:.1f} an hour;"
        f" {violations} keep-out violation{'s' * (violations != 1)}.",
        failures=[
            f"{row['flight_id']}: {row['message']}" for _, row in rows.iterrows() if row["message"]
        ],
        figures=_figures(patrols, counts),
    )


def _figures(patrols: Patrols, counts: PatrolCounts) -> list[Card]:
    """Return what the verdict rests on. What nothing was flown or judged for has no criterion:
    nothing would meet it.
    """
    served, verdicts, oracle = counts.served, counts.verdicts, counts.oracle
    least, most = (
        f"≥ {100.0 * counts.oracle_share_min:g} %",
        f"≤ {100.0 * counts.wrong_share_max:g} %",
    )
    return [
        Card(
            "Correct verdicts, over the oracle's",
            f"{counts.correct} of {oracle}",
            *((least, counts.enough) if oracle else ()),
        ),
        Card(
            "Wrong verdicts",
            f"{counts.wrong} of {verdicts}",
            *((most, counts.right) if verdicts else ()),
        ),
        Card(
            "Keep-out violations", f"{counts.violations}", "0", served > 0 and not counts.violations
        ),
        Card("Ships served", f"{served} of {counts.ships}", "≥ 1", served > 0),
        _closest(patrols, "a ship that was served", "min_distance_m"),
        _closest(patrols, "any other ship", "others_distance_min_m"),
        Card("Ships served an hour", f"{counts.per_hour:.1f}"),
        Card("Flights beside ships without a verdict", f"{counts.open}"),
        Card(
            "Patrols that kept out, with their aircraft",
            f"{counts.through} of {counts.done}",
            *(("all", counts.through == counts.done) if served else ()),
        ),
    ]


def _headline(counts: PatrolCounts) -> str:
    """Return how many verdicts there are, beside the oracle's."""
    correct, oracle = counts.correct, counts.oracle
    if not counts.served:
        return f"No ship was served, and an oracle has {oracle or 'no'} correct verdict{'s' * (oracle > 1)}"
    share = f"{100.0 * correct / oracle:.0f} % of an oracle's" if oracle else "an oracle has none"
    return f"{correct} correct verdict{'s' * (correct != 1)}, {share}, {counts.wrong} wrong"


def _closest(patrols: Patrols, ship: str, figure: str) -> Card:
    """Return how near any ship came, with the keep-out radius, which holds for one that was not
    served just then, too.
    """
    name, distances = f"Closest approach to {ship}", column(patrols.run.summary, figure)
    if not np.isfinite(distances).any():
        return Card(name, "–")
    radius = float(patrols.run.manifest["config"]["keepout"]["radius_m"])
    return Card(name, _least(distances), f"≥ {radius:g} m", bool(np.nanmin(distances) >= radius))


def _least(distances: Array) -> str:
    """Return the least of some distances [m], of those that are known, rounded down: none is shown
    larger than it was.
    """
    return (
        f"{math.floor(10.0 * np.nanmin(distances)) / 10.0:.1f} m"
        if np.isfinite(distances).any()
        else "–"
    )
