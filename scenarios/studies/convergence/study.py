"""The convergence study: the paper's steering laws from many random starts."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import pandas as pd

from common.run_layout import COUNTEREXAMPLES, SUMMARY, trajectory_path
from common.verdict import RunVerdict
from gnc.analysis.ensemble import DISTANCE_CONVERGED, PHI_CONVERGED, Outcome
from gnc.analysis.ensemble_motion import Vehicle
from gnc.errors import InfeasibleError
from gnc.paper import look_ahead
from scenarios.engine.journal import Journal
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import Fly, Progress, StudySummary, write_columns
from scenarios.engine.task import Result, Row, Task
from scenarios.errors import InputError
from scenarios.scenario.sections.convergence import ConvergenceScenario
from scenarios.studies.convergence.ensemble import (
    COLUMNS,
    Block,
    convergence_blocks,
    convergence_table,
    counterexamples,
    fly_block,
    trajectory_of,
)
from scenarios.studies.manifest import initial_manifest, write_logo

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
        """Return the result of a block whose process was lost: a row for each of its trajectories."""
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
        self, scenario: ConvergenceScenario, name: str, *, overrides: Sequence[str] = ()
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
                f"{self.planned} trajectories planned, {len(frame)} done: {int(converged.sum())} converged",
                *lines,
            ],
            manifest={
                "outcomes": {
                    name: int((frame["outcome"] == name).sum())
                    for name in (*(o.value for o in Outcome), _LOST)
                }
            },
        )
