"""The convergence study: the paper's steering laws from many random starts."""

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from common.columns import Column, Table, described
from common.run_layout import SUMMARY
from common.verdict import RunVerdict
from extensions.convergence import COUNTEREXAMPLES, trajectory_path
from extensions.convergence.ensemble import (
    DISTANCE_CONVERGED,
    PHI_CONVERGED,
    EnsembleResult,
    Outcome,
    Tolerances,
    fly_ensemble,
)
from extensions.convergence.motion import Steering, Vehicle
from extensions.convergence.references import (
    REFERENCES,
    Case,
    TurningReferences,
    averaged_settling_time,
    draw_case,
    references_of,
)
from extensions.convergence.scenario import ConvergenceScenario
from gnc.errors import InfeasibleError
from gnc.paper import look_ahead
from scenarios.engine.journal import Journal
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import Fly, Progress, StudySummary, write_columns
from scenarios.engine.task import Result, Row, Task
from scenarios.errors import InputError
from scenarios.studies.manifest import initial_manifest, write_logo

BLOCK = 1250
"""Largest number of trajectories in a task."""
TIME_FACTOR = 20.0
"""Time limit of a trajectory over the prediction by averaged motion; the slowest of 20,000 took 7
times as long.
"""
TIME_FACTOR_CUT = 2.0
"""The same for cut commands, with which some trajectories never converge."""
TIME_FACTOR_STRAIGHT = 10.0
"""Least time limit for cut commands over the time of a straight flight, at the speed left by
turning.
"""

COLUMNS = described(
    {
        "trajectory": "number of the start",
        "law": Column("steering law", kind="text"),
        "reference": Column("kind of the reference", kind="text"),
        "reference_heading_rate_max_rad_s": "largest heading rate of the reference",
        "start_north_m": "position of the start relative to the reference",
        "start_east_m": "position of the start relative to the reference",
        "start_distance_m": "distance of the start from the reference",
        "start_course_rad": "course at the start",
        "reference_course_rad": "course of the reference at the start",
        "start_phi_rad": "phi at the start, equation (19)",
        "outcome": Column("whether it settled", kind="text"),
        "message": Column("the reason if it did not", kind="text"),
        "settling_time_s": Column(
            "time from which it stayed within the settling band",
            title="Settling time",
            digits=1,
            worse="higher",
            missing="not settled",
        ),
        "settling_time_predicted_s": "settling time predicted by the averaged motion",
        "distance_final_m": "distance to the reference at the end",
        "phi_final_rad": "phi at the end",
        "duration_s": Column(
            "time over which the motion was integrated", title="Flight time", digits=1, adds_up=True
        ),
        "distance_max_m": "largest distance to the reference",
        "heading_rate_max_rad_s": "largest heading rate",
        "reference_terms": Column(
            "heading rate of the reference as JSON: its mean, and amplitude, frequency and phase"
            " of each oscillation",
            kind="text",
        ),
    }
)
"""Columns of the table, in order; a trajectory that did not settle has no settling time."""

TABLES: Mapping[str, Table] = {
    "summary.csv and counterexamples.csv, of a study of convergence": COLUMNS
}

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Block:
    """Trajectories of one law and one kind of reference that are integrated together."""

    law: Steering
    vehicle: Vehicle
    cases: tuple[Case, ...]
    predicted: Array
    settling_band: float
    time_max: Array


def convergence_blocks(
    *,
    trajectories: int,
    seed: int,
    distance_max: float,
    vehicle: Vehicle,
    settling_band: float,
    time_max: float,
    laws: Sequence[str],
) -> list[Block]:
    """Return a study's trajectories, one per start and law, in blocks that are integrated together;
    the longest first.

    Starts are uniform over the disc about the reference, their courses uniform; the references are
    a circle, an oscillation and a random course in turn. The rows of a block depend neither on the
    other laws nor on the other blocks, bit for bit.

    Parameters
    ----------
    trajectories, seed : number of trajectories, and the seed of their random starts
    distance_max : of the starts [m]
    vehicle : the vehicle; oscillations are designed for its heading_rate_max
    settling_band : distance below which a trajectory counts as settled [m]
    time_max : limit [s]; starts from which more time is predicted get more
    laws : values of ``extensions.convergence.motion.Steering``
    """
    cases = [
        draw_case(seed, trajectory, distance_max, vehicle.speed, vehicle.heading_rate_max)
        for trajectory in range(trajectories)
    ]
    blocks = [
        block
        for law in laws
        for block in _blocks(
            Steering(law), vehicle, cases, settling_band=settling_band, time_max=time_max
        )
    ]
    # The longest first, so that the last block to finish is a short one.
    return sorted(blocks, key=lambda block: -float(block.time_max.max()))


