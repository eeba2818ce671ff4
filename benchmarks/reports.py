"""Computing time of a study's reports: the sweep is flown once, and its reports are built several
times.
"""

import os
import statistics
import tempfile
import time
from pathlib import Path

from common.run_layout import REPORT_HTML, REPORT_PDF
from reports.build import build_reports
from scenarios.engine.runner import ExecutorFactory, fly_study
from scenarios.scenario.files import load_study
from scenarios.studies.base import study_of

SWEEP = "sweep_nu"

REPORT_MAX, HTML_MAX, PDF_MAX = 3.0, 6.0, 1.0
"""Limits of the time of the reports of the sweep on two cores [s], and of the sizes of the one for
the screen and the one for print [MB].
"""


def report_reports(rounds: int) -> None:
    """Print the benchmark: medians over so many reports of one run."""
    with tempfile.TemporaryDirectory() as folder:
        run = Path(folder) / "run"
        began = time.perf_counter()
        fly_study(
            study_of(load_study(SWEEP), SWEEP),
            run,
            executor_factory=ExecutorFactory(jobs=2),
            resume=False,
            progress=lambda *_: None,
        )
        flown = time.perf_counter() - began
        elapsed, computed = zip(*(_report(run) for _ in range(rounds)), strict=True)
        screen, printed = ((run / name).stat().st_size / 1e6 for name in (REPORT_HTML, REPORT_PDF))
    print(
        f"reports of {SWEEP}: {statistics.median(elapsed):.1f} s, of a core"
        f" {statistics.median(computed):.1f} s (limit"
        f" {REPORT_MAX:g} s); HTML {screen:.1f} MB (limit {HTML_MAX:g} MB), PDF {printed:.1f}"
        f" MB (limit {PDF_MAX:g} MB); its flights took {flown:.1f} s"
    )


def _report(run: Path) -> tuple[float, float]:
    """Return the time of building the reports of a run, and that of its processes on a core [s]."""
    began, computed = time.perf_counter(), _computed()
    build_reports(run)
    return time.perf_counter() - began, _computed() - computed


def _computed() -> float:
    used = os.times()
    return used.user + used.system + used.children_user + used.children_system
