"""The report of a log with missing readings and gaps: it counts them, and shows nothing in them."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from report_parts import blocks_of, named_charts

from measurement.log.command import main
from reports.document.blocks import Table
from reports.registry import content
from reports.run.run_data import read_run

pytestmark = pytest.mark.slow

EXAMPLE = Path(__file__).parents[3] / "docs" / "examples"


def estimated(folder, *missing):
    """Return a run of the example's log, a reading a second, without a row, with a gap, and with
    cells that are missing.
    """
    table = pd.read_csv(EXAMPLE / "example_flight.csv")
    for column, rows in (("co2_ppm", [50]), *missing):
        table.loc[rows, column] = np.nan
    table.drop(index=[100, *range(150, 170)]).to_csv(folder / "log.csv", index=False)
    config = str(EXAMPLE / "example_instrument.toml")
    assert (
        main(
            [
                str(folder / "log.csv"),
                "--config",
                config,
                "--out",
                str(folder / "out"),
                "--no-report",
            ]
        )
        == 0
    )
    return read_run(folder / "out")


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return estimated(tmp_path_factory.mktemp("gaps"))


@pytest.fixture(scope="module")
def report(run):
    return content(run)


def test_missing_readings_and_gaps_are_counted_on_page_1_and_in_the_record(report):
    # 301 rows of the example less 21; from the reading at 149 s to that at 170 s; and at 50 s and
    # 100 s one sample each.
    told = {
        "Missing readings": "1 of CO2 in 280 rows",
        "Gaps": "1 of 21 s from 149 s on; 2 samples in short ones interpolated, not shown as readings",
    }
    assert told.items() <= {fact.name: fact.value for fact in report.facts}.items()
    (record,) = blocks_of(report, Table, "record")
    assert told.items() <= dict(record.rows).items()


def test_holes_of_the_log_are_told_apart_from_readings_that_are_too_few_to_use(tmp_path):
    # Without CO2 for 3 s after 219 s and 4 s after 227 s: of 6 readings between them, from 222 s
    # on, none is used.
    report = content(estimated(tmp_path, ("co2_ppm", [*range(220, 222), *range(228, 231)])))
    told = {fact.name: fact.value for fact in report.facts}
    assert told["Missing readings"] == "6 of CO2 in 280 rows"
    assert told["Gaps"] == (
        "3 of 28 s in all, the longest 21 s from 149 s on; 2 samples in short ones interpolated, not shown as readings;"
        " 6 rows beside gaps left out, as fewer than 8 in a row are too few to use"
    )


def test_a_sample_that_is_interpolated_has_no_reading(run):
    samples = pd.read_csv(run.path / "samples.csv").set_index("time_s")
    readings = samples[["so2_ppb", "co2_ppm", "no_ppb", "no2_ppb"]]
    assert list(readings.index[readings.isna().all(axis=1)]) == [50.0, 100.0]
    assert readings.drop([50.0, 100.0]).notna().all(axis=None)
    assert samples["fit_ppb"].notna().all()


def test_figures_draw_nothing_where_the_log_has_no_readings(report):
    charts = named_charts(report)
    (co2,) = [line for line in charts["channels"].panels[0].lines if line.label == "reading"]
    time = co2.x[np.isfinite(co2.y)]
    assert not np.any((time > 149.5) & (time < 169.5))
    assert np.isnan(co2.y[np.searchsorted(np.nan_to_num(co2.x, nan=160.0), 160.0)])
    assert "Lines end where the log has no readings, and where" in charts["channels"].caption
    # 280 rows, one of them without CO2.
    assert len(charts["regression"].panels[0].lines[0].x) == 279
    height = charts["track"].panels[1].lines[0]
    assert len(height.x) < len(co2.x) * 2500 / 300
    assert "no track is drawn" in charts["track"].caption


def test_a_whole_log_has_no_word_of_gaps_on_page_1(tmp_path):
    config = str(EXAMPLE / "example_instrument.toml")
    assert (
        main(
            [
                str(EXAMPLE / "example_flight.csv"),
                "--config",
                config,
                "--out",
                str(tmp_path),
                "--no-report",
            ]
        )
        == 0
    )
    report = content(read_run(tmp_path))
    assert {"Missing readings", "Gaps"}.isdisjoint({fact.name for fact in report.facts})
    assert "no track" not in named_charts(report)["track"].caption


def test_quality_c_is_not_called_open_and_says_what_to_do_next(tmp_path, capsys):
    report = content(estimated(tmp_path, ("co2_ppm", range(200, 261))))
    console = capsys.readouterr().out
    step = "analyse the parts of the log that are free of it as separate logs"
    assert step in report.verdict.detail
    assert step in console
    assert {card.value for card in report.verdict.figures if card.name.startswith("Time to")} == {
        "none: quality C"
    }


def test_a_result_with_a_verdict_on_every_limit_needs_no_next_step(report):
    assert "Next:" not in report.verdict.detail
