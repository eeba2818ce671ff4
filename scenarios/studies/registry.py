"""From a scenario file to its study, and flying it."""

from collections.abc import Sequence
from pathlib import Path

from scenarios.engine.executors import Hiring
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import Hire, Progress, RunResult, Study, fly_study
from scenarios.schema.config import Scenario
from scenarios.schema.convergence import ConvergenceScenario
from scenarios.schema.load import AnyStudy
from scenarios.schema.monte_carlo_config import FalsifyScenario, MonteCarloScenario


def study_of(scenario: AnyStudy, name: str, overrides: Sequence[str] = ()) -> Study:
    """Return the study that a scenario file describes.

    Parameters
    ----------
    scenario, name : what to fly, and what it is called
    overrides : how it differs from the one of that name, for the record

    Raises
    ------
    InputError : it cannot be flown
    """
    if isinstance(scenario, Scenario):
        from scenarios.studies.sweep_study import SweepStudy

        return SweepStudy(scenario, name, overrides=overrides)
    if isinstance(scenario, ConvergenceScenario):
        from scenarios.studies.convergence.study import ConvergenceStudy

        return ConvergenceStudy(scenario, name, overrides=overrides)
    if isinstance(scenario, MonteCarloScenario):
        from scenarios.studies.monte_carlo import MonteCarloStudy

        return MonteCarloStudy(scenario, name, overrides=overrides)
    if isinstance(scenario, FalsifyScenario):
        from scenarios.studies.falsification import FalsifyStudy

        return FalsifyStudy(scenario, name, overrides=overrides)
    from scenarios.studies.sea_study import SeaStudy

    return SeaStudy(scenario, name, overrides=overrides)


def run_study(
    scenario: AnyStudy,
    name: str,
    directory: Path,
    *,
    hire: Hire | None = None,
    resume: bool = False,
    progress: Progress = lambda *_: None,
    overrides: Sequence[str] = (),
) -> RunResult:
    """Fly a study into ``directory``.

    Parameters
    ----------
    scenario, name : what to fly, and what it is called
    directory : the run directory
    hire : makes the crew; one process of this machine if not given
    resume : go on with the unfinished run in ``directory``
    progress : told what happens
    overrides : how the scenario differs from the one of that name, for the record

    Raises
    ------
    InputError : it cannot be flown, or not into this directory
    """
    if not resume:
        RunDirectory(directory).refuse_taken()
    progress("preparing", 0, 1)
    study = study_of(scenario, name, overrides)
    return fly_study(study, directory, hire=hire or Hiring(), resume=resume, progress=progress)