def convergence_table(rows: Iterable[Row], laws: Sequence[str]) -> pd.DataFrame:
    """Return rows by trajectory and then in the order of ``laws``, with columns ``COLUMNS``."""
    order = {law: i for i, law in enumerate(laws)}
    ordered: list[Row] = sorted(rows, key=lambda row: (row["trajectory"], order[row["law"]]))
    return pd.DataFrame(ordered, columns=list(COLUMNS))


def counterexamples(frame: pd.DataFrame) -> pd.DataFrame:
    """Return the rows that did not converge."""
    return frame[frame["outcome"] != Outcome.CONVERGED.value]


def trajectory_of(
    row: pd.Series, *, vehicle: Vehicle, settling_band: float, step_max: float = 0.5
) -> pd.DataFrame:
    """Return the time history of one row, integrated again with steps of at most ``step_max`` [s].

    Columns: time_s, north_m, east_m, course_rad of the vehicle, the same of the reference (which
    starts at 0, 0), distance_m, phi_rad and heading_rate_rad_s. It ends where the row ends, to
    within the tolerances of the integration.
    """
    terms = json.loads(row["reference_terms"])
    references = TurningReferences(
        course=[row["reference_course_rad"]],
        rate=[terms["rate"]],
        **{
            name: np.array(terms[name], dtype=float).reshape(-1, 1)
            for name in ("amplitude", "frequency", "phase")
        },
    )
    steps: list[tuple[float, ...]] = []

    def observe(
        _: npt.NDArray[np.int64], time: Array, state: Array, phi: Array, command: Array
    ) -> None:
        steps.append(
            (
                float(time[0]),
                float(state[0, 0]),
                float(state[1, 0]),
                float(phi[0]),
                float(command[0]),
            )
        )

    fly_ensemble(
        Steering(row["law"]),
        vehicle,
        references,
        to_reference=[[-row["start_north_m"]], [-row["start_east_m"]]],
        course=[row["start_course_rad"]],
        settling_band=settling_band,
        time_max=row["duration_s"],
        tolerances=Tolerances(step_max=step_max),
        observe=observe,
    )
    time, to_north, to_east, phi, command = np.array(steps).T
    course_r = _course(references, time)
    north_r, east_r = _reference_track(references, vehicle.speed, time)
    delta = vehicle.look_ahead.epsilon * (to_north**2 + to_east**2) + vehicle.look_ahead.radius
    course_z = np.arctan2(to_east + delta * np.sin(course_r), to_north + delta * np.cos(course_r))
    return pd.DataFrame({
        "time_s": time,
        "north_m": north_r - to_north,
        "east_m": east_r - to_east,
        "course_rad": course_z + phi,
        "reference_north_m": north_r,
        "reference_east_m": east_r,
        "reference_course_rad": course_r,
        "distance_m": np.hypot(to_north, to_east),
        "phi_rad": phi,
        "heading_rate_rad_s": command,
    })  # fmt: skip


def _course(references: TurningReferences, time: Array) -> Array:
    """Return the course of one reference at many times [rad]."""
    return references.take(np.zeros(len(time), dtype=np.int64)).course_at(time)


def _reference_track(
    references: TurningReferences, speed: float, time: Array
) -> tuple[Array, Array]:
    """Return north and east [m] of one reference: its velocity integrated by Gauss's rule of three
    points.
    """
    nodes, weights = np.polynomial.legendre.leggauss(3)
    step = np.diff(time)
    north, east = np.zeros_like(step), np.zeros_like(step)
    for node, weight in zip(nodes, weights, strict=True):
        course = _course(references, time[:-1] + 0.5 * step * (1.0 + node))
        north += 0.5 * weight * speed * step * np.cos(course)
        east += 0.5 * weight * speed * step * np.sin(course)
    return np.concatenate([[0.0], np.cumsum(north)]), np.concatenate([[0.0], np.cumsum(east)])


