"""Computing time that the engine adds to the flights: speed-up by a second process, cost of
starting a flight.

A whole study, with journal and tables, is flown by one process and by two, in turn, for several
rounds. The cost of starting a flight is extrapolated from flights of two lengths to length zero.
"""

import multiprocessing
import statistics
import tempfile
import time
from collections.abc import Callable, Iterable
from pathlib import Path

from aircraft.fdm import TIME_STEP
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import ExecutorFactory, fly_study
from scenarios.engine.task import Task, Work
from scenarios.scenario.files import load_study
from scenarios.studies.base import study_of

REFERENCE_STEP = 2.9e-6
"""Time of a step of JSBSim alone, with the bare aircraft, on the machine for which limits are given
[s].
"""

SECOND_MAX = 8e-4
"""Limit of the time of a simulated second over the sea on such a machine [s]."""

FLIGHTS = 40
LENGTHS = (50.0, 250.0)
"""Lengths of the flights whose times are compared [s]."""

SETTINGS = ("criteria.settles=false", "histories=0")


def report_engine(rounds: int, jsbsim: Callable[[], float]) -> None:
    """Print the benchmark: medians over rounds, and ratios within a round.

    Parameters
    ----------
    rounds : number of rounds
    jsbsim : returns the time that JSBSim alone takes for a simulated second [s]
    """
    with tempfile.TemporaryDirectory() as folder:
        work = _work(300.0, Path(folder) / "bare")
        one, two, bare = zip(
            *((_whole_study(1), _whole_study(2), _bare(work)) for _ in range(rounds)), strict=True
        )
    ratio, bare_ratio = (
        statistics.median(a / b for a, b in zip(one, times, strict=True)) for times in (two, bare)
    )
    print(
        f"{FLIGHTS} flights of 300 s, journal and tables included, {rounds} interleaved rounds:"
        f" {statistics.median(one):.2f} s with"
        f" one process, {statistics.median(two):.2f} s with two, a speed-up of {ratio:.2f}; two"
        " processes without the engine reach"
        f" {bare_ratio:.2f}"
    )
    with tempfile.TemporaryDirectory() as folder:
        works = [_work(length, Path(folder) / f"{length:g}") for length in LENGTHS]
        short, long, alone = zip(
            *((*(_flight(work) for work in works), jsbsim()) for _ in range(5 * rounds)),
            strict=True,
        )
    seconds = [(b - a) / (LENGTHS[1] - LENGTHS[0]) for a, b in zip(short, long, strict=True)]
    per_second = statistics.median(seconds)
    starting = statistics.median(a - per_second * LENGTHS[0] for a in short)
    over_jsbsim = statistics.median(a / b for a, b in zip(seconds, alone, strict=True))
    scaled = REFERENCE_STEP / TIME_STEP * over_jsbsim
    print(
        f"a flight over the sea: {1e3 * starting:.1f} ms to start and to evaluate,"
        f" {1e3 * per_second:.3f} ms per simulated second,"
        f" {over_jsbsim:.2f} times JSBSim alone; {1e3 * scaled:.3f} ms where a step of JSBSim"
        f" takes {1e6 * REFERENCE_STEP:g} us"
        f" (limit {1e3 * SECOND_MAX:g} ms)"
    )


def _whole_study(jobs: int) -> float:
    """Return the time of a study, from its first flight to its tables [s]."""
    study = study_of(
        load_study("monte_carlo", [f"flights={FLIGHTS}", "sampling=random", *SETTINGS]), "bench"
    )
    times: list[float] = []

    def record_time(activity: str, *_: int) -> None:
        if activity == "flying":
            times.append(time.perf_counter())

    with tempfile.TemporaryDirectory() as folder:
        fly_study(
            study,
            Path(folder) / "run",
            executor_factory=ExecutorFactory(jobs=jobs),
            resume=False,
            progress=record_time,
        )
    return times[-1] - times[0]


def _bare(work: Work) -> float:
    """Return the time of two processes that fly half of the same flights each, and store nothing
    [s].
    """
    halves = [range(half, FLIGHTS, 2) for half in (0, 1)]
    processes = [
        multiprocessing.Process(target=_fly_each, args=(work, numbers)) for numbers in halves
    ]
    began = time.perf_counter()
    for process in processes:
        process.start()
    for process in processes:
        process.join()
    return time.perf_counter() - began


def _fly_each(work: Work, numbers: Iterable[int]) -> None:
    for number in numbers:
        work.run(Task(number=number))


def _work(length: float, path: Path) -> Work:
    """Return the work of flights of some length [s]."""
    run = RunDirectory(path)
    run.open("a", resume=False)
    overrides = [f"flight.duration_max_s={length}", "sampling=random", *SETTINGS]
    return study_of(load_study("monte_carlo", overrides), "bench").work(run)


def _flight(work: Work) -> float:
    """Return the CPU time of one flight [s]."""
    began = time.process_time()
    work.run(Task(number=3))
    return time.process_time() - began
