"""Choice of the study that a scenario describes, and its execution."""

from collections.abc import Sequence
from pathlib import Path

from scenarios.engine.executors import ExecutorFactory
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import Progress, RunResult, Study, fly_study
from scenarios.schema.config import Scenario
from scenarios.schema.convergence import ConvergenceScenario
from scenarios.schema.load import AnyStudy
from scenarios.schema.monte_carlo_config import FalsifyScenario, MonteCarloScenario


def study_of(scenario: AnyStudy, name: str, overrides: Sequence[str] = ()) -> Study:
    """Return the study that a scenario file describes.

    Parameters
    ----------
    scenario, name : the scenario and its name
    overrides : overrides that were applied to the scenario, recorded in the manifest

    Raises
    ------
    InputError : the scenario cannot be flown
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
    executor_factory: ExecutorFactory | None = None,
    resume: bool = False,
    progress: Progress = lambda *_: None,
    overrides: Sequence[str] = (),
) -> RunResult:
    """Fly a study into ``directory``.

    Parameters
    ----------
    scenario, name : the scenario and its name
    directory : the run directory
    executor_factory : makes the executor; the default is one process of this machine
    resume : continue the unfinished run in ``directory``
    progress : called as the study advances
    overrides : overrides that were applied to the scenario, recorded in the manifest

    Raises
    ------
    InputError : the scenario cannot be flown, or the directory cannot be used
    """
    if not resume:
        RunDirectory(directory).refuse_taken()
    progress("preparing", 0, 1)
    study = study_of(scenario, name, overrides)
    return fly_study(study, directory, executor_factory=executor_factory or ExecutorFactory(), resume=resume, progress=progress)