def _blocks(
    law: Steering, vehicle: Vehicle, cases: Sequence[Case], *, settling_band: float, time_max: float
) -> Iterator[Block]:
    """Yield the trajectories in blocks of one kind of reference, the longest first.

    A block takes as long as its longest trajectory, so trajectories of similar length share a
    block.
    """
    for kind in REFERENCES:
        chosen = [case for case in cases if case.kind == kind]
        if not chosen:
            continue
        references = references_of(chosen)
        to_reference = -np.array([[case.north for case in chosen], [case.east for case in chosen]])
        predicted = averaged_settling_time(
            vehicle.look_ahead, vehicle.speed, references, to_reference, settling_band
        )
        limit = averaged_settling_time(
            vehicle.look_ahead, vehicle.speed, references, to_reference, DISTANCE_CONVERGED
        )
        limit *= TIME_FACTOR_CUT if law is Steering.CASCADE_CUT else TIME_FACTOR
        if law is Steering.CASCADE_CUT:
            # While the reference turns once, the vehicle turns once at omega_max; the fraction 1 -
            # omega_r/omega_max of that time remains to fly straight.
            straight = vehicle.speed * (1.0 - np.abs(references.rate) / vehicle.heading_rate_max)
            limit = np.maximum(limit, TIME_FACTOR_STRAIGHT * np.hypot(*to_reference) / straight)
        limit = np.maximum(limit, time_max)
        order = np.argsort(-limit, kind="stable")
        for first in range(0, len(chosen), BLOCK):
            which = order[first : first + BLOCK]
            yield Block(
                law=law,
                vehicle=vehicle,
                cases=tuple(chosen[i] for i in which),
                predicted=predicted[which],
                settling_band=settling_band,
                time_max=limit[which],
            )


def fly_block(block: Block) -> list[Row]:
    """Return the rows of a block."""
    result = fly_ensemble(
        block.law,
        block.vehicle,
        references_of(block.cases),
        to_reference=-np.array(
            [[case.north for case in block.cases], [case.east for case in block.cases]]
        ),
        course=[case.course for case in block.cases],
        settling_band=block.settling_band,
        time_max=block.time_max,
    )
    return [_row(block, result, i) for i in range(len(block.cases))]


def _row(block: Block, result: EnsembleResult, i: int) -> Row:
    case = block.cases[i]
    return {
        "trajectory": case.trajectory,
        "law": block.law.value,
        "reference": case.kind,
        "reference_heading_rate_max_rad_s": abs(case.rate)
        + sum(abs(term.amplitude) for term in case.terms),
        "start_north_m": case.north,
        "start_east_m": case.east,
        "start_distance_m": float(np.hypot(case.north, case.east)),
        "start_course_rad": case.course,
        "reference_course_rad": case.reference_course,
        "start_phi_rad": float(result.phi_0[i]),
        "outcome": result.outcome[i].value,
        "message": result.message[i],
        "settling_time_s": float(result.settling_time[i]),
        "settling_time_predicted_s": float(block.predicted[i]),
        "distance_final_m": float(result.distance[i]),
        "phi_final_rad": float(result.phi[i]),
        "duration_s": float(result.duration[i]),
        "distance_max_m": float(result.distance_max[i]),
        "heading_rate_max_rad_s": float(result.heading_rate_max[i]),
        "reference_terms": json.dumps({
            "rate": case.rate,
            "amplitude": [term.amplitude for term in case.terms],
            "frequency": [term.frequency for term in case.terms],
            "phase": [term.phase for term in case.terms],
        }),
    }  # fmt: skip


# ---------------------------------------------------------------- The study

_LOST = "lost"
"""Outcome of a trajectory whose process was lost."""

_HISTORY_MAX = 10_000.0
"""Longest time history that is written [s]; a trajectory can be a hundred times as long, with
nothing new to see.
"""

_HISTORY_STEP = 2.0
"""Largest step between samples of a time history [s]."""

