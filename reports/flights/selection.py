"""Which flights of a run are shown one by one."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from reports.document.blocks import Block, FlightContent, FlightPicker, Section, Text
from reports.document.tables import approach, ending, number, outcome
from reports.flights.first_page import CALM
from reports.flights.names import flown_elsewhere, name_in_run
from reports.flights.single_flight import flight_charts
from reports.flights.tracks import flight_view
from reports.replay.flight_scene import flight_scene
from reports.run.columns import (
    SEVERE,
    beside_vessel,
    by_severity,
    clearance,
    met,
    radii_differ,
    recorded_at,
    severity,
)
from reports.run.flight_config import wind_changes
from reports.run.trials import Trial

PICKED_MAX = 12
"""Flights that are shown one by one, of trials that are not swept."""

SWEPT_MAX = 24
"""Flights of a sweep that are all shown one by one; of longer ones some are."""

_FAILED = "did not meet every criterion"

_CLOSEST, _MEDIAN = "closest approach", "median of closest approaches"

_LEAST_BEYOND, _MEDIAN_BEYOND = (
    "least distance beyond its own r_min",
    "median of least distances beyond r_min",
)
"""The same of flights with different r_min."""

_ALONE = "without a vessel"

_ORDER = (*SEVERE, _FAILED, _CLOSEST, _LEAST_BEYOND, _ALONE)
"""Why flights are shown, the most telling reason first."""

PRINTED_MAX = 1
"""Flights that have a page in print, the most telling first: the page on the screen has all."""

Picked = tuple[Trial, "pd.Series[Any]", str]
"""A flight that is shown: its trial, its row, and why it is."""

_CHOSEN = (
    "{which}: one that lost its aircraft, diverged, violated the keep-out area or failed a"
    " criterion, the closest approach, and the median of closest approaches. report.pdf shows the"
    " first of these that there is."
)
_SWEPT = (
    "report.html shows every flight of the sweep; report.pdf shows {printed} of them: {why}. The"
    " option --all-flights of plume-flight report prints them all."
)
_SWEPT_WITHOUT = (
    "report.html lists every flight of the sweep; none has a time history (histories), and so"
    " report.pdf shows none."
)


def flight_section(trials: list[Trial], *, only_failed: bool = False) -> Section:
    """Return the section of single flights; with ``only_failed``, of flights that are not swept
    those alone are printed that came to grief or failed a criterion.
    """
    swept = len(trials) == 1 and bool(trials[0].swept) and len(trials[0].rows) <= SWEPT_MAX
    picked = picked_flights(trials)
    printed = _printed(picked)
    if only_failed:
        printed = [of for of in printed if picked[of][2] in (*SEVERE, _FAILED)]
    if swept and len(trials[0].rows) > 1:
        telling = {str(picked[i][1]["flight_id"]): picked[i][2] for i in printed}
        flights = [
            _of_sweep(trials[0], row, telling.get(str(row["flight_id"]), ""))
            for _, row in trials[0].rows.iterrows()
        ]
        why = ", ".join(telling.values())
        text = _SWEPT.format(printed=len(telling), why=why) if telling else _SWEPT_WITHOUT
    else:
        flights = [
            replace(_content(trial, row, _state(row, why)), printed=number in printed)
            for number, (trial, row, why) in enumerate(picked)
        ]
        which = "Of each trial" if len(trials) > 1 else "Of the flights"
        text = _CHOSEN.format(which=which) if len(flights) > 1 else _only(trials)
    blocks: list[Block] = [Text(text), FlightPicker(flights=flights)]
    return Section(
        anchor="flights",
        title="Single flights",
        nav_title="Single flights",
        blocks=blocks if flights else [],
    )


def _printed(picked: Sequence[Picked]) -> list[int]:
    """Return the numbers of the flights that are printed: of those with a time history the most
    telling ones.
    """
    ranked = [
        (_ORDER.index(why), number)
        for number, (trial, row, why) in enumerate(picked)
        if why in _ORDER and trial.run.has_history(str(row["flight_id"]))
    ]
    return [number for _, number in sorted(ranked)[:PRINTED_MAX]]


def _only(trials: list[Trial]) -> str:
    """Return what is said above a flight that is shown alone."""
    (trial,) = [trial for trial in trials if len(trial.rows)][:1] or trials[:1]
    if sum(len(trial.rows) for trial in trials) > 1:
        return "The flight that is shown stands for the others."
    shown = bool(trial.run.with_history(trial.flown).any())
    return f"The only flight{'; Figure 1 shows its track' * shown}."


def _of_sweep(trial: Trial, row: "pd.Series[Any]", why: str) -> FlightContent:
    """Return a flight of a sweep, and ``why`` it is printed; no word where it is not."""
    state = f"{outcome(row)}, {why}" if why and row["criteria_met"] else outcome(row)
    return replace(_content(trial, row, state), printed=bool(why))


def _content(trial: Trial, row: "pd.Series[Any]", state: str) -> FlightContent:
    name = name_in_run(trial, row)
    speed = "{:.1f} m/s" + " at the start" * wind_changes(trial.flight_config(row))
    nearest = approach(
        float(row.get("min_distance_m", math.nan)), float(row.get("keepout_radius_m", math.nan))
    )
    known = [
        ("", "min_distance_m", f"{nearest} m"),
        ("ν = ", "nu", "{:.2f}"),
        ("wind ", "wind_speed_mps", speed),
    ]
    given = {key.replace("wind.speed_mps", "wind_speed_mps") for key in trial.swept}
    if flown_elsewhere(trial):
        known[1], given = ("flown at ν = ", "nu", "{:.2f}"), given - {"nu"}
    flown = not pd.isna(row.get("duration_s"))
    if float(row.get("wind_speed_mps") or 0.0) < CALM:
        given = given | {"wind_speed_mps"}
    shown = [
        item for item in known if flown and item[1] not in given and not pd.isna(row.get(item[1]))
    ]
    # A name, its figure and its unit stay on one line.
    world = ", ".join(
        f"{words}{number(row[key], pattern)}".replace(" ", "\N{NO-BREAK SPACE}")
        for words, key, pattern in shown
    )
    # Page 1 shows the tracks of a run's only flight.
    alone = len(trial.run.summary) == len(trial.flown) == 1
    view = flight_view(trial, row)
    return FlightContent(
        flight_id=str(row["flight_id"]),
        label=f"{name} · {state.split(':', maxsplit=1)[0]}",
        # What to do about a flight that could not be flown the verdict says.
        title=f"{name}: {state}{f' ({world})' if world else ''}"
        if flown
        else f"{name}: not flown, {ending(row)}",
        charts=flight_charts(view)[int(alone) :],
        scene=flight_scene(trial, row, view.whole) if view else None,
    )


def _state(row: "pd.Series[Any]", why: str) -> str:
    return why if row["criteria_met"] or why in (*SEVERE, _FAILED) else f"{why}, {_FAILED}"


def picked_flights(trials: list[Trial]) -> list[Picked]:
    """Return the flights to be shown, at most ``PICKED_MAX``, in the trials' order, and why each of
    them is.

    Every trial has its most important flight before any has its second, and so on.
    """
    candidates = [list(_candidates(trial)) for trial in trials]
    deep = max((len(flights) for flights in candidates), default=0)
    turns = [
        (i, k) for k in range(deep) for i, flights in enumerate(candidates) if k < len(flights)
    ]
    # Where there are too many trials, those whose flights matter less have none.
    turns.sort(key=lambda turn: (turn[1], _rank(candidates[turn[0]][turn[1]][1])))
    chosen = sorted(turns[:PICKED_MAX])
    return [(trials[i], *candidates[i][k]) for i, k in chosen]


def _rank(why: str) -> int:
    """Return how telling a reason is: its place in ``_ORDER``, and last what is not in it."""
    return _ORDER.index(why) if why in _ORDER else len(_ORDER)


def _candidates(trial: Trial) -> Iterator[tuple["pd.Series[Any]", str]]:
    """Yield a trial's flights to look at, the most important first: one of each sort, none
    twice.
    """
    rows, near = trial.rows, beside_vessel(trial.rows)
    severe = [rows[severity(rows) == place] for place in range(len(SEVERE))]
    failed = rows[~met(rows) & (severity(rows) == len(SEVERE))]
    # The others are chosen for their figures, and need a time history.
    recorded, distances = trial.run.with_history(near), clearance(near)
    least, middle = (_LEAST_BEYOND, _MEDIAN_BEYOND) if radii_differ(near) else (_CLOSEST, _MEDIAN)
    chosen = [
        (by_severity(of).iloc[0], what) for what, of in zip(SEVERE, severe, strict=True) if len(of)
    ]
    if len(failed):
        # One to look at, if there is any.
        shown = failed[trial.run.with_history(failed)]
        chosen.append(((shown if len(shown) else failed).iloc[0], _FAILED))
    if recorded.any():
        chosen.append((near.iloc[int(np.argmin(np.where(recorded, distances, np.inf)))], least))
        typical, median = recorded_at(distances, recorded, len(distances) // 2)
        chosen.append((near.iloc[typical], middle if median else f"nearest to the {middle}"))
    elif len(alone := trial.flown[trial.run.with_history(trial.flown)]):
        chosen.append((alone.iloc[0], _ALONE))
    seen = set()
    for row, why in chosen:
        if row["flight_id"] not in seen:
            seen.add(row["flight_id"])
            yield row, why
