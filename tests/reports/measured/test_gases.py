"""Every gas of a log on the page of its estimate, with its limit and the stages of NOx."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from report_parts import assert_axes_read_quantity_and_unit

from measurement.log.command import main
from reports.document.blocks import Table
from reports.document.chart import Chart
from reports.measurement.content import gas_sections, samples_chart, stage_chart
from reports.registry import content
from reports.run.run_data import read_run

pytestmark = pytest.mark.slow

EXAMPLE = Path(__file__).parents[3] / "docs" / "examples" / "example_flight.csv"

CONFIG = """
instrument = "electrochemical"
[engine]
keel_laid = 2022-05-01
rated_rpm = 120
control_area = "north_sea"
design_speed_mps = 13.0
speed_mps = 12.0
"""


@pytest.fixture(scope="module")
def directory(tmp_path_factory):
    out = tmp_path_factory.mktemp("gases")
    table = pd.read_csv(EXAMPLE)
    generator = np.random.default_rng(1)
    excess = table["co2_ppm"] - table["co2_ppm"].quantile(0.05)
    read = 1.95 + 0.07 * excess + 0.004 * generator.standard_normal(len(table))
    table["ch4_ppm"] = read.round(4)
    table.to_csv(out / "flight.csv", index=False)
    (out / "own.toml").write_text(CONFIG, encoding="utf-8")
    words = [str(out / "flight.csv"), "--config", str(out / "own.toml"), "--out", str(out / "run")]
    assert main([*words, "--no-report"]) == 0
    return out / "run"


@pytest.fixture(scope="module")
def record(directory):
    return json.loads((directory / "estimate.json").read_text(encoding="utf-8"))


def test_the_page_has_a_row_and_samples_for_every_gas(directory, record):
    sections = content(read_run(directory)).sections
    section = next(section for section in sections if section.anchor == "gases")
    table = next(block for block in section.blocks if isinstance(block, Table))
    assert [row[0] for row in table.rows] == ["NOx", "CH4"]
    nox = record["gases"][0]
    # A ship of stage III with 12 g/kWh, at 1.5 times 3.4 g/kWh for one load.
    assert table.rows[0][2] == f"{nox['value']:.2f}"
    assert table.rows[0][6:] == ["5.1, stage III", "above", nox["quality"]]
    assert table.rows[1][6:8] == ["none", "none"]
    assert "certifies nothing" in table.caption
    assert "CH4: no limit on this gas" in table.caption
    charts = [block for block in section.blocks if isinstance(block, Chart)]
    assert [chart.name for chart in charts] == ["gas-samples", "stages"]
    assert_axes_read_quantity_and_unit(charts)


def test_samples_lie_about_their_slope(record):
    panels = samples_chart(record["gases"]).panels
    for panel, of in zip(panels, record["gases"], strict=True):
        samples, line = panel.lines
        slope = np.diff(line.y)[0] / np.diff(line.x)[0]
        assert slope == pytest.approx(of["slope"])
        assert np.corrcoef(samples.x, samples.y)[0, 1] > 0.9


def test_stages_are_drawn_with_what_was_measured(record):
    panel = stage_chart(record["gases"]).panels[0]
    curves = {line.label: line for line in panel.lines}
    for stage, slow, fast in (("I", 17.0, 9.8), ("II", 14.4, 7.7), ("III", 3.4, 2.0)):
        assert curves[f"stage {stage}"].y[[0, -1]].tolist() == [slow, fast]
    nox = record["gases"][0]
    measured = curves["measured, 95 % interval"]
    assert (measured.x[0], measured.y[0]) == (120.0, nox["value"])
    assert measured.y[0] - measured.error[0, 0] == pytest.approx(nox["low"])
    assert measured.y[0] + measured.error[1, 0] == pytest.approx(nox["high"])
    assert curves["limit at one load"].y[0] == pytest.approx(5.1)


def test_a_log_without_other_gases_has_no_such_section(record):
    assert gas_sections({**record, "gases": []}) == []
    assert gas_sections({name: of for name, of in record.items() if name != "gases"}) == []
    rejected = [{**record["gases"][0], "quality": "C", "value": None, "stage": None}]
    assert stage_chart(rejected) is None


def test_a_flight_without_so2_is_judged_by_its_gases(directory, tmp_path, record):
    for name in ("manifest.json", "samples.csv"):
        (tmp_path / name).write_bytes((directory / name).read_bytes())
    text = json.dumps({**record, "estimate": None})
    (tmp_path / "estimate.json").write_text(text, encoding="utf-8")
    found = content(read_run(tmp_path))
    assert not found.verdict.holds
    assert not found.verdict.complete
    assert "NOx" in found.verdict.headline
    assert "limit 5.1, stage III: above" in found.verdict.headline
    assert "CH4" in found.verdict.detail
    assert [panel.title for panel in found.picture.panels] == ["NOx", "CH4"]
    anchors = {section.anchor for section in found.sections}
    assert "gases" in anchors
    assert not anchors & {"result", "instrument"}
    instrument = next(fact for fact in found.facts if fact.name == "Instrument")
    assert "figures are in" not in instrument.value
