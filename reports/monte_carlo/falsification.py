"""What a report shows of a search for the worst flight: how the search went, and the flights that
it kept.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from reports.document.blocks import Block, Heading, Section, Table, Text
from reports.document.chart import Chart, Line, Panel, Style, across
from reports.document.palette import series_colour
from reports.document.tables import Cell, approach, rows_table
from reports.run.columns import beside_vessel, clearance, least, violated
from reports.run.flight_config import faults_name
from reports.run.run_data import RunData

_POINTS_MAX = 4000
"""Flights that are shown, at most: the worst, and an even sample of the others."""

_MARKS: tuple[Style, ...] = ("points", "diamonds", "square", "ring", "cross")
"""Marks of the methods: they differ in grey, too."""

_CONFIRMATION = "confirmation"
"""What stands for the method of flights that repeat one of the worst."""

_IN_WORDS = {
    "corners": "corner sampling",
    "differential_evolution": "differential evolution",
    "local": "local climb",
    "cma": "CMA-ES",
    _CONFIRMATION: "repeated with fresh noise",
}


_NEAREST = (
    "Nearest of {flown:,} flights: {beyond} m beyond r_min, {flight} (fault {fault},"
    " wind {wind:.1f} m/s); {violated:,} violated, {lost:,} lost, {diverged:,} diverged,"
    " {unknown:,} unknown"
)


def nearest_found(run: RunData) -> str:
    """Return the nearest flight that a search found, where, and what was violated or lost; no word
    of flights without a vessel.
    """
    counts, nearest = run.verdict.counts, run.verdict.whole.closest
    if nearest is None:
        return ""
    row = run.summary[run.summary["flight_id"] == nearest.flight].iloc[0]
    return _NEAREST.format(
        flown=counts.flown,
        beyond=approach(nearest.distance_m - nearest.radius_m, 0.0),
        flight=nearest.flight,
        fault=str(row["fault"]).replace("_", " "),
        wind=row["wind_speed_mps"],
        violated=counts.violated,
        lost=counts.lost - counts.diverged,
        diverged=counts.diverged,
        unknown=counts.unknown,
    )


def falsification_sections(run: RunData) -> list[Section]:
    """Return the section of a run that searched for the worst flight, and none of any other."""
    config = next(iter(run.manifest["trials"].values()))
    search = run.manifest.get("search")
    flights = _searched(run)
    if config.get("study") != "falsify" or search is None or not (flights["confirms"] == "").any():
        return []
    blocks: list[Block] = [
        Text(_in_words(config, search, flights)),
        search_chart(flights),
        method_table(flights, config["search"]["methods"]),
        Heading("Worst flights"),
        Text(_WORST.format(worst=len(search["worst"]), **config["search"])),
        worst_table(flights, search["worst"]),
    ]
    return [Section(anchor="search", title="Worst-case search", nav_title="Search", blocks=blocks)]


def _searched(run: RunData) -> pd.DataFrame:
    """Return the flights that have a closest approach, each with the method that proposed it."""
    flown = beside_vessel(run.summary)
    if "search_method" not in run.draws:
        return flown.assign(search_method="", confirms="")
    labels = run.draws[["flight_id", "search_method", "confirms"]]
    found = flown.merge(labels, on="flight_id", how="left")
    return found.fillna({"search_method": "", "confirms": ""})


def method_name(name: str) -> str:
    """Return what a search method is called."""
    return _IN_WORDS.get(name, name.rpartition(":")[2].replace("_", " "))


_SEARCH = (
    "A search over {inputs} inputs within their declared ranges: {budget}, {flights:,} flights;"
    " {unmeasured:,} more were not flown or not measured, and {beyond:,} points lie beyond what the"
    " scenario declares. A search finds the worst flight within its budget and proves no bound."
)
_TURNS = "{turns} turns of {population} points"
_TIMED = "turns of {population} points for {seconds:g} s"
_WORST = (
    "The {worst} closest flights that differ from one another; they are in the directory worst/, as"
    " scenario files that replay them identically. Each was repeated {confirmations} times with"
    " fresh noise, gusts and reports: where few of these violate the keep-out area, it took a"
    " particular realisation. The manifest lists every violation."
)


def _in_words(config: dict[str, Any], search: dict[str, Any], flights: pd.DataFrame) -> str:
    settings, searched = config["search"], int((flights["confirms"] == "").sum())
    population, seconds = settings["population"], settings["time_s"]
    budget = (
        _TURNS.format(turns=settings["generations"] + 1, population=population)
        if seconds is None
        else _TIMED.format(population=population, seconds=seconds)
    )
    # Some points within what is declared may have no flight: they cannot be planned, or their
    # process was lost.
    within = sum(of["flights"] for name, of in search["methods"].items() if name != _CONFIRMATION)
    return _SEARCH.format(
        inputs=len(config["draws"]),
        budget=budget,
        flights=searched,
        unmeasured=within - searched,
        beyond=search["proposed"] - within,
    )


def search_chart(flights: pd.DataFrame) -> Chart:
    """Return how close to the keep-out area each flight came, by method in the order of the search,
    and the closest so far.
    """
    number, distance = np.arange(len(flights), dtype=np.float64), clearance(flights)
    methods = list(dict.fromkeys(flights["search_method"]))
    shown = np.zeros(len(flights), dtype=np.bool_)
    shown[:: max(1, -(-len(flights) // _POINTS_MAX))] = True
    shown |= violated(flights)
    lines = []
    for i, name in enumerate(methods):
        points = shown & (flights["search_method"] == name).to_numpy()
        label = method_name(name) or "a flight"
        style = _MARKS[i % len(_MARKS)]
        lines.append(
            Line(
                x=number[points],
                y=distance[points],
                label=label,
                colour=series_colour(i),
                style=style,
            )
        )
    lines += [
        Line(x=number, y=np.minimum.accumulate(distance), label="closest so far", colour="grey"),
        across(number[[0, -1]], 0.0, "r_min"),
    ]
    # Flights that stay far away say nothing of the worst.
    highest = float(np.quantile(distance, 0.9))
    least = min(0.0, float(distance.min()))
    room = 0.06 * (highest - least)
    panel = Panel(
        x_label="Flights so far",
        y_label="Distance kept beyond r_min [m]",
        lines=lines,
        y_range=(least - room, highest + room),
        x_whole=True,
    )
    caption = (
        "Closest approach of each flight, in the order of the search; the tenth that stayed"
        " farthest away is left out."
    )
    return Chart(name="search", caption=caption, panels=[panel])


def method_table(flights: pd.DataFrame, methods: Sequence[str]) -> Table:
    """Return what each method has found, also one that had no turn."""
    found = dict.fromkeys([*methods, *flights["search_method"]])
    rows = [(name, flights[flights["search_method"] == name]) for name in found]
    return rows_table(
        [{"name": name, "own": own, "inside": own[violated(own)]} for name, own in rows],
        [
            Cell("Method", lambda of: method_name(of["name"]) or "any", width=1.6),
            Cell("Flights", lambda of: len(of["own"]), "{:,.0f}", 0.8),
            Cell("Violations", lambda of: len(of["inside"]), "{:,.0f}", 0.8),
            Cell("First violation", lambda of: next(iter(of["inside"]["flight_id"]), None)),
            Cell("Closest beyond r_min [m]", lambda of: least(clearance(of["own"])), "{:.1f}"),
        ],
        caption="What each method has found.",
    )


def worst_table(flights: pd.DataFrame, worst: list[dict[str, Any]]) -> Table:
    """Return the flights that came closest, the worst first."""
    by_name = {str(row["flight_id"]): row for row in flights.to_dict("records")}
    cells = [
        Cell("Flight", "flight_id", width=1.3),
        Cell("Method", lambda of: method_name(of["method"]), width=1.9),
        Cell("Beyond r_min [m]", lambda of: approach(of["clearance_m"], 0.0), width=0.8),
        Cell("Repeats that violate", _repeats, width=0.9),
        Cell("Closest of them [m]", _nearest_repeat, width=0.9),
        Cell("Planned margin [m]", "keepout_margin_m", "{:.1f}", 0.9),
        Cell("Fault", faults_name, width=1.5),
        Cell("ν", lambda of: f"{of['nu_min']:.2f}–{of['nu_max']:.2f}"),
        Cell("Wind [m/s]", "wind_speed_mps", "{:.1f}", 0.7),
        Cell("Turbulence", "turbulence", width=1.1),
        Cell("Guard [s]", "guard_time_s", "{:.1f}", 0.7),
    ]
    kept = [by_name[of["flight_id"]] | of for of in worst if of["flight_id"] in by_name]
    return rows_table(kept, cells, left_columns=2)


def _repeats(of: Mapping[str, Any]) -> str:
    return f"{of['confirmations_violating']} of {of['confirmations']}"


def _nearest_repeat(of: Mapping[str, Any]) -> str | None:
    nearest = of["confirmations_nearest_m"]
    return None if nearest is None else approach(nearest, 0.0)
