"""What section V of the paper says of its simulations in numbers and statements, each beside what
every vehicle of a run showed, and the verdict that follows.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd

from common.verdict import MET
from reports.document.blocks import Card, Verdict
from reports.document.state import state_words
from reports.document.tables import approach, length, number
from reports.paper.flown import VEHICLES, find_flight
from reports.run.run_data import RunData

INTERVAL_PRINTED, DISTANCE_PRINTED = 9.5, 214.0
"""What section V of the paper publishes of Simulation 3 [s, m]."""

TOLERANCES = {"kinematic": 0.005, "six_dof": 0.02}
"""How close each vehicle has to come to what is published."""

END_DISTANCE_MAX = 0.1
"""Distance to the reference at which a simulation counts as converged [m]."""

RISE_MAX = 1e-6
"""Rise of the distance from one sample to the next that is rounding [m]."""

SHORT = {"kinematic": "kinematic", "six_dof": "six degrees of freedom"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Statement:
    """A statement of the paper.

    Attributes
    ----------
    simulation : "Sim. 3"
    words : what the paper says
    printed : its number, or its word
    brief : what its tile is called
    values : what each vehicle showed, by its fidelity; a dash where it did not fly
    holds : whether that is what the paper says, by fidelity; None where it is not known
    """

    simulation: str
    words: str
    printed: str
    brief: str
    values: dict[str, str]
    holds: dict[str, bool | None]

    @property
    def reproduced(self) -> bool | None:
        """Whether every vehicle showed it; None where one has nothing to show."""
        if None in self.holds.values():
            return None
        return all(self.holds.values())

    @property
    def card(self) -> Card:
        """Return its tile: that it is not reproduced is no failure of a flight."""
        name = f"{self.simulation}: {self.brief}"
        return ReproducedCard(name, self.shown, self.printed, self.reproduced)

    @property
    def claim(self) -> str:
        """Return what the paper says, without the figure that it is tested by."""
        return self.words.partition(":")[0]

    @property
    def shown(self) -> str:
        """Return what the vehicles showed, in their order."""
        return " / ".join(self.values.values())


class ReproducedCard(Card):
    """A statement of the paper, and whether it is reproduced."""

    @property
    def result(self) -> str:
        """Return whether it is reproduced, for a table."""
        return "–" if self.met is None else "reproduced" if self.met else "not reproduced"

    @property
    def judgement(self) -> str:
        """Return whether it is reproduced, and what the paper says."""
        sign = "✓ reproduced" if self.met else "✗ not reproduced"
        return f"{sign}; the paper: {self.limit}"

    @property
    def tone(self) -> str:
        """Return the colour of its tile."""
        return "" if self.met is None else "met" if self.met else "open"


def rows_by_id(run: RunData) -> "dict[str, pd.Series[Any]]":
    """Return the row of every flight, those of comparisons among them."""
    return {
        str(row["flight_id"]): row
        for frame in (run.summary, run.comparison)
        for _, row in frame.iterrows()
    }


def vehicles(run: RunData) -> list[str]:
    """Return the fidelities that the run was to fly."""
    chosen = str(run.manifest["config"]["fidelity"])
    return list(VEHICLES) if chosen == "both" else [chosen]


_DEMAND, _LIMIT = "heading_rate_demand_max_rad_s", "heading_rate_limit_rad_s"
_END = "tracking_error_end_m"


Row = Mapping[Any, Any]
"""The row of a flight."""


@dataclass(frozen=True, slots=True)
class Figure:
    """A figure of a flight by which statements are tested.

    Attributes
    ----------
    column : without which in its row a flight has nothing to show
    text : of the figure, given the row
    holds : whether it is what the paper says, given the row and the vehicle's fidelity; None where
        that is not known
    """

    column: str
    text: Callable[[Row], str]
    holds: Callable[[Row, str], bool | None]


_CONVERGED = Figure(
    _END,
    lambda row: length(float(row[_END])),
    lambda row, _: float(row[_END]) < END_DISTANCE_MAX,
)
"""The distance to the reference at the end of a flight."""


def paper_statements(run: RunData) -> list[Statement]:
    """Return every number and statement of section V, in the order of the simulations' weight."""
    rows = rows_by_id(run)
    second = (row for key, row in rows.items() if key.startswith("sim2_"))
    limit = next((number(row[_LIMIT], "{:g}") for row in second), "–")
    radius = float(run.manifest["config"]["keepout"]["radius_m"])
    duration = number(float(run.summary["duration_s"].max()), "{:.0f}")
    statements = (
        (
            "sim3",
            "smoke plume measurements every",
            f"{INTERVAL_PRINTED:g} s",
            "crossing interval",
            _printed("crossing_interval_mean_s", INTERVAL_PRINTED, "{:.3f} s"),
        ),
        (
            "sim3",
            "distance from the vessel there",
            f"{DISTANCE_PRINTED:g} m",
            "crossing distance",
            _printed("crossing_distance_mean_m", DISTANCE_PRINTED, "{:.2f} m"),
        ),
        (
            "sim3",
            "never enters the keep-out area: closest approach",
            f"> {radius:g} m",
            "closest approach",
            Figure(
                "min_distance_m",
                lambda row: f"{approach(float(row['min_distance_m']), radius)} m",
                lambda row, _: float(row["keepout_violations"]) == 0.0,
            ),
        ),
        (
            "sim1",
            "converges onto the circle: distance at the end",
            "→ 0",
            "distance at the end",
            _CONVERGED,
        ),
        (
            "sim1",
            "the distance does not rise while |φ| < |φ_r|: largest rise in a sample",
            "none",
            "rise of the distance while |φ| < |φ_r|",
            _rise(run),
        ),
        (
            "sim2_delta",
            "the δ law converges: distance at the end",
            "→ 0",
            "δ law, distance at the end",
            _CONVERGED,
        ),
        (
            "sim2_delta",
            "the δ law has a feasible heading rate: largest demand",
            f"≤ ω_max = {limit} rad/s",
            "demand of the δ law",
            Figure(_DEMAND, _demand, lambda row, _: float(row[_DEMAND]) <= float(row[_LIMIT])),
        ),
        (
            "sim2_los",
            "the line of sight saturates: largest demand",
            f"> ω_max = {limit} rad/s",
            "demand of the line of sight",
            Figure(_DEMAND, _demand, lambda row, _: float(row[_DEMAND]) > float(row[_LIMIT])),
        ),
        (
            "sim2_los",
            f"the line of sight converges fast: distance after {duration} s",
            "fast convergence",
            f"line of sight, distance after {duration} s",
            _CONVERGED,
        ),
    )
    return [
        _statement(rows, vehicles(run), case, words, printed, brief, figure)
        for case, words, printed, brief, figure in statements
    ]


