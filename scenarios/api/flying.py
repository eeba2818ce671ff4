"""Fly one flight or a whole study from a program."""

import os
import shutil
import tempfile
import weakref
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from numbers import Integral
from pathlib import Path
from typing import TYPE_CHECKING

from common.text import did_you_mean
from scenarios.api.given_parts import WorkWithParts, check_picklable, registered
from scenarios.api.results import Flight, Run
from scenarios.api.scenario import Given, Scenario, load, sweeps_nu
from scenarios.errors import InputError

if TYPE_CHECKING:
    from scenarios.engine.processes import Executor
    from scenarios.engine.runner import Progress, RunResult
    from scenarios.engine.task import Work
    from scenarios.studies.base import FlightStudy

_SEARCHED_MAX = 1000
"""Largest number of flights among which a similar name is searched for."""


def fly(
    scenario: Given | Scenario,
    /,
    *,
    flight_id: str | None = None,
    out: str | os.PathLike[str] | None = None,
    progress: bool = False,
    **keys: object,
) -> Flight:
    """Fly one flight of a scenario in this process; return it with its time history.

    The flight is the same as from the command line, to the last bit. Without ``out`` its files are
    in a temporary directory, which is removed together with the returned object.

    Parameters
    ----------
    scenario : name of a catalog scenario, path of a TOML file, a mapping with the contents of such
        a file, or a ``Scenario``
    flight_id : name of the flight, if the scenario has several flights
    out : run directory, which must be new or empty
    progress : whether to show a progress bar on standard error
    keys : keys to set, as in ``Scenario.set``: ``fly("sweep_nu", nu=0.5, **{"guidance.preview":
        False})``

    Raises
    ------
    InputError : the scenario cannot be flown, has several flights, or does not have this one
    """
    from scenarios.engine.processes import InProcessExecutor
    from scenarios.engine.runner import fly_study
    from scenarios.studies.base import SingleFlight

    loaded = load(scenario).set(**keys)
    with (
        registered(loaded.parts),
        _directory(out) as (directory, keeping),
        _shown(progress=progress) as show,
    ):
        study = flights_of(loaded)
        name = flight_id or _only_flight(study, loaded)
        single = SingleFlight.of(study, name)
        if single is None:
            raise InputError(
                f"'{loaded.name}' has no flight '{name}'; its flights are"
                f" {_names(study)}{_suggested(name, study)}"
            )
        result = fly_study(
            single, directory, executor_factory=InProcessExecutor, resume=False, progress=show
        )
        return _finished(result, keeping).flights[name]


def run(
    scenario: Given | Scenario,
    /,
    *,
    out: str | os.PathLike[str] | None = None,
    jobs: int | None = None,
    progress: bool = False,
    **keys: object,
) -> Run:
    """Fly a whole study; return its results.

    The results are the same as from the command line, to the last bit. Without ``out`` the files
    are in a temporary directory, which is removed together with the returned object.

    Parameters
    ----------
    scenario, out, progress, keys : as in ``fly``
    jobs : number of processes; by default one per core

    Raises
    ------
    InputError : the scenario cannot be flown, the directory cannot be used, or a part that was
        given as an object cannot be sent to other processes
    KeyboardInterrupt : the run was interrupted; finished flights are kept in ``out``, and the
        command line continues the run with ``--resume``
    """
    from scenarios.engine.runner import ExecutorFactory
    from scenarios.studies.base import run_study

    if jobs is not None and not (isinstance(jobs, Integral) and jobs >= 1):
        raise InputError(
            f"jobs is {jobs!r}; it is a number of processes: give a whole number, 1 or more"
        )
    loaded = load(scenario).set(**keys)
    check_picklable(loaded.parts)
    processes = ExecutorFactory(jobs=jobs or os.cpu_count() or 1)

    def executor(work: "Work") -> "Executor":
        return processes(WorkWithParts(work, loaded.parts) if loaded.parts else work)

    with (
        registered(loaded.parts),
        _directory(out) as (directory, keeping),
        _shown(progress=progress) as show,
    ):
        result = run_study(
            loaded.config,
            loaded.name,
            directory,
            executor_factory=executor,
            progress=show,
            overrides=loaded.changes,
        )
        return _finished(result, keeping)


def flights_of(loaded: Scenario) -> "FlightStudy":
    """Return the study of a scenario whose flights can be flown one by one.

    Raises
    ------
    InputError : the study has no such flights
    """
    from scenarios.studies.base import FlightStudy, study_of

    study = study_of(loaded.config, loaded.name, loaded.changes)
    if not isinstance(study, FlightStudy) or study.chooses_flights:
        raise InputError(
            f"'{loaded.name}' is a study of {loaded.config.study}, whose flights cannot be"
            " flown one by one; use run"
        )
    return study


def _only_flight(study: "FlightStudy", loaded: Scenario) -> str:
    """Return the name of the only flight of a study."""
    if study.planned > 1:
        single = " set nu to a single number," if sweeps_nu(loaded) else ""
        raise InputError(
            f"'{loaded.name}' has {study.planned} flights; name one of them by flight_id"
            f" ({_names(study)}),{single} or use run"
        )
    return next(iter(study.experiments.values())).named(0)[0]


def _names(study: "FlightStudy") -> str:
    """Return the names of the first and the last flight, without comparisons."""
    first, *_, last = [
        (experiment, number)
        for experiment in study.experiments.values()
        for number in (0, experiment.counted - 1)
    ]
    return " to ".join(
        dict.fromkeys(experiment.named(number)[0] for experiment, number in (first, last))
    )


def _suggested(name: str, study: "FlightStudy") -> str:
    """Return a suggestion of a flight with a similar name, if there are not too many flights."""
    experiments = [
        experiment
        for experiment in study.experiments.values()
        if experiment.flights <= _SEARCHED_MAX
    ]
    return did_you_mean(
        name,
        (
            experiment.named(number)[0]
            for experiment in experiments
            for number in range(experiment.flights)
        ),
    )


Keeping = Callable[[object], None]
"""Function that ties the life of a temporary directory to an object."""


@contextmanager
def _directory(out: str | os.PathLike[str] | None) -> Iterator[tuple[Path, Keeping]]:
    """Yield the run directory; a temporary one is removed together with the object tied to it."""
    if out is not None:
        _refuse_taken(Path(out))
        yield Path(out), lambda _: None
        return
    directory = Path(tempfile.mkdtemp(prefix="plume-flight-"))
    removers: list[weakref.finalize[..., object]] = []

    def keeping(user: object) -> None:
        removers.append(weakref.finalize(user, shutil.rmtree, directory, ignore_errors=True))

    try:
        yield directory, keeping
    finally:
        if not removers:
            shutil.rmtree(directory, ignore_errors=True)


def _refuse_taken(directory: Path) -> None:
    """Refuse a directory that is not empty, with a message for a program."""
    from scenarios.engine.run_directory import RunDirectory

    try:
        RunDirectory(directory).refuse_taken()
    except InputError as error:
        raise InputError(
            f"out: {str(error).partition(';')[0]}; give the path of a directory that is new or"
            " empty"
        ) from None


def _shown(*, progress: bool) -> "AbstractContextManager[Progress]":
    """Return the context of a progress bar, or of a function that does nothing."""
    from scenarios.engine.runner import progress_bar

    return progress_bar() if progress else nullcontext(lambda *_: None)


def _finished(result: "RunResult", keeping: Keeping) -> Run:
    if result.verdict.interrupted:
        raise KeyboardInterrupt
    run = Run(result.directory, lines=tuple(result.lines))
    keeping(run)
    return run
