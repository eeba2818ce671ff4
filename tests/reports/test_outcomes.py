"""A flight that fails, is lost, or is not known to its end reads nowhere as one that kept out.

Of two flights one is completed. The other has each outcome in turn; console, exit status, page for
screen and print, comparison and Python are held to the verdict of the run.
"""

import copy
import re
from dataclasses import replace

import pypdfium2
import pytest
from matplotlib.figure import Figure
from report_parts import blocks_of

from common.verdict import INTERRUPTED, MET, NOT_MET, UNEXPLAINED, read_verdict
from reports.compare.content import compare, comparison_content
from reports.compare.pairs import read_runs
from reports.document.blocks import Table
from reports.registry import content
from reports.run.run_data import read_run
from scenarios.api.results import Run
from scenarios.engine.processes import InProcessExecutor
from scenarios.scenario.files import load_study
from scenarios.studies.base import run_study
from tests.in_process import run_command

pytestmark = pytest.mark.slow

SCENARIO = """
extends = "operational"
study = "flights"
title = "Two"
fidelity = "kinematic"
guidance.rate_hz = 10.0
flights = 2
flight.crossings = 2
criteria = { crossing_interval_error = false, tracking_error_rms_m = 5.0 }
"""

INSIDE = {
    "keepout_violations": 1,
    "keepout_depth_m": 1.5,
    "min_distance_m": 198.5,
    "kept_out": False,
}

OUTCOMES = {
    "completed": {},
    "violated": {"criteria_met": False, **INSIDE},
    "unexplained": {"outcome": "unexplained_violation", **INSIDE},
    "lost": {"outcome": "aircraft_lost", "fault": "engine", "fault_time_s": 5.0},
    "lost_where_that_is_allowed": {"outcome": "aircraft_lost", "required": "keep_out", "fault": "engine", "fault_time_s": 5.0},
    "diverged": {"outcome": "diverged", "kept_out": False},
    "diverged_where_keeping_out_is_enough": {"outcome": "diverged", "required": "keep_out", "kept_out": False},
    "failed": {"outcome": "failed"},
    "not_arrived": {"outcome": "incomplete"},
    "not_settled": {"outcome": "not_settled", "settling_time_s": float("nan")},
    "could_not_fly": {"outcome": "infeasible"},
    "unknown": None,
    "interrupted": None,
}  # fmt: skip
"""What is otherwise in the row of the second flight; nothing of one without a row."""

EXIT = dict.fromkeys(OUTCOMES, NOT_MET) | {
    "completed": MET,
    "lost_where_that_is_allowed": MET,
    "unexplained": UNEXPLAINED,
    "interrupted": INTERRUPTED,
}

KEPT_OUT = ("completed", "not_arrived", "not_settled")
"""Outcomes in which the second flight kept out: it did not arrive, but came back."""

NO_VIOLATION = re.compile(r"no keep-out violation|2 of 2 (flights )?kept out|kept out: 2", re.I)
"""How a page or a line says that every flight kept out."""

UNPLANNED = (
    "flight_id",
    "trial",
    "variant",
    "aircraft",
    "fidelity",
    "seed",
    "fault",
    "required",
    "nu",
    "keepout_radius_m",
)
"""What is known of a flight that could not be flown."""  # fmt: skip


class SecondFlight(InProcessExecutor):
    """Flies each flight once for all tests, and has the second one end as it is to."""

    def __init__(self, work, outcome, known):
        super().__init__(work)
        self._given = work
        self._outcome = outcome
        self._known = known

    def fly(self, tasks):
        return map(self._flown, tasks)

    def _once(self, task):
        if task.number not in self._known:
            self._known[task.number] = self._given.run(task)
        return copy.deepcopy(self._known[task.number])

    def _flown(self, task):
        if task.number != 1 or self._outcome == "completed":
            return self._once(task)
        if self._outcome == "interrupted":
            raise KeyboardInterrupt
        if self._outcome == "unknown":
            return self._given.lost(task, "its process was killed")
        result = self._once(task)
        (row,) = result.tables["summary.csv"]
        if self._outcome == "could_not_fly":
            row = {key: row[key] for key in UNPLANNED}
        changed = {"criteria_met": False, "message": "as it is to end", **OUTCOMES[self._outcome]}
        return replace(result, tables=result.tables | {"summary.csv": [row | changed]})


