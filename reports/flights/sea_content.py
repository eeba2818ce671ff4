"""The report of trials over the real sea."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd

from reports.design.section import innerloop_section
from reports.document.blocks import Block, FlightContent, FlightPicker, Heading, Section, Text, Verdict
from reports.document.tables import number
from reports.flights.sea_verdict import sea_verdict
from reports.flights.single_flight import sea_flight_charts
from reports.flights.trial_charts import trial_charts
from reports.flights.trial_tables import criteria_table, fault_table, parameter_blocks, trial_table, unmet_blocks
from reports.monte_carlo.content import monte_carlo_sections
from reports.monte_carlo.falsification import falsify_sections
from reports.run.run_data import RunData
from reports.run.trials import Kind, Trial, clearance, column, entered, read_trials

PICKED_MAX = 12
"""Flights that are shown one by one."""

_ENTRY, _SHORT = "deepest entry", "fell short"


def sea_content(run: RunData) -> tuple[Verdict, list[Section]]:
    """Return the verdict and the sections of the report of trials over the real sea."""
    trials = read_trials(run)
    sections = [
        *monte_carlo_sections(run),
        *falsify_sections(run),
        Section(anchor="trials", title="The trials", nav_title="Trials", blocks=_overview(trials)),
        *(Section(anchor=trial.name, title=trial.title, blocks=_trial(trial)) for trial in trials if len(trial.rows)),
        Section(anchor="unmet", title="Flights that fell short", nav_title="Fell short", blocks=unmet_blocks(run)),
        _flights(trials),
        *([innerloop_section(run.innerloop)] if run.innerloop else []),
        Section(anchor="parameters", title="Parameters", blocks=parameter_blocks(trials)),
    ]
    return sea_verdict(run, trials), sections


def _overview(trials: list[Trial]) -> list[Block]:
    asked = Heading("What was asked beside keeping out, and the worst that was measured")
    return [trial_table(trials), asked, criteria_table(trials)]


def _trial(trial: Trial) -> list[Block]:
    table = [fault_table(trial)] if trial.kind is Kind.FAULTS and len(trial.flown) else []
    return [Text(str(trial.config["description"])), *table, *trial_charts(trial)]


def _flights(trials: list[Trial]) -> Section:
    picked = picked_flights(trials)
    flights = []
    for trial, row, why in picked:
        charts = sea_flight_charts(trial, row)
        name = f"{trial.title}, flight {str(row['flight_id']).rsplit('_', 1)[1].lstrip('0') or '0'}"
        state = "" if row["criteria_met"] or why in (_ENTRY, _SHORT) else ", fell short"
        world = (
            f"ν = {float(row['nu']):.2f}, wind {float(row['wind_speed_mps']):.1f} m/s" if not pd.isna(row["nu"]) else "not flown"
        )
        flights.append(
            FlightContent(
                flight_id=str(row["flight_id"]),
                label=f"{name} · {why}{state}",
                title=f"{name}: {why}{state} ({number(row['min_distance_m'], '{:.1f} m')}, {world})",
                charts=charts,
            )
        )
    blocks: list[Block] = [
        Text(
            f"{len(flights)} flights to look at: of each trial those that entered the keep-out area or fell short of what was"
            " asked, the closest approach, and the one whose closest approach is the median. In print each has a page at the end."
        ),
        FlightPicker(flights=flights),
    ]
    return Section(anchor="flights", title="Single flights", nav_title="Flights", blocks=blocks if flights else [])


def picked_flights(trials: list[Trial]) -> list[tuple[Trial, "pd.Series[Any]", str]]:
    """Return the flights to be shown, at most ``PICKED_MAX``, in the trials' order, and why each of them is.

    Every trial has its most telling flight before any has its second, and so on.
    """
    candidates = [list(_candidates(trial)) for trial in trials]
    deep = max((len(flights) for flights in candidates), default=0)
    turns = [(i, k) for k in range(deep) for i, flights in enumerate(candidates) if k < len(flights)]
    chosen = sorted(turns[:PICKED_MAX])
    return [(trials[i], *candidates[i][k]) for i, k in chosen]


def _candidates(trial: Trial) -> Iterator[tuple["pd.Series[Any]", str]]:
    """Yield a trial's flights to look at, the most telling first: one of each sort, none twice."""
    rows, seen = trial.rows, set()
    flown = trial.flown
    inside, unmet = rows[entered(rows)], rows[~rows["criteria_met"] & ~entered(rows)]
    # Of the others, those that have a time history: they are chosen for being looked at.
    recorded = flown[[trial.run.has_history(str(flight_id)) for flight_id in flown["flight_id"]]]
    order = np.argsort(clearance(recorded), kind="stable")
    chosen = []
    if len(inside):
        chosen.append((inside.iloc[int(np.argmax(column(inside, "keepout_depth_m")))], _ENTRY))
    if len(unmet):
        chosen.append((unmet.iloc[0], _SHORT))
    if len(recorded):
        chosen.append((recorded.iloc[int(order[0])], "closest approach"))
        chosen.append((recorded.iloc[int(order[len(order) // 2])], "median of closest approaches"))
    for row, why in chosen:
        if row["flight_id"] not in seen:
            seen.add(row["flight_id"])
            yield row, why
