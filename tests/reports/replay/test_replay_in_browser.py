"""Reports of every kind that has a replay, opened from disk in a browser that has no network."""

import math
from dataclasses import replace

import numpy as np
import pytest
from browser import PROGRAM, Browser

from reports.document.blocks import FlightPicker
from reports.registry import content
from reports.render.html import write_html
from reports.run.run_data import read_run

pytestmark = pytest.mark.skipif(PROGRAM is None, reason="no chromium is installed; .ci/run installs it")

KINDS = ("sweep_nu", "monte_carlo", "sulphur", "paper", "trials")
"""Those with a replay. The page of the last one stays open for the tests after it."""

WHOLE = "sweep_nu"
"""The one whose page has all its charts."""


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    opened = Browser(tmp_path_factory.mktemp("profile"))
    yield opened
    opened.close()


def with_flights_alone(report):
    """Return a report whose sections hold nothing but the flights to be picked, each with one chart."""
    sections = []
    for section in report.sections:
        pickers = [block for block in section.blocks if isinstance(block, FlightPicker)]
        flights = [FlightPicker(flights=[replace(flight, charts=flight.charts[:1]) for flight in of.flights]) for of in pickers]
        sections.append(replace(section, blocks=flights))
    return replace(report, picture=None, sections=[section for section in sections if section.blocks])


@pytest.fixture(scope="module")
def page_of(run_of, tmp_path_factory):
    """A function from a study's name to its run as read, and to its page."""
    directory, pages = tmp_path_factory.mktemp("pages"), {}

    def page(name):
        if name not in pages:
            run = read_run(run_of(name))
            # One page is whole. Of the others the flights stay: charts take most of the time.
            report = content(run) if name == WHOLE else with_flights_alone(content(run))
            write_html(report, directory / f"{name}.html")
            pages[name] = run
        return pages[name], directory / f"{name}.html"

    return page


def show(browser, page, width=800):
    """Open a page, or, where it is open, give it a width."""
    if browser.run("location.href") == page.as_uri():
        browser.errors.clear()
        browser.resize(width)
    else:
        browser.open(page, width)


def turned(angle, other):
    """Return the angle between two courses or banks [rad]."""
    return abs(math.remainder(angle - other, math.tau))


@pytest.mark.parametrize("kind", KINDS)
def test_the_time_slider_takes_the_aircraft_to_where_it_was(kind, browser, page_of):
    run, page = page_of(kind)
    show(browser, page)
    flight = browser.run("document.getElementById('pick').value")
    history = run.history(flight)
    for share in (0.0, 0.37, 0.8):
        sample = history.iloc[round(share * (len(history) - 1))]
        moved = f"slider.value = {sample['time_s']}; slider.dispatchEvent(new Event('input')); return window.replay.place();"
        place = browser.run(f"(() => {{ const slider = document.querySelector('[data-part=time]'); {moved} }})()")
        # The slider's steps are those of the history, 0.1 s.
        assert place["time"] == pytest.approx(sample["time_s"], abs=1e-9)
        # Samples are good to 0.5 cm, the cubic between them to 3.4 cm in any of 60 flights of all studies, turbulence among them.
        for axis in ("north", "east"):
            assert place[axis] == pytest.approx(sample[f"{axis}_m"], abs=0.05)
        assert place["altitude"] == pytest.approx(sample["altitude_m"], abs=0.05)
        # A kinematic vehicle has no heading of its own. Angles are good to 1 mrad; where a bank begins to change, to 0.06 rad.
        heading = sample["heading_rad"] if np.isfinite(sample["heading_rad"]) else sample["course_rad"]
        assert turned(place["heading"], heading) < 0.02
        assert turned(place["roll"], np.nan_to_num(sample["roll_rad"])) < 0.06
    assert browser.errors == []


def test_nothing_is_asked_of_a_network_and_what_is_drawn_is_not_blank(browser, page_of):
    _, page = page_of("trials")
    show(browser, page)
    assert browser.run("performance.getEntriesByType('resource').map((entry) => entry.name)") == []
    assert browser.run("navigator.onLine") is False
    shades = browser.run(
        "(() => { const {world, camera, renderer} = window.replay, {width, height} = renderer.domElement;"
        " window.replay.place(); renderer.render(world.scene, camera.camera); const gl = renderer.getContext(),"
        " pixels = new Uint8Array(4 * width * height); gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);"
        " return new Set(new Uint32Array(pixels.buffer)).size; })()"
    )
    # Sky and sea alone would be a few shades.
    assert shades > 200