def _statement(
    rows: Mapping[str, Any],
    flown: Sequence[str],
    case: str,
    words: str,
    printed: str,
    brief: str,
    figure: Figure,
) -> Statement:
    """Return a statement on a case, with what each vehicle showed."""
    found = {fidelity: rows.get(f"{case}_{fidelity}") for fidelity in flown}
    known = {
        fidelity: row if row is not None and pd.notna(row[figure.column]) else None
        for fidelity, row in found.items()
    }
    return Statement(
        simulation=f"Sim. {case.removeprefix('sim')[0]}",
        words=words,
        printed=printed,
        brief=brief,
        values={of: "–" if row is None else figure.text(row) for of, row in known.items()},
        holds={of: None if row is None else figure.holds(row, of) for of, row in known.items()},
    )


def _printed(column: str, value: float, pattern: str) -> Figure:
    """Return a figure that the paper prints as a number."""
    return Figure(
        column,
        lambda row: number(row[column], pattern),
        lambda row, fidelity: abs(float(row[column]) / value - 1.0) <= TOLERANCES[fidelity],
    )


def _demand(row: Row) -> str:
    return number(row[_DEMAND], "{:.3f} rad/s")


def _rise(run: RunData) -> Figure:
    """Return the largest rise of the distance where it should not rise."""

    def of(row: Row) -> float:
        return _rise_once_inside(run, str(row["flight_id"]))

    return Figure(
        _END,
        lambda row: _rise_words(of(row)),
        lambda row, _: None if math.isnan(of(row)) else of(row) < RISE_MAX,
    )


