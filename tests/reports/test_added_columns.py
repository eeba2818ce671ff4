"""What an instrument and a study of a user declare in a file stands in every report."""

import json

import numpy as np
import pandas as pd
import pytest
from report_parts import blocks_of, flown

from common.run_layout import COLUMNS
from reports.compare.content import compare, comparison_content
from reports.compare.pairs import read_runs
from reports.compare.table_of_pairs import write_differences
from reports.document.blocks import FlightPicker, Table
from reports.document.chart import Chart
from reports.registry import content
from reports.run.run_data import read_run

pytestmark = pytest.mark.slow

METER = """
import numpy as np
from common.columns import Column
from scenarios.instruments.instrument import Evaluation

class Meter:
    COLUMNS = {"glow_ppb": Column("brightness of the exhaust", title="Glow of the exhaust")}
    FIGURES = {
        "glow_peak_ppb": Column("largest brightness", title="Peak of the glow", digits=3, worse="higher"),
        "glow_word": Column("brightness in a word", title="Kind of glow", kind="text"),
    }

    def __init__(self, scenario, world, generator):
        self._gain = scenario.keepout.radius_m

    def evaluate(self, column, since):
        glow = self._gain * np.hypot(column("north_m"), column("east_m")) * 1e-3
        figures = {"glow_peak_ppb": float(glow.max()), "glow_word": "dim"}
        return Evaluation(columns=glow[:, None], figures=figures)
"""

STUDY = """
from common.columns import Column
from scenarios.flight_runner import FlightRunner
from scenarios.studies.base import FlightStudy
from dataclasses import fields

class Spare(FlightStudy):
    FIGURES = {"spare_m": Column("what is left of the radius", title="Spare distance", worse="lower")}

    def work(self, run):
        of = super().work(run)
        return SpareWork(**{field.name: getattr(of, field.name) for field in fields(of)})

class SpareWork(FlightRunner):
    def more_tables(self, request, plan, record, row):
        row["spare_m"] = row["min_distance_m"] - row["keepout_radius_m"]
        return {}
"""


SWEEP = (
    "fidelity=kinematic",
    "sweep.nu=[0.4,0.5]",
    "flight.crossings=2",
    "guidance.rate_hz=10",
    "comparison.nu=[]",
    "criteria.crossing_interval_error=0.1",
)


@pytest.fixture(scope="module")
def paths(tmp_path_factory):
    """Fly the same short sweep with two keep-out radii, which scale what the instrument reads."""
    folder = tmp_path_factory.mktemp("added")
    (folder / "meter.py").write_text(METER, encoding="utf-8")
    (folder / "mystudy.py").write_text(STUDY, encoding="utf-8")
    paths = []
    for radius in (200.0, 210.0):
        given = [
            *SWEEP,
            f"study={folder / 'mystudy.py'}:Spare",
            f'payload=["{folder / "meter.py"}:Meter"]',
            f"keepout.radius_m={radius}",
        ]
        paths.append(flown(tmp_path_factory, "sweep_nu", given))
    return paths


@pytest.fixture(scope="module")
def run(paths):
    return read_run(paths[0])


def test_the_run_says_what_its_columns_are(paths):
    found = json.loads((paths[0] / COLUMNS).read_text(encoding="utf-8"))
    header = (paths[0] / "summary.csv").read_text(encoding="utf-8").splitlines()[0].split(",")
    assert list(found["summary.csv"]) == header
    assert found["summary.csv"]["glow_peak_ppb"] == {
        "title": "Peak of the glow",
        "symbol": "",
        "unit": "ppb",
        "digits": 3,
        "meaning": "largest brightness",
        "worse": "higher",
        "part": "meter.py:Meter",
    }
    assert found["flights"]["glow_ppb"]["title"] == "Glow of the exhaust"


def test_figures_and_readings_stand_in_tables_and_charts(run):
    page = content(run)
    peaks = run.summary["glow_peak_ppb"]
    over, each = (
        next(table for table in blocks_of(page, Table) if table.caption.startswith(words))
        for words in ("The figures over all", "The same figures")
    )
    row = next(row for row in over.rows if row[0] == "Peak of the glow [ppb]")
    assert row[1:5] == [
        "2 of 2",
        *(f"{of:.3f}" for of in (peaks.min(), peaks.median(), peaks.max())),
    ]
    assert row[6] == run.summary["flight_id"][int(peaks.argmax())]
    panels = [panel for chart in blocks_of(page, Chart) for panel in chart.panels]
    (panel,) = (of for of in panels if of.y_label == "Peak of the glow [ppb]")
    assert sorted(np.concatenate([line.y for line in panel.lines])) == pytest.approx(sorted(peaks))
    assert "ν" in panel.x_label
    (picker,) = blocks_of(page, FlightPicker)
    charts = [chart for flight in picker.flights for chart in flight.charts]
    labels = [panel.y_label for chart in charts for panel in chart.panels]
    assert labels.count("Glow of the exhaust [ppb]") == 2
    spare = run.summary["min_distance_m"] - run.summary["keepout_radius_m"]
    rows = [row for table in blocks_of(page, Table) for row in table.rows]
    (row,) = (row for row in rows if row[0] == "Spare distance [m]")
    assert row[3] == f"{spare.median():.2f}"
    assert each.head == ["Flight", "Peak of the glow [ppb]", "Kind of glow"]
    assert [of[1:] for of in each.rows] == [[f"{peak:.3f}", "dim"] for peak in peaks]


def test_a_figure_is_compared_between_runs(paths, tmp_path):
    runs = read_runs(paths)
    compared = compare(runs)
    found = compared[0].found["glow_peak_ppb"]
    # What is read scales with the radius; the flights themselves differ, too.
    assert found.change == pytest.approx(found.after - found.before)
    assert (found.change != 0.0).all()
    page = comparison_content(runs, compared)
    titles = [row[0] for table in blocks_of(page, Table) for row in table.rows]
    assert "Peak of the glow, worst [ppb]" in titles
    assert "Peak of the glow [ppb]" in titles
    write_differences(compared, tmp_path / "differences.csv")
    written = pd.read_csv(tmp_path / "differences.csv")
    assert written["glow_peak_ppb_difference"].to_numpy() == pytest.approx(found.change)