@pytest.fixture(scope="module")
def known():
    """Results of both flights, once they were flown."""
    return {}


@pytest.fixture
def flown(request, known, tmp_path, monkeypatch):
    """Return the run directory of an outcome, and how the command ended that flew it."""
    scenario = tmp_path / "two.toml"
    scenario.write_text(SCENARIO, encoding="utf-8")
    monkeypatch.setattr(
        "scenarios.engine.runner.ExecutorFactory",
        lambda **_: lambda work: SecondFlight(work, request.param, known),
    )
    monkeypatch.setattr("reports.render.figure_files.draw", lambda _: Figure(figsize=(1.0, 1.0)))
    ended = run_command("scenarios.run", scenario, "--out", tmp_path / "run")
    return request.param, tmp_path / "run", ended


@pytest.fixture(scope="module")
def run_path_of_two(known, tmp_path_factory):
    """Return the directory of a run of both flights."""
    folder = tmp_path_factory.mktemp("both")
    (folder / "two.toml").write_text(SCENARIO, encoding="utf-8")
    run_study(
        load_study(str(folder / "two.toml")),
        "two",
        folder / "run",
        executor_factory=lambda work: SecondFlight(work, "completed", known),
    )
    return folder / "run"


def text_of_pdf(path):
    document = pypdfium2.PdfDocument(path)
    text = " ".join(page.get_textpage().get_text_range() for page in document)
    document.close()
    return " ".join(text.split())


@pytest.mark.parametrize("flown", OUTCOMES, indirect=True)
def test_console_exit_status_pages_comparison_and_python_say_what_the_verdict_says(
    flown, run_path_of_two
):
    outcome, path, ended = flown
    verdict = read_verdict(path / "verdict.json")
    counts = verdict.counts
    assert counts.planned == 2
    assert verdict.exit_status == ended.status == EXIT[outcome]
    kept = 1 + (outcome in KEPT_OUT)
    assert counts.kept_out == kept
    assert verdict.all_kept_out is (kept == 2)

    # The console, but for what the bound on a probability says.
    lines = [line for line in ended.out.splitlines() if line.startswith("flights: ")]
    assert f"; {kept} of {counts.beside} kept out" in lines[0]
    assert "2 of 2 kept out" not in ended.out or kept == 2
    if verdict.is_done:
        assert f"exit status {ended.status}: {counts.passed} of 2 flights did what" in ended.out

    # The page, on screen and in print.
    if verdict.interrupted:
        run_command("reports.build", path)
    found = content(read_run(path)).verdict
    html = (path / "report.html").read_text(encoding="utf-8")
    texts = [html, text_of_pdf(path / "report.pdf"), found.headline, found.detail]
    assert (found.tone == "good") is (outcome == "completed")
    if counts.violated or verdict.lost_against_requirement:
        assert found.tone == "bad"
    assert found.exit_status == verdict.exit_status
    assert all(bool(NO_VIOLATION.search(text)) is (kept == 2) for text in texts[:3])
    assert not NO_VIOLATION.search(found.detail)
    if verdict.interrupted:
        assert found.headline.startswith("INTERRUPTED after 1 of 2 flights. ")
    tiles = {card.name: card for card in found.figures}
    if (tile := tiles["Kept out"]).met is not None:
        assert tile.met is (kept == counts.beside)
    assert tile.value.startswith(f"{kept} of {counts.beside}")

    # A comparison with two flights that kept out.
    runs = read_runs([run_path_of_two, path])
    page = comparison_content(runs, compare(runs))
    rows = {row[0]: row[1:] for row in blocks_of(page, Table, "figures")[0].rows}
    known = rows["Flights that are known to have kept out"]
    assert known[:2] == ["2 of 2", f"{kept} of {counts.done}"]
    failures = [text for text in page.verdict.failures if "did what is required" in text]
    assert bool(failures) is (verdict.exit_status != MET)

    # Python.
    run = Run(path, lines=())
    assert run.met is (verdict.exit_status == MET)
    assert run.verdict.counts.kept_out == kept
    flights = list(run.flights.values())
    assert sum(flight.kept_out for flight in flights) == kept
    assert sum(flight.met for flight in flights) == counts.met
