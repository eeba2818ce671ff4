"""The report of flights: its sections are by what the run has."""

from functools import partial
from typing import Any

import pandas as pd

from reports.design.section import design_words
from reports.document.blocks import Block, Findings, Section, Text, folded
from reports.document.chart import Chart
from reports.document.panels import COUNTED_MIN
from reports.finding.searches import finding_sections, searching_variants
from reports.flights.added import added_sections
from reports.flights.comparison import comparison_section
from reports.flights.first_page import flights_in_words, telling_and_typical
from reports.flights.names import flight_name, flown_elsewhere, name_in_run, swept_column
from reports.flights.parameter_tables import trial_parameters
from reports.flights.selection import flight_section
from reports.flights.trials.charts import trial_charts
from reports.flights.trials.tables import (
    criteria_table,
    failed_blocks,
    fault_table,
    flight_table,
    tracking_lines,
    trial_table,
)
from reports.flights.verdict import Answer, flight_verdict, kept_out_and_finished
from reports.measurement.data import flown_facts
from reports.measurement.flights import sulphur_sections
from reports.measurement.method import is_of_the_method
from reports.monte_carlo.content import monte_carlo_sections
from reports.monte_carlo.falsification import falsification_sections
from reports.run.columns import flights_flown
from reports.run.run_data import RunData
from reports.run.trials import Kind, Trial, read_trials

_LISTED_MAX = 12
"""Flights of a run's only trial that are all listed; of a sweep they are, however many."""


def flights_content(run: RunData, answer: Answer = kept_out_and_finished) -> Findings:
    """Return the findings of flights.

    Parameters
    ----------
    run : the run
    answer : to the question of its study, with which page 1 begins
    """
    trials = read_trials(run)
    by_key = {trial.key: trial for trial in trials}

    def name(row: "pd.Series[Any]") -> str:
        return name_in_run(by_key[row["trial"]], row)

    of_search, of_fuel = finding_sections(run, trials, name), sulphur_sections(run, name)
    of_flights = [
        *(_trial(trial, only=len(trials) == 1) for trial in trials if len(trial.rows)),
        *added_sections(run, trials, name),
        comparison_section(run, trials),
    ]
    of_probabilities, of_worst = monte_carlo_sections(run), falsification_sections(run)
    # Whether these flights keep out is then not the question.
    is_search = bool(searching_variants(run))
    asks_otherwise = is_of_the_method(run) or is_search
    if is_search:
        of_fuel = [folded(of) for of in of_fuel]
    if asks_otherwise:
        of_probabilities = [folded(of) for of in of_probabilities]
    # Flights that a search leads are no sample, and say nothing by how they are spread.
    if asks_otherwise or of_worst:
        of_flights = [folded(of) for of in of_flights]
    sections = [
        *of_probabilities,
        *of_worst,
        *of_search,
        *of_fuel,
        _overview(trials),
        *of_flights,
        Section(
            anchor="failed",
            title="Flights that failed a criterion",
            nav_title="Failed",
            blocks=failed_blocks(trials),
        ),
        flight_section(trials, only_failed=asks_otherwise),
        Section(
            anchor="parameters",
            title="Parameters",
            blocks=[
                *trial_parameters(run, trials),
                *design_words(run),
            ],
        ),
    ]
    flown = flights_flown(run.summary)
    return Findings(
        flown=f"{flights_in_words(run, flown)}.",
        verdict=flight_verdict(run, trials, answer),
        # Without a flight the first figure would be that of an aircraft that did not fly.
        picture=(telling_and_typical(trials) or _picture(sections)) if len(flown) else None,
        sections=sections,
        facts=flown_facts(run),
    )


def _picture(sections: list[Section]) -> Chart | None:
    """Return the first figure of a report without a time history: how near flights came, if it is
    that of a Monte Carlo study.
    """
    charts = (block for section in sections for block in section.blocks if isinstance(block, Chart))
    return next(charts, None)


def _overview(trials: list[Trial]) -> Section:
    table = criteria_table(trials)
    criteria = [table] if table.rows else []
    if len(trials) == 1:
        return Section(anchor="trials", title="Criteria", blocks=criteria)
    meaning = (
        "Completed: the aircraft came through, settled, and flew the crossings that were asked for,"
        " or one at least. Met: it kept"
        " out, completed, and met every other criterion. Kept out: known to have kept out to its"
        " end. Distances are from the"
        " keep-out sphere's centre, or horizontal where the keep-out area is a cylinder."
    )
    return Section(
        anchor="trials", title="Trials", blocks=[Text(meaning), trial_table(trials), *criteria]
    )


def _trial(trial: Trial, *, only: bool) -> Section:
    table: list[Block] = []
    if trial.kind is Kind.FAULTS and len(trial.flown):
        table.append(fault_table(trial))
    # A table of one row would repeat page 1.
    if len(trial.rows) > 1 and (trial.swept or (only and len(trial.rows) <= _LISTED_MAX)):
        head, name = swept_column(trial) if trial.swept else ("Flight", partial(flight_name, trial))
        caption = " ".join(["The flights, a row each, with their outcome.", *tracking_lines(trial)])
        table.append(
            flight_table(
                trial.run,
                trial.rows,
                head,
                name,
                caption=caption,
                flown_ratio=flown_elsewhere(trial),
            )
        )
    # The head of the report says what an only trial is.
    text: list[Block] = [] if only else [Text(str(trial.config["description"]))]
    title = (
        trial.title
        if not only
        else "Over the speed ratio"
        if list(trial.swept) == ["nu"]
        else "Flights"
    )
    # A table or page 1 says more of few flights than a figure.
    few = not trial.swept and len(trial.flown) < COUNTED_MIN
    charts = [] if few else trial_charts(trial)
    blocks = [*text, *charts, *table] if trial.swept else [*text, *table, *charts]
    return Section(
        anchor=trial.name,
        title=title,
        nav_title="Speed ratio" if title.startswith("Over") else "",
        blocks=blocks,
    )
