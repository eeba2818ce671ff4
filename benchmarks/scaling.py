"""``python -m benchmarks.scaling``: cost of a study over flights, flight time and log rate; ten
minutes.

The results are in docs/explanation/scaling.md. Each is that of a whole study with journal, tables
and time histories, in its own process, so that peak memory is that of the study alone.
"""

import json
import math
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from common.run_layout import JOURNAL, MANIFEST, SUMMARY
from scenarios.engine.journal import Journal
from scenarios.engine.runner import DASK, LOCAL, ExecutorFactory
from scenarios.engine.task import Result, Task

KINEMATIC = (
    "sea_approach",
    "fidelity=kinematic",
    "flight.duration_max_s=2",
    "criteria.settles=false",
    "flight.crossings=0",
)
SIX_DOF = ("monte_carlo", "sampling=random", "histories=100000")

TASKS = 3_000
"""Number of empty tasks with which the throughput of the engine is measured."""

Measured = tuple[float, float, float]
"""Wall time of a run [s], peak memory of the main program [MiB], and size of the run directory
[MiB].
"""


def main() -> None:
    """Print the tables."""
    print(
        "flights, kinematic, 2 s each, two processes: ms per flight, peak memory, size of the run"
    )
    for flights in (1_000, 10_000, 100_000):
        seconds, memory, size = _study(*KINEMATIC, f"flights={flights}", "histories=100")
        print(f"{flights:8,} {1e3 * seconds / flights:8.2f} ms {memory:8.0f} MiB {size:8.1f} MiB")
    print("flight time, X8, 20 flights, two processes: s per flight, size of a flight")
    for duration in (100, 200, 400, 800):
        seconds, _, size = _study(
            *SIX_DOF,
            "flights=20",
            f"flight.duration_max_s={duration}",
            "vessel.manoeuvres.0.at_s=50",
        )
        print(f"{duration:8} s {seconds / 20:8.3f} s {size / 20:8.2f} MiB")
    print("log rate, X8, 20 flights of 300 s, two processes: s per flight, size of a flight")
    for rate in (5, 10, 20):
        seconds, _, size = _study(*SIX_DOF, "flights=20", f"flight.log_rate_hz={rate}")
        print(f"{rate:8} Hz {seconds / 20:8.3f} s {size / 20:8.2f} MiB")
    print("empty tasks, two processes, journal included: results per second")
    for executor in (LOCAL, DASK):
        print(f"{executor:>8} {_throughput(executor):8.0f}")


@dataclass(frozen=True, slots=True, kw_only=True)
class EmptyWork:
    """Work that does nothing and returns a result as large as that of a flight."""

    model: Path | None = None

    def moved(self, _: Path) -> "EmptyWork":
        return self

    def run(self, task: Task) -> Result:
        row = {"flight_id": f"empty_{task.number:05d}"} | {
            f"figure_{i}": math.pi * (i + task.number) for i in range(100)
        }
        return Result(task=task, tables={SUMMARY: [row]})

    def lost(self, task: Task, reason: str) -> Result:
        raise RuntimeError(f"task {task.number}: {reason}")


def _throughput(executor: str) -> float:
    """Return the number of results that reach the journal in a second."""
    with (
        tempfile.TemporaryDirectory() as folder,
        ExecutorFactory(jobs=2, executor=executor)(EmptyWork()) as started,
    ):
        journal = Journal(Path(folder) / JOURNAL)
        flown = started.fly(Task(number=i) for i in range(TASKS))
        journal.add(next(flown))
        began = time.perf_counter()
        for result in flown:
            journal.add(result)
        seconds = time.perf_counter() - began
        journal.close()
    return (TASKS - 1) / seconds


def _study(name: str, *overrides: str) -> Measured:
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "run"
        words = [word for override in overrides for word in ("--set", override)]
        command = [
            sys.executable,
            "-m",
            "scenarios.run",
            name,
            *words,
            "--jobs",
            "2",
            "--no-report",
            "--out",
            str(out),
        ]
        began = time.perf_counter()
        subprocess.run(command, check=False, capture_output=True)
        manifest = json.loads((out / MANIFEST).read_text(encoding="utf-8"))
        if manifest["state"] != "complete":
            raise RuntimeError(
                f"{' '.join(command)} did not complete in {time.perf_counter() - began:.0f} s"
            )
        size = sum(path.stat().st_size for path in out.rglob("*") if path.is_file()) / 2**20
        return float(manifest["wall_time_s"]), float(manifest["peak_memory_mib"]), size


if __name__ == "__main__":
    main()
