"""Run a convergence study into a directory, block by block, and keep what is done after each."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from gnc.delta import look_ahead
from gnc.ensemble import DISTANCE_CONVERGED, PHI_CONVERGED, Outcome
from gnc.ensemble_motion import Vehicle
from gnc.errors import InfeasibleError
from scenarios.convergence import COLUMNS, counterexamples, run_convergence, trajectory_of
from scenarios.convergence_config import ConvergenceScenario
from scenarios.errors import InputError
from scenarios.manifest import opening_manifest
from scenarios.pool import Progress
from scenarios.run_directory import RunDirectory

_DONE = "done.parquet"
"""What is done, after every block; ``summary.csv`` is the same in text, written at the end."""

_HISTORY_MAX = 10_000.0
"""Longest time history kept [s]; a trajectory can be a hundred times as long, and looks the same from there on."""

_HISTORY_STEP = 2.0
"""Largest step between samples of a time history [s]."""

_KEPT_MAX = 200
"""Counter-examples whose time histories are kept, at most: beyond that there is something else to look at."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ConvergenceResult:
    """How a study ended.

    Attributes
    ----------
    directory : the run directory
    planned : trajectories, times laws
    done : those that were flown
    converged : of law and kind of reference, the number that converged and the number flown
    judged : laws that the verdict is about: those of the theory or, if there are none, all
    interrupted : whether it was stopped before all were flown
    """

    directory: Path
    planned: int
    done: int
    converged: dict[tuple[str, str], tuple[int, int]]
    judged: tuple[str, ...]
    interrupted: bool

    what = "trajectories"

    @property
    def all_met(self) -> bool:
        """Whether every trajectory was flown and, under the laws that the verdict is about, converged."""
        judged = [counts for (law, _), counts in self.converged.items() if law in self.judged]
        return self.done == self.planned and all(converged == flown for converged, flown in judged)

    def lines(self) -> list[str]:
        """Return what happened, in lines of text."""
        total = sum(converged for converged, _ in self.converged.values())
        return [
            f"{self.planned} trajectories planned, {self.done} done: {total} converged",
            *(f"  {law}, {kind}: {converged} of {flown} converged" for (law, kind), (converged, flown) in self.converged.items()),
        ]


def run_study(
    scenario: ConvergenceScenario,
    name: str,
    directory: Path,
    *,
    jobs: int,
    resume: bool,
    progress: Progress,
    overrides: Sequence[str] = (),
) -> ConvergenceResult:
    """Fly a convergence study into ``directory``.

    Parameters
    ----------
    scenario, name : what to fly, and what it is called
    directory : the run directory
    jobs : number of processes
    resume : go on with the unfinished run in ``directory``
    progress : told what happens
    overrides : how the scenario differs from the one of that name, for the record

    Raises
    ------
    InputError : parameters that cannot work, or a directory that cannot be used
    """
    g, ensemble = scenario.guidance, scenario.ensemble
    try:
        vehicle = Vehicle(
            speed=g.airspeed_mps,
            look_ahead=look_ahead(g.epsilon_per_m, g.look_ahead_m),
            gain=g.gain_per_s,
            steering_max=g.steering_max_rad_s,
            k_1=g.lyapunov_gain_per_m2,
            heading_rate_max=g.heading_rate_max_rad_s,
        )
    except InfeasibleError as error:
        raise InputError(f"guidance: {error}") from None
    run = RunDirectory(directory)
    manifest = opening_manifest(scenario, name, overrides)
    run.open(manifest["config_hash"], resume=resume)
    planned = ensemble.trajectories * len(g.laws)
    manifest |= {
        "trajectories_planned": planned,
        "converged_distance_m": DISTANCE_CONVERGED,
        "converged_phi_rad": PHI_CONVERGED,
    }
    run.write_json(run.manifest, manifest)
    began = time.perf_counter()
    frame = run.read_frame(_DONE) if resume else None
    interrupted = False
    try:
        for table in run_convergence(
            trajectories=ensemble.trajectories,
            seed=scenario.seed,
            distance_max=ensemble.distance_max_m,
            vehicle=vehicle,
            settling_band=ensemble.settling_band_m,
            time_max=ensemble.time_max_s,
            laws=g.laws,
            jobs=jobs,
            progress=progress,
            done=frame,
        ):
            frame = table
            run.write_frame(_DONE, frame)
        progress("keeping time histories", planned, planned)
        _keep_histories(run, frame if frame is not None else _empty(), vehicle, scenario)
    except KeyboardInterrupt:
        interrupted = True
    if frame is None:
        frame = _empty()
    run.write_frame("summary.csv", frame)
    run.write_frame("counterexamples.csv", counterexamples(frame))
    groups = frame.groupby(["law", "reference"], sort=False)["outcome"]
    result = ConvergenceResult(
        directory=directory,
        planned=planned,
        done=len(frame),
        converged={
            (str(law), str(reference)): (int((outcomes == Outcome.CONVERGED.value).sum()), len(outcomes))
            for (law, reference), outcomes in groups
        },
        judged=tuple(law for law in g.laws if law != "cascade_cut") or g.laws,
        interrupted=interrupted,
    )
    manifest |= {
        "state": "interrupted" if interrupted else "complete",
        "wall_time_s": time.perf_counter() - began,
        "outcomes": {outcome.value: int((frame["outcome"] == outcome.value).sum()) for outcome in Outcome},
    }
    run.write_json(run.manifest, manifest)
    return result


def _empty() -> pd.DataFrame:
    return pd.DataFrame(columns=list(COLUMNS))


def _keep_histories(run: RunDirectory, frame: pd.DataFrame, vehicle: Vehicle, scenario: ConvergenceScenario) -> None:
    """Write the time histories of the first trajectories and of the counter-examples."""
    run.trajectories.mkdir(exist_ok=True)
    kept = pd.concat([frame[frame["trajectory"] < scenario.ensemble.samples], counterexamples(frame).head(_KEPT_MAX)])
    kept["duration_s"] = kept["duration_s"].clip(upper=_HISTORY_MAX)
    for _, row in kept.drop_duplicates(["trajectory", "law"]).iterrows():
        history = trajectory_of(row, vehicle=vehicle, settling_band=scenario.ensemble.settling_band_m, step_max=_HISTORY_STEP)
        run.write_frame(f"{run.trajectories.name}/{row['law']}_{row['trajectory']:05d}.parquet", history)
