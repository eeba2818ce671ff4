"""How many files a part takes: each is added from a temporary package, which has no other file."""

import csv
import json
import re
from html import unescape

import pypdfium2
import pytest

from reports.document.blocks import FlightPicker
from reports.document.chart import Chart
from reports.registry import content
from reports.run.run_data import read_run
from tests.extensions.added_package import AddedPackage

INSTRUMENT = """
import numpy as np
from common.columns import Column
from scenarios.instruments.instrument import Evaluation


class Meter:
    COLUMNS = {"glow_ppb": Column("brightness of the exhaust", title="Glow of the exhaust")}
    FIGURES = {"glow_peak_ppb": Column("largest brightness", title="Peak of the glow", digits=3)}

    def __init__(self, scenario, world, generator):
        pass

    def evaluate(self, column, since):
        glow = np.hypot(column("north_m"), column("east_m")) * 1e-3
        return Evaluation(columns=glow[:, None], figures={"glow_peak_ppb": float(glow.max())})
"""

STUDY = """
from reports.document.blocks import Section, Text
from scenarios.studies.base import FlightStudy


class Counting(FlightStudy):
    @staticmethod
    def report(run):
        from reports.flights.content import flights_content

        found = flights_content(run)
        text = f"Counted {len(run.summary)} flights."
        found.sections.append(Section(anchor="count", title="The count", blocks=[Text(text)]))
        return found
"""

LAW = """
import math
from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Pursuit:
    pursuit_gain_per_s: float = 1.2

    def heading_rate(self, reference, own, air):
        sight = math.atan2(
            reference.east - own.east + reference.speed * math.sin(reference.course),
            reference.north - own.north + reference.speed * math.cos(reference.course),
        )
        off = math.remainder(sight - own.course, math.tau)
        return self.pursuit_gain_per_s * off + reference.heading_rate
"""

CHART = """
import numpy as np
from reports.document.blocks import Section
from reports.document.chart import Chart, Line, Panel


def closest(run):
    distances = run.summary["min_distance_m"].to_numpy(dtype=float)
    line = Line(x=np.arange(len(distances)), y=distances, label="closest", colour="blue", style="points")
    panel = Panel(x_label="Number of the flight", y_label="Distance at its least [m]", lines=[line])
    caption = "The closest approach of each flight by its number."
    chart = Chart(name="nearest", caption=caption, panels=[panel])
    return [Section(anchor="nearest", title="Closest approaches in order", blocks=[chart])]
"""

SHORT = (
    "fidelity=kinematic",
    "sweep.nu=[0.5]",
    "flight.crossings=3",
    "guidance.rate_hz=10",
    "comparison.nu=[]",
    "criteria.tracking_error_rms_m=5",
    "criteria.crossing_interval_error=0.1",
)


def flown(folder, name, text, kind, part, *keys):
    """Fly with a package of one file, and return it and its run."""
    package = AddedPackage(folder, {"added.py": text}, {kind: {name: f"added:{part}"}})
    assert [path.name for path in folder.iterdir() if path.is_file()] == ["added.py"]
    settings = [word for key in (*SHORT, *keys) for word in ("--set", key)]
    ran = package.command("run", "sweep_nu", *settings, "--jobs", "1", "--out", "run")
    assert ran.returncode in (0, 1), ran.stderr
    return package, folder / "run"


def words(run):
    """Return the texts of both reports."""
    document = pypdfium2.PdfDocument(run / "report.pdf")
    printed = " ".join(page.get_textpage().get_text_bounded() for page in document)
    shown = unescape((run / "report.html").read_text(encoding="utf-8"))
    return [re.sub(r"\s+", " ", text) for text in (shown, printed)]


def labels(run):
    """Return what the ordinates of all panels in the report say."""
    blocks = [block for section in content(read_run(run)).sections for block in section.blocks]
    flights = [
        flight for block in blocks if isinstance(block, FlightPicker) for flight in block.flights
    ]
    charts = [block for block in blocks if isinstance(block, Chart)]
    charts += [chart for flight in flights for chart in flight.charts]
    return [panel.y_label for chart in charts for panel in chart.panels]


def rows(run):
    with (run / "summary.csv").open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_a_column_of_an_instrument_in_table_panel_html_and_pdf_takes_one_file(tmp_path):
    _, run = flown(tmp_path, "meter", INSTRUMENT, "payload", "Meter", 'payload=["meter"]')
    peak = float(rows(run)[0]["glow_peak_ppb"])
    told = json.loads((run / "columns.json").read_text(encoding="utf-8"))
    assert told["flights"]["glow_ppb"]["title"] == "Glow of the exhaust"
    for text in words(run):
        assert "Figures of meter" in text
        assert "Peak of the glow [ppb]" in text
        assert f"{peak:.3f}" in text
    assert "Glow of the exhaust [ppb]" in labels(run)


def test_a_study_with_its_report_takes_one_file(tmp_path):
    (tmp_path / "added.py").write_text(STUDY, encoding="utf-8")
    study = f"{tmp_path / 'added.py'}:Counting"
    package = AddedPackage(tmp_path, {}, {})
    settings = [word for key in (*SHORT, f"study={study}") for word in ("--set", key)]
    package.command("run", "sweep_nu", *settings, "--jobs", "1", "--out", "run")
    for text in words(tmp_path / "run"):
        assert "The count" in text
        assert "Counted 1 flights." in text
    # Without the file it is the report of any flights, which says what it lacks.
    (tmp_path / "added.py").unlink()
    again = package.command("report", "run")
    assert again.returncode == 1
    shown, _ = words(tmp_path / "run")
    assert "Counted 1 flights." not in shown
    assert "added.py:Counting" in shown


def test_a_steering_law_takes_one_file(tmp_path):
    _, run = flown(
        tmp_path, "pursuit", LAW, "steering_law", "Pursuit", "guidance.law=pursuit",
        "guidance.pursuit_gain_per_s=1.1",
    )  # fmt: skip
    assert [row["outcome"] for row in rows(run)] == ["completed"]
    config = json.loads((run / "manifest.json").read_text(encoding="utf-8"))["config"]
    assert config["guidance"]["pursuit_gain_per_s"] == 1.1


def test_a_chart_in_html_and_pdf_takes_one_file(tmp_path):
    _, run = flown(tmp_path, "nearest", CHART, "report_section", "closest")
    for text in words(run):
        assert "Closest approaches in order" in text
        assert "The closest approach of each flight by its number." in text


@pytest.mark.parametrize(
    ("text", "words_of_error"),
    [
        (
            CHART.replace("min_distance_m", "no_such_column"),
            "closest() failed: KeyError: 'no_such_column' (added.py:",
        ),
        ("import no_such_module\n", "load() failed: ModuleNotFoundError"),
    ],
)
def test_a_section_that_fails_is_one_line_with_its_name(tmp_path, text, words_of_error):
    package = AddedPackage(
        tmp_path, {"added.py": text}, {"report_section": {"nearest": "added:closest"}}
    )
    settings = [word for key in SHORT for word in ("--set", key)]
    package.command("run", "sweep_nu", *settings, "--jobs", "1", "--out", "run", "--no-report")
    told = package.command("report", "run")
    assert told.returncode == 2
    error = told.stderr.splitlines()[-1]
    assert error.startswith("error: report section 'nearest'")
    assert words_of_error in error
