"""Page 1: what a client has to know, with its date, its figures coloured by their criterion and a
picture, on one page.
"""

import re
import shutil
from dataclasses import replace

import pypdfium2
import pytest

from common.verdict import INTERRUPTED, MET, NOT_MET, UNEXPLAINED
from reports.document.blocks import Card, LossCard, UndecidedCard, Verdict
from reports.flights.first_page import telling_and_typical
from reports.registry import content
from reports.render.pdf import write_pdf
from reports.run.run_data import read_run
from reports.run.trials import read_trials

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def report(five_path):
    return content(read_run(five_path))


def pages_of(path):
    """Return the text of each page of a PDF."""
    document = pypdfium2.PdfDocument(path)
    texts = [page.get_textpage().get_text_range() for page in document]
    document.close()
    return texts


def test_page_1_is_one_page_however_much_failed(report, tmp_path):
    long = "a flight that failed, " * 15
    verdict = replace(report.verdict, detail=long * 2, failures=[long] * 9)
    write_pdf(
        replace(report, verdict=verdict, sections=report.sections[-1:]), tmp_path / "report.pdf"
    )
    first, second, *_ = pages_of(tmp_path / "report.pdf")
    assert "Figure 1." in first
    assert "and 5 more" in first
    assert "Figure 1." not in second


@pytest.mark.parametrize(
    ("card", "exit_status", "tone"),
    [
        (Card("a", "1", "≤ 2", met=True), MET, "good"),
        (Card("a", "1"), MET, "good"),
        (UndecidedCard("a", "1", "2"), MET, "warn"),
        (LossCard("a", "1", "allowed"), MET, "warn"),
        (Card("a", "3", "≤ 2", met=False), MET, "bad"),
        (Card("a", "1", "≤ 2", met=True), NOT_MET, "warn"),
        (Card("a", "1", "≤ 2", met=True), INTERRUPTED, "warn"),
        (Card("a", "1", "≤ 2", met=True), UNEXPLAINED, "bad"),
    ],
)
def test_the_box_has_the_colour_of_its_worst_tile_and_is_never_better_than_the_exit_status(
    card, exit_status, tone
):
    others = [Card(str(i), "1", "1", met=True) for i in range(9)]
    verdict = Verdict(
        headline="", detail="", failures=[], figures=[*others, card], exit_status=exit_status
    )
    assert verdict.tone == tone
    # The tile that makes the colour is on page 1.
    assert (card in verdict.cards) is (card.tone in ("missed", "open"))


@pytest.mark.usefixtures("without_single_flights")
def test_every_kind_of_study_has_its_exit_status_from_one_place(five_path):
    run = read_run(five_path)
    for study in ("flights", "trials", "monte_carlo", "falsify", "premises"):
        of_study = replace(run, manifest=run.manifest | {"study": study})
        for interrupted in (False, True):
            judgement = of_study.verdict.once_interrupted(interrupted=interrupted)
            verdict = content(replace(of_study, judgement=judgement)).verdict
            assert verdict.exit_status == judgement.exit_status
            assert verdict.headline.startswith("INTERRUPTED") is interrupted


def without_histories(five_path, tmp_path, gone):
    """Return the run without the time histories of flights, by their rank in closest approach, and
    all ranked.
    """
    copy = shutil.copytree(five_path, tmp_path / "run")
    ranked = read_run(copy).summary.sort_values("min_distance_m")
    for rank in gone:
        (copy / "flights" / f"{ranked['flight_id'].iloc[rank]}.parquet").unlink()
    return read_run(copy), ranked["min_distance_m"].tolist()


@pytest.mark.parametrize(
    ("gone", "nearest"), [((), {2}), ((3, 4), {2}), ((2,), {1, 3}), ((0, 1, 2), {3})]
)
def test_the_typical_flight_is_at_the_median_of_all_flights_or_nearest_to_it(
    five_path, tmp_path, gone, nearest
):
    run, distances = without_histories(five_path, tmp_path, gone)
    picture = telling_and_typical(read_trials(run))
    typical = min(nearest, key=lambda rank: abs(distances[rank] - distances[2]))
    closest = min(set(range(5)) - set(gone))
    words = "the flight with the closest approach" + (
        " of those with a time history." if gone else "."
    )
    assert words in picture.caption
    if closest == typical:
        # One flight is both: all its tracks are shown, and below them its name.
        assert re.search(
            r" Closest: short_0000\d, the flight with the closest approach[^.]*\.$", picture.caption
        )
        assert "Typical" not in picture.caption
    else:
        shown = [float(re.search(r"([\d.]+) m$", panel.title)[1]) for panel in picture.panels]
        assert shown == [round(distances[rank], 1) for rank in (closest, typical)]
        words = "of these the one nearest" if 2 in gone else "the one whose closest approach is"
        assert re.search(rf"Typical: short_0000\d, {words}", picture.caption)