def test_the_keyboard_moves_time_camera_and_play(browser, page_of):
    _, page = page_of("trials")
    show(browser, page)
    browser.run("window.replay.seek(0), document.querySelector('[data-part=stage]').focus()")
    browser.press("ArrowRight")
    browser.press("ArrowRight")
    browser.press("ArrowLeft")
    # Two seconds on and one back, from the slider's place.
    assert browser.run("window.replay.place().time") == pytest.approx(1.0)
    for key, camera in (("1", "follow"), ("3", "free"), ("2", "vessel")):
        browser.press(key)
        assert browser.run("window.replay.mode") == camera
    seen = "(window.replay.place(), window.replay.camera.course)"
    before = browser.run(seen)
    browser.press("d")
    assert turned(browser.run(seen), before) == pytest.approx(0.1, abs=1e-6)
    browser.press(" ")
    assert browser.run("window.replay.playing") is True
    moved = "(function wait() { window.replay.time > 1 ? done(true) : requestAnimationFrame(wait); })()"
    assert browser.run(f"new Promise((done) => {moved})")
    browser.press(" ")
    assert browser.run("window.replay.playing") is False
    assert browser.errors == []


def test_the_navigation_leads_to_the_replay(browser, page_of):
    _, page = page_of("trials")
    show(browser, page)
    assert browser.run("document.querySelector('nav a[href=\"#replay\"]').hash === '#' + document.querySelector('.replay').id")


def test_the_page_is_not_wider_than_a_small_screen(browser, page_of):
    _, page = page_of("trials")
    show(browser, page, 520)
    widest = "Math.max(...[...document.querySelectorAll('.replay, .replay *')].map((part) => part.getBoundingClientRect().right))"
    assert browser.run(widest) <= 520
    assert browser.run("document.querySelector('[data-part=stage]').clientWidth") > 400


def test_figures_are_as_wide_in_print_whatever_the_window_and_as_before_after_it(browser, page_of):
    _, page = page_of("trials")
    drawn = "[...document.querySelectorAll('.js-plotly-plot')].map((plot) => [plot._fullLayout.width, plot.style.zoom])"
    for width in (520, 1200):
        show(browser, page, width)
        before = browser.run(drawn)
        browser.run("dispatchEvent(new Event('beforeprint'))")
        # The width of the page's text in print; those that are smaller still have their letters in proportion.
        assert {plot for plot, _ in browser.run(drawn)} == {1040}
        assert browser.run("document.getElementById('paper').media") == "print"
        browser.run("dispatchEvent(new Event('afterprint'))")
        browser.settle()
        assert browser.run(drawn) == before
    assert browser.errors == []


def test_another_flight_is_picked_and_those_without_a_history_have_no_replay(browser, page_of):
    run, page = page_of("trials")
    show(browser, page)
    shown = "document.getElementById('pick').value"
    before = browser.run(shown)
    browser.run("document.getElementById('next').click()")
    flight = browser.run(shown)
    assert flight != before
    assert browser.run("window.replay.place()")["north"] == pytest.approx(run.history(flight)["north_m"].iloc[0], abs=0.05)
    browser.run("window.replay.show('no such flight')")
    assert browser.run("document.getElementById('replay').hidden") is True


def test_without_webgl_a_sentence_stands_in_its_place_and_the_curves_stay(page_of, tmp_path):
    _, page = page_of("trials")
    without = Browser(tmp_path, "--disable-3d-apis")
    try:
        without.open(page)
        assert without.run("document.querySelector('[data-part=without]').innerText").startswith(
            "This browser does not draw in three"
        )
        assert without.run("window.replay.place()") is None
        without.run("window.replay.seek(12.5)")
        without.settle()
        assert without.run("document.querySelector('[data-part=clock]').textContent").startswith("12.5 s")
        assert without.errors == []
    finally:
        without.close()