def _rise_once_inside(run: RunData, flight_id: str) -> float:
    """Return the largest rise of the distance between samples that both have |phi| < |phi_r|, eq.
    (35) [m]; not a number without a time history.
    """
    flown = find_flight(run, flight_id)
    if flown is None:
        return math.nan
    phi, phi_r = np.abs(flown.column("phi_rad")), np.abs(flown.column("phi_r_rad"))
    inside = np.maximum(phi[:-1], phi[1:]) < np.minimum(phi_r[:-1], phi_r[1:])
    return float(np.max(np.diff(flown.distance)[inside], initial=0.0))


def _rise_words(rise: float) -> str:
    return "none" if rise < RISE_MAX else number(1000.0 * rise, "{:.2g} mm")


_REPRODUCED = "Reproduced on {vehicles}: {held} of the {tested} numbers and statements of section V"
_NOT = "; not: {claims}"
_MISSED = "{claim} ({values})"
_VEHICLES = {True: "both vehicles", False: "the {name} vehicle"}
_UNTESTED = "{left} of {all} statements could not be tested"
_VIOLATED = "{violations} keep-out violations in Simulation 3"
_LOST = "{lost} of {planned} flights lost their aircraft or diverged"
_DETAIL = "Values are those of {vehicles}. {met} of {planned} flights met the scenario's criteria."
_RESUME = "The run did not end; continue it with --resume."


def paper_verdict(run: RunData) -> Verdict:
    """Return which statements of the paper are reproduced and which are not."""
    statements, verdict, counts = paper_statements(run), run.verdict, run.verdict.counts
    tested = [of for of in statements if of.reproduced is not None]
    failed = run.summary[~run.summary["criteria_met"]]
    names = " / ".join(
        f"the vehicle with {SHORT[of]}" if of == "six_dof" else "the kinematic vehicle"
        for of in vehicles(run)
    )
    detail = _DETAIL.format(vehicles=names, met=counts.met, planned=counts.planned)
    found = Verdict(
        holds=not (counts.violated or counts.lost),
        complete=len(tested) == len(statements) and verdict.exit_status == MET,
        headline=". ".join(_headline(run, statements)),
        detail=detail if verdict.is_done else f"{detail} {_RESUME}",
        failures=[
            f"{row['flight_id']}: {str(row['outcome']).replace('_', ' ')}, {row['message']}"
            for _, row in failed.iterrows()
        ],
        figures=[of.card for of in tested],
    )
    # The others stand in the table of all statements.
    return replace(found, figures=found.cards)


def _headline(run: RunData, statements: Sequence[Statement]) -> list[str]:
    verdict, counts, flown = run.verdict, run.verdict.counts, vehicles(run)
    sentences = state_words(
        "flights",
        counts.done,
        counts.planned,
        is_done=verdict.is_done,
        interrupted=verdict.interrupted,
    )
    if counts.violated:
        sentences.append(_VIOLATED.format(violations=counts.keepout_violations))
    if counts.lost:
        sentences.append(_LOST.format(lost=counts.lost, planned=counts.planned))
    tested = [of for of in statements if of.reproduced is not None]
    missed = [of for of in tested if not of.reproduced]
    reproduced = _REPRODUCED.format(
        vehicles=_VEHICLES[len(flown) > 1].format(name=SHORT[flown[0]]),
        held=len(tested) - len(missed),
        tested=len(tested),
    )
    claims = ", ".join(_MISSED.format(claim=of.claim, values=of.shown) for of in missed)
    sentences.append(reproduced + (_NOT.format(claims=claims) if missed else ""))
    if left := len(statements) - len(tested):
        sentences.append(_UNTESTED.format(left=left, all=len(statements)))
    return sentences
