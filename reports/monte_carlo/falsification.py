"""What a report shows of a search for the worst flight: how the search went, and the flights that
it kept.
"""

from typing import Any

import numpy as np
import pandas as pd

from reports.document.blocks import Block, Heading, Section, Table, Text
from reports.document.chart import Chart, Line, Panel, Style
from reports.document.palette import Meaning, series_colour
from reports.document.tables import approach, beside_limit
from reports.run.columns import beside_vessel, clearance, violated
from reports.run.faults import faults_name
from reports.run.run_data import RunData

_POINTS_MAX = 4000
"""Flights that are shown, at most: the worst, and an even sample of the others."""

_LISTED_MAX = 12
"""Violations that are listed by name, at most."""

_MARKS: tuple[Style, ...] = ("points", "diamonds", "square", "ring", "cross")
"""Of the methods: they are told apart in grey, too."""

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
        method_table(flights),
        Heading("Worst flights"),
        Text(_about_worst(config, search)),
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


_SHALLOW = 0.05
"""Depth below which a violation is 0.0 m to one digit [m]."""


def method_name(name: str) -> str:
    """Return what a search method is called."""
    return _IN_WORDS.get(name, name.rpartition(":")[2].replace("_", " "))


def _depth(metres: float) -> str:
    """Return how deep a violation is to 0.1 m, and a shallower one with the digits that it takes."""
    return f"{metres:.1f}" if metres >= _SHALLOW else beside_limit(metres, 0.0, 1)


def _in_words(config: dict[str, Any], search: dict[str, Any], flights: pd.DataFrame) -> str:
    settings = config["search"]
    searched = flights[flights["confirms"] == ""]
    least, inside = float(np.min(clearance(searched))), int(violated(searched).sum())
    found = (
        f"The closest that it found stayed {approach(least, 0.0)} m outside the keep-out area."
        if least >= 0.0
        else f"{inside:,} of the flights violated the keep-out area, the deepest by {_depth(-least)} m."
    )
    again = float(np.min(clearance(flights)))
    if least > again >= 0.0:
        found += f" The closest repeat with fresh noise stayed {approach(again, 0.0)} m outside."
    methods = _methods(settings["methods"], set(searched["search_method"]))
    budget = (
        f"{settings['generations'] + 1} turns of {settings['population']} points"
        if settings["time_s"] is None
        else f"turns of {settings['population']} points for {settings['time_s']:g} s"
    )
    # Of points within what is declared some may have no flight: they cannot be planned, or their
    # process was lost.
    within = sum(of["flights"] for name, of in search["methods"].items() if name != _CONFIRMATION)
    unmeasured = within - len(searched)
    left_out = (
        f"; {unmeasured:,} more {'was' if unmeasured == 1 else 'were'} not flown or not measured"
        if unmeasured > 0
        else ""
    )
    if (beyond := search["proposed"] - within) > 0:
        points = (
            "point was not flown, as it lies"
            if beyond == 1
            else "points were not flown, as they lie"
        )
        left_out += f"; {beyond:,} more {points} beyond what the scenario declares"
    return (
        f"A search over {len(config['draws'])} inputs within their declared ranges by {methods}: {budget}, {len(searched):,}"
        f" flights{left_out}. {found} A search finds the worst flight within its budget and proves no bound."
    )


def _methods(asked: list[str], flown: set[str]) -> str:
    """Return the methods of which points were flown, and those of which none was: they had no turn,
    or no point that could be.
    """
    had = [method_name(name) for name in asked if name in flown]
    without = [method_name(name) for name in asked if name not in flown]
    if not had or not without:
        return ", ".join(had or without)
    return f"{', '.join(had)} (no point of {', '.join(without)} was flown)"


def _about_worst(config: dict[str, Any], search: dict[str, Any]) -> str:
    settings, worst = config["search"], search["worst"]
    repeats = (
        f" Each was repeated {settings['confirmations']} times with fresh noise, gusts and reports: where few of these violate the"
        " keep-out area, it took a particular realisation."
        if settings["confirmations"]
        else ""
    )
    violations = [entry["flight_id"] for entry in search["violations"]]
    more = (
        f" and {len(violations) - _LISTED_MAX:,} more, which the manifest lists"
        if len(violations) > _LISTED_MAX
        else ""
    )
    listed = (
        f" Violations, the worst first: {', '.join(violations[:_LISTED_MAX])}{more}."
        if violations
        else ""
    )
    return (
        f"The {len(worst)} closest flights that differ from one another; they are in the directory worst/, as scenario files that"
        f" replay them identically.{repeats}{listed}"
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
        Line(x=number[[0, -1]], y=np.zeros(2), label="r_min", colour=Meaning.LIMIT, style="dash"),
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
    caption = "Closest approach of each flight, in the order of the search; the tenth that stayed farthest away is left out."
    return Chart(name="search", caption=caption, panels=[panel])


def method_table(flights: pd.DataFrame) -> Table:
    """Return what each method has found."""
    rows = []
    for name in dict.fromkeys(flights["search_method"]):
        own = flights[flights["search_method"] == name]
        inside = np.flatnonzero(violated(own))
        first = str(own["flight_id"].iloc[inside[0]]) if len(inside) else "–"
        least = f"{float(np.min(clearance(own))):.1f}"
        rows.append([method_name(name) or "any", f"{len(own):,}", f"{len(inside):,}", first, least])
    head = ["Method", "Flights", "Violations", "First violation", "Closest beyond r_min [m]"]
    return Table(
        caption="What each method has found.",
        head=head,
        rows=rows,
        widths=[1.6, 0.8, 0.8, 1.4, 1.4],
        left_columns=1,
    )


def worst_table(flights: pd.DataFrame, worst: list[dict[str, Any]]) -> Table:
    """Return the flights that came closest, the worst first."""
    by_name = flights.set_index("flight_id")
    rows = []
    for i, entry in enumerate(worst, start=1):
        if entry["flight_id"] not in by_name.index:
            continue
        row = by_name.loc[entry["flight_id"]]
        repeats, nearest = entry["confirmations"], entry["confirmations_nearest_m"]
        rows.append(
            [
                str(i),
                str(entry["flight_id"]),
                method_name(entry["method"]),
                approach(entry["clearance_m"], 0.0),
                f"{entry['confirmations_violating']} of {repeats}" if repeats else "–",
                approach(nearest, 0.0) if nearest is not None else "–",
                f"{float(row['keepout_margin_m']):.1f}",
                faults_name(row),
                f"{float(row['nu_min']):.2f}–{float(row['nu_max']):.2f}",
                f"{float(row['wind_speed_mps']):.1f}",
                str(row["turbulence"]),
                f"{float(row['guard_time_s']):.1f}",
            ]
        )
    head = [
        "", "Flight", "Method", "Beyond r_min [m]", "Repeats that violate", "Closest of them [m]", "Planned margin [m]", "Fault",
        "ν", "Wind [m/s]", "Turbulence", "Guard [s]",
    ]  # fmt: skip
    widths = [0.3, 1.3, 1.9, 0.8, 0.9, 0.9, 0.9, 1.5, 1.0, 0.7, 1.1, 0.7]
    return Table(head=head, rows=rows, widths=widths, left_columns=3)