_KEPT_MAX = 200
"""Largest number of counter-examples whose time histories are written."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ConvergenceWork:
    """Flies blocks of trajectories."""

    blocks: tuple[Block, ...]
    model: Path | None = None

    def moved(self, _: Path) -> "ConvergenceWork":
        """Return the same work: it needs no files."""
        return self

    def run(self, task: Task) -> Result:
        """Fly a block."""
        block = self.blocks[task.number]
        return Result(task=task, tables={SUMMARY: fly_block(block)}, items=len(block.cases))

    def lost(self, task: Task, reason: str) -> Result:
        """Return the result of a block whose process was lost: a row for each trajectory."""
        block = self.blocks[task.number]
        rows: list[Row] = [
            {
                "trajectory": case.trajectory,
                "law": block.law.value,
                "reference": case.kind,
                "outcome": _LOST,
                "message": reason,
            }
            for case in block.cases
        ]
        return Result(task=task, tables={SUMMARY: rows}, items=len(rows), lost=True)


class ConvergenceStudy:
    """Many kinematic pursuits from random initial states.

    Parameters
    ----------
    scenario, name : the scenario and its name
    overrides : overrides that were applied to the scenario, recorded in the manifest

    Raises
    ------
    InputError : guidance parameters without a solution
    """

    what = "trajectories"

    def __init__(
        self,
        scenario: ConvergenceScenario,
        name: str,
        *,
        overrides: Sequence[str] = (),
    ) -> None:
        self._scenario = scenario
        g = scenario.guidance
        try:
            self._vehicle = Vehicle(
                speed=g.airspeed_mps,
                look_ahead=look_ahead(g.epsilon_per_m, g.look_ahead_m),
                gain=g.gain_per_s,
                steering_max=g.steering_max_rad_s,
                k_1=g.lyapunov_gain_per_m2,
                heading_rate_max=g.heading_rate_max_rad_s,
            )
        except InfeasibleError as error:
            raise InputError(f"guidance: {error}") from None
        self.planned, self.comparisons = scenario.ensemble.trajectories * len(g.laws), 0
        self._manifest = initial_manifest(scenario, name, overrides)
        self.config_hash = str(self._manifest["config_hash"])

    def initial_manifest(self) -> dict[str, Any]:
        """Return the manifest as written before the first trajectory."""
        return self._manifest | {
            "not_compared": "which has no flights to compare",
            "trajectories_planned": self.planned,
            "converged_distance_m": DISTANCE_CONVERGED,
            "converged_phi_rad": PHI_CONVERGED,
        }

    @cached_property
    def _blocks(self) -> tuple[Block, ...]:
        ensemble = self._scenario.ensemble
        blocks = convergence_blocks(
            trajectories=ensemble.trajectories,
            seed=self._scenario.seed,
            distance_max=ensemble.distance_max_m,
            vehicle=self._vehicle,
            settling_band=ensemble.settling_band_m,
            time_max=ensemble.time_max_s,
            laws=self._scenario.guidance.laws,
        )
        return tuple(blocks)

    def work(self, run: RunDirectory) -> ConvergenceWork:
        """Return the work on its blocks, after writing the logo into the run directory."""
        write_logo(self._scenario.report, run)
        return ConvergenceWork(blocks=self._blocks)

    def run(self, fly: Fly, _run: RunDirectory, _journal: Journal) -> None:
        """Fly every block."""
        fly(Task(number=i) for i in range(len(self._blocks)))

    def postprocess(self, run: RunDirectory, journal: Journal, progress: Progress) -> None:
        """Write time histories of the first trajectories and of the counter-examples."""
        progress("writing time histories", self.planned, self.planned)
        frame = self._frame(journal)
        kept = pd.concat(
            [
                frame[frame["trajectory"] < self._scenario.ensemble.samples],
                counterexamples(frame).head(_KEPT_MAX),
            ]
        )
        # A trajectory whose process was lost has no duration to replay.
        kept = kept[kept["duration_s"].notna()]
        kept["duration_s"] = kept["duration_s"].clip(upper=_HISTORY_MAX)
        for _, row in kept.drop_duplicates(["trajectory", "law"]).iterrows():
            band = self._scenario.ensemble.settling_band_m
            history = trajectory_of(
                row, vehicle=self._vehicle, settling_band=band, step_max=_HISTORY_STEP
            )
            run.write_frame(trajectory_path(row["law"], row["trajectory"]), history)

    def export(self, run: RunDirectory, journal: Journal) -> None:
        """Write the tables, sorted: blocks are not in the order of their trajectories."""
        frame = self._frame(journal)
        run.write_frame(SUMMARY, frame)
        run.write_frame(COUNTEREXAMPLES, counterexamples(frame))
        write_columns(run, {SUMMARY: COLUMNS, COUNTEREXAMPLES: COLUMNS})

    def _frame(self, journal: Journal) -> pd.DataFrame:
        return convergence_table(journal.rows(SUMMARY), self._scenario.guidance.laws)

    def summary(self, journal: Journal) -> StudySummary:
        """Return how many trajectories converged."""
        laws = self._scenario.guidance.laws
        frame = self._frame(journal)
        # The verdict is about the laws that the theory covers or, if there are none, about all.
        judged = tuple(law for law in laws if law != "cascade_cut") or laws
        converged = frame["outcome"] == Outcome.CONVERGED.value
        flown = frame.assign(converged=converged).groupby(["law", "reference"], sort=False)[
            "converged"
        ]
        lines = [
            f"  {law}, {kind}: {int(of_kind.sum())} of {len(of_kind)} converged"
            for (law, kind), of_kind in flown
        ]
        as_required = len(frame) == self.planned and bool(
            converged[frame["law"].isin(judged)].all()
        )
        return StudySummary(
            verdict=RunVerdict.of_items(
                self.what,
                planned=self.planned,
                done=len(frame),
                met=int(converged.sum()),
                required_met=as_required,
            ),
            lines=[
                f"{self.planned} trajectories planned, {len(frame)} done: {int(converged.sum())}"
                " converged",
                *lines,
            ],
            manifest={
                "outcomes": {
                    name: int((frame["outcome"] == name).sum())
                    for name in (*(o.value for o in Outcome), _LOST)
                }
            },
        )
