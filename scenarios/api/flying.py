"""Fly one flight, or a whole study, from a program."""

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

_LOOKED_THROUGH = 1000
"""Most flights of a study among which the name that was meant is looked for."""


def fly(
    scenario: Given | Scenario,
    /,
    *,
    flight_id: str | None = None,
    out: str | os.PathLike[str] | None = None,
    progress: bool = False,
    **keys: object,
) -> Flight:
    """Fly one flight of a scenario, in this process, and return it with its time history.

    It is the flight that the command line flies, to the last bit. Nothing is written unless ``out``
    is given: the files that are needed on the way are in a temporary directory, which is removed
    together with what is returned.

    Parameters
    ----------
    scenario : a name of the catalog, the path of a TOML file, what such a file holds, as a mapping,
        or what ``load`` returned
    flight_id : name of the flight, where the scenario has several
    out : run directory, which must be new or empty
    progress : show a progress bar on standard error
    keys : to set, same as ``Scenario.set``:
        ``fly("sweep_nu", nu=0.5, **{"guidance.preview": False})``

    Raises
    ------
    InputError : the scenario cannot be flown, or has several flights, or not this one; one line
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
                f"'{loaded.name}' has no flight '{name}'; its flights are {_names(study)}{_meant(name, study)}"
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
    """Fly a whole study and return its results.

    They are those of the command line, to the last bit. Nothing is written unless ``out`` is given:
    the files that are needed on the way are in a temporary directory, which is removed together
    with what is returned.

    Parameters
    ----------
    scenario, out, progress, keys : same as ``fly``
    jobs : number of processes; one per core if not given

    Raises
    ------
    InputError : the scenario cannot be flown, the directory cannot be used, or a part that was
        given as an object cannot be sent to other processes; one line
    KeyboardInterrupt : it was interrupted; in ``out`` finished flights are kept, and ``--resume``
        of the command line goes on
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
    """Return the study of a scenario whose flights can be flown alone.

    Raises
    ------
    InputError : it has no such flights
    """
    from scenarios.studies.base import FlightStudy, study_of

    study = study_of(loaded.config, loaded.name, loaded.changes)
    if not isinstance(study, FlightStudy) or study.chooses_flights:
        raise InputError(
            f"'{loaded.name}' is a study of {loaded.config.study}, which has no flight that could be flown alone; use run"
        )
    return study


def _only_flight(study: "FlightStudy", loaded: Scenario) -> str:
    """Return the name of the only flight of a study."""
    if study.planned > 1:
        single = " set nu to a single number," if sweeps_nu(loaded) else ""
        raise InputError(
            f"'{loaded.name}' has {study.planned} flights; name one of them by flight_id ({_names(study)}),{single} or use run"
        )
    return next(iter(study.experiments.values())).named(0)[0]


def _names(study: "FlightStudy") -> str:
    """Return the names of the first and the last flight, comparisons apart."""
    first, *_, last = [
        (experiment, number)
        for experiment in study.experiments.values()
        for number in (0, experiment.counted - 1)
    ]
    return " to ".join(
        dict.fromkeys(experiment.named(number)[0] for experiment, number in (first, last))
    )


def _meant(name: str, study: "FlightStudy") -> str:
    """Return the name of the flight that was meant, of so few that they are looked through at once."""
    experiments = [
        experiment
        for experiment in study.experiments.values()
        if experiment.flights <= _LOOKED_THROUGH
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
"""Called with the object together with which a temporary directory is removed."""


@contextmanager
def _directory(out: str | os.PathLike[str] | None) -> Iterator[tuple[Path, Keeping]]:
    """Yield the run directory; one that is temporary is removed with what it is kept for, or if
    there is nothing.
    """
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
    """Refuse a directory that is not empty, in the words of a program."""
    from scenarios.engine.run_directory import RunDirectory

    try:
        RunDirectory(directory).refuse_taken()
    except InputError as error:
        raise InputError(
            f"out: {str(error).partition(';')[0]}; give the path of a directory that is new or empty"
        ) from None


def _shown(*, progress: bool) -> "AbstractContextManager[Progress]":
    """Return the context of what is called as flights advance: a progress bar, or nothing."""
    from scenarios.engine.runner import progress_bar

    return progress_bar() if progress else nullcontext(lambda *_: None)


def _finished(result: "RunResult", keeping: Keeping) -> Run:
    if result.verdict.interrupted:
        raise KeyboardInterrupt
    run = Run(result.directory, lines=tuple(result.lines))
    keeping(run)
    return run
