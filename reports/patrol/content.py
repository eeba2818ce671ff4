"""The report of patrols: how many ships were served, with what verdicts, and what an oracle would have done."""

import numpy as np

from reports.design.section import innerloop_section
from reports.document.blocks import Card, Findings, Heading, Section, Text, Verdict
from reports.document.tables import parameter_table, vehicle_flown
from reports.patrol.charts import patrol_chart, time_lines
from reports.patrol.data import Patrols, read_patrols
from reports.patrol.tables import oracle_table, ship_table
from reports.run.columns import Array, column, count, kept_out, lost, met
from reports.run.run_data import RunData

_SHOWN = 12
"""Patrols of which map and ships are shown."""

_ORACLE = (
    "The oracle knows how long each ship takes: as long as a flight beside her that is told where her plume is, or as the patrol's"
    " own where that took less. Of all orders it takes the one with the most verdicts within the endurance, and of those the"
    " quickest. It does not go round other ships."
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
            blocks=[Text(_ORACLE), oracle_table(patrols), *([time_lines(patrols)] if len(flown) > 1 else [])],
        ),
        Section(
            anchor="ships",
            title="Ships",
            blocks=[block for i, chart, table in charts for block in (Heading(f"Patrol {i}"), chart, table)],
        ),
        *([innerloop_section(run.innerloop)] if run.innerloop else []),
        Section(anchor="parameters", title="Parameters", blocks=[parameter_table(run)]),
    ]
    patrols_flown = f"{len(patrols.patrols)} patrol{'s' * (len(patrols.patrols) != 1)}"
    words = (
        f"{patrols_flown} of {vehicle_flown(run)}, {patrols.hours:.1f} h in all: {patrols.total('served')} of"
        f" {patrols.total('ships')} ships were served."
    )
    return Findings(flown=words, verdict=_verdict(patrols), picture=charts[0][1] if charts else None, sections=sections)


def _verdict(patrols: Patrols) -> Verdict:
    rows, config = patrols.run.summary, patrols.run.manifest["config"]["patrol"]
    planned = int(patrols.run.manifest["flights_planned"])
    violations, wrong, oracle = (patrols.total(name) for name in ("keepout_violations", "wrong", "oracle_verdicts"))
    correct, gone, out = patrols.total("correct"), count(lost(rows)), count(kept_out(rows))
    enough, right = patrols.share >= config["oracle_share_min"], patrols.wrong_share <= config["wrong_share_max"]
    per_hour = patrols.total("served") / patrols.hours if patrols.hours else 0.0
    figures = [
        Card(
            "Correct verdicts, over the oracle's", f"{correct} of {oracle}", f"≥ {100.0 * config['oracle_share_min']:g} %", enough
        ),
        Card("Wrong verdicts", f"{wrong} of {patrols.total('verdicts')}", f"≤ {100.0 * config['wrong_share_max']:g} %", right),
        Card("Keep-out violations", f"{violations}", "0", not violations),
        Card("Ships served an hour", f"{per_hour:.1f}"),
        Card("Closest approach to a ship that was served", _least(column(rows, "min_distance_m"))),
        Card("Closest approach to any other ship", _least(column(rows, "others_distance_min_m"))),
        Card("Ships served", f"{patrols.total('served')} of {patrols.total('ships')}"),
        Card("Flights beside ships without a verdict", f"{patrols.total('open')}"),
        Card(
            "Patrols that kept out, with their aircraft", f"{count(met(rows))} of {len(rows)}", "all", count(met(rows)) == len(rows)
        ),
    ]
    kept = not violations and out == len(rows) and not gone
    return Verdict(
        holds=kept,
        complete=kept and enough and right and len(rows) == planned,
        headline=f"{correct} correct verdicts, {100.0 * patrols.share:.0f} % of an oracle's, {wrong} wrong",
        detail=f"{patrols.total('served')} of {patrols.total('ships')} ships were served in {patrols.hours:.1f} h,"
        f" {per_hour:.1f} an hour; {violations} keep-out violations.",
        failures=[f"{row['flight_id']}: {row['message']}" for _, row in rows.iterrows() if row["message"]],
        figures=figures,
    )


def _least(distances: Array) -> str:
    """Return the least of some distances [m], of those that are known."""
    return f"{np.nanmin(distances):.0f} m" if np.isfinite(distances).any() else "–"
