"""Choice of the study that a scenario describes, and its execution."""

from collections.abc import Callable, Sequence
from contextlib import nullcontext
from pathlib import Path

from common.errors import PluginError
from common.registry import is_file_part
from scenarios.engine.executor import Executor
from scenarios.engine.executors import ExecutorFactory
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import Launch, Progress, RunResult, Study, fly_study
from scenarios.engine.task import Work
from scenarios.errors import InputError
from scenarios.scenario.load import AnyStudy
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.experiment import TrialList
from scenarios.studies.checks import plugins_explained
from scenarios.studies.study import STUDIES


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
    if isinstance(scenario, TrialList):
        from scenarios.studies.trials import TrialStudy

        return TrialStudy(scenario, name, overrides=overrides)
    try:
        made = STUDIES.get(scenario.study)
    except PluginError as error:
        raise InputError(str(error)) from None
    if not isinstance(scenario, Scenario):
        return made(scenario, name, overrides=overrides)
    with plugins_explained(f"study '{scenario.study}'", [scenario]):
        return made(scenario, name, {name: scenario}, overrides=overrides)


def run_study(
    scenario: AnyStudy,
    name: str,
    directory: Path,
    *,
    executor_factory: Callable[[Work], Executor] | None = None,
    resume: bool = False,
    progress: Progress = lambda *_: None,
    overrides: Sequence[str] = (),
    command: str = "",
    launched: Callable[[Launch], None] = lambda _: None,
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
    command : the command line, for the manifest; none if a program runs the study
    launched : called once, before anything is flown

    Raises
    ------
    InputError : the scenario cannot be flown, or the directory cannot be used
    """
    if not resume:
        RunDirectory(directory).refuse_taken()
    elif isinstance(scenario, Scenario):
        from scenarios.studies.manifest import plugins, refuse_changed

        # Before an autopilot is designed for what is refused then.
        then, now = RunDirectory(directory).plugins(), plugins([scenario])
        refuse_changed(then, {name: digest for name, digest in now.items() if name in then})
    progress("preparing", 0, 1)
    study = study_of(scenario, name, overrides)
    factory = executor_factory or ExecutorFactory()
    own = [scenario] if isinstance(scenario, Scenario) and is_file_part(scenario.study) else []
    with plugins_explained(f"study '{scenario.study}'", own) if own else nullcontext():
        return fly_study(
            study,
            directory,
            executor_factory=factory,
            resume=resume,
            progress=progress,
            command=command,
            launched=launched,
        )
