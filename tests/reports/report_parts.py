"""What the tests of reports look up in a report."""

import re
from dataclasses import replace

import pypdfium2
import pytest
from matplotlib.figure import Figure

from reports.build import build_reports
from reports.document.blocks import Fold
from reports.document.chart import Chart
from reports.registry import content
from reports.render.pdf import write_pdf
from reports.run.run_data import read_run
from scenarios.engine.processes import InProcessExecutor
from scenarios.scenario.files import load_study
from scenarios.studies.base import run_study


def flown(tmp_path_factory, scenario, overrides):
    """Fly a scenario with overrides and return the directory of the run."""
    path = tmp_path_factory.mktemp(scenario) / "run"
    run_study(
        load_study(scenario, overrides),
        scenario,
        path,
        executor_factory=InProcessExecutor,
        overrides=overrides,
    )
    return path


def flown_text(tmp_path_factory, name, text):
    """Fly the text of a scenario under a name and return the directory of the run."""
    folder = tmp_path_factory.mktemp(name)
    (folder / f"{name}.toml").write_text(text, encoding="utf-8")
    study = load_study(str(folder / f"{name}.toml"))
    run_study(study, name, folder / "run", executor_factory=InProcessExecutor)
    return folder / "run"


def built(path):
    """Build both reports of a run and return the HTML, once it is known to load nothing and to link
    to what it holds.
    """
    html, pdf = build_reports(path)
    text = html.read_text(encoding="utf-8")
    assert pdf.read_bytes().startswith(b"%PDF")
    assert not re.search(r"<(script|link|img)[^>]+(src|href)=", text)
    for anchor in re.findall(r'href="#(\w+)"', text):
        assert f'id="{anchor}"' in text
    return text


def blocks_of(report, kind, anchor=None):
    """Return the blocks of a kind, of the whole report or of one section, those behind folds too."""
    sections = [section for section in report.sections if anchor in (None, section.anchor)]
    blocks = [
        inner
        for section in sections
        for block in section.blocks
        for inner in (block, *(block.blocks if isinstance(block, Fold) else ()))
    ]
    return [block for block in blocks if isinstance(block, kind)]


def named_charts(report):
    """Return the charts outside the flights by name."""
    return {chart.name: chart for chart in blocks_of(report, Chart)}


def assert_axes_read_quantity_and_unit(charts):
    for chart in charts:
        for panel in chart.panels:
            named = any(not re.fullmatch(r"[\d.]+", name) for _, name in panel.y_names)
            for label, bare in (
                (panel.x_label, panel.x_whole),
                (panel.y_label, panel.y_whole or named),
            ):
                # Names and counts have no unit; an ordinate of names may share its label with the
                # panel to its left.
                assert re.fullmatch(r"[^\[]*" if bare else r".+ \[[^\]]+\]", label), (
                    chart.name,
                    label,
                )


def numbers_on_page_1(path, folder):
    """Return the numbers in headline, detail and tiles of page 1 of the PDF of a run, as they are
    printed, with no picture drawn; those in names of flights are none.
    """
    return numbers_of_page_1(content(read_run(path)), folder)


def numbers_of_page_1(report, folder):
    """Return the same of a report."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("reports.render.figure_files.draw", lambda _: Figure(figsize=(1.0, 1.0)))
        write_pdf(replace(report, sections=report.sections[-1:]), folder / "report.pdf")
    document = pypdfium2.PdfDocument(folder / "report.pdf")
    text = " ".join(document[0].get_textpage().get_text_range().split())
    document.close()
    begins = text.index(" ".join(report.verdict.headline.split()[:3]))
    ends = text.index(report.facts[0].name if report.facts else "Figure 1.")
    shown = text[begins:ends].replace("\N{MINUS SIGN}", "-")
    assert all(
        card.value.split()[0].replace("\N{MINUS SIGN}", "-") in shown
        for card in report.verdict.cards
    )
    return {
        number.replace(",", "") for number in re.findall(r"(?<![\w.])\d[\d,]*(?:\.\d+)?", shown)
    }
