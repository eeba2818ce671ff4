"""A report with a replay, opened from disk in a browser that has no network; pages in a narrow
window.
"""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from browser import PROGRAM, Browser
from report_parts import blocks_of

from reports.document.blocks import FlightPicker
from reports.registry import content
from reports.render.html import write_html
from reports.run.run_data import read_run

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(PROGRAM is None, reason="no chromium is installed; .ci/run installs it"),
]


KINDS = ("sweep_nu", "trials", "sulphur")
"""Studies whose flights are on the page."""

WIDTH, HEIGHT = 520, 390
"""Of the window [px]: a processor draws what a graphics processor would, and takes longer for more
of it.
"""


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    opened = Browser(tmp_path_factory.mktemp("profile"))
    yield opened
    opened.close()


@pytest.fixture(scope="module")
def runs(run_of):
    return {kind: read_run(run_of(kind)) for kind in KINDS}


@pytest.fixture(scope="module")
def page(runs, tmp_path_factory):
    """The page of the first study with the flights of the others, each with one chart, and called
    by its study before its name.
    """
    reports = {kind: content(run) for kind, run in runs.items()}
    flights = [
        replace(flight, flight_id=f"{kind}/{flight.flight_id}", charts=flight.charts[:1])
        for kind, report in reports.items()
        for block in blocks_of(report, FlightPicker)
        for flight in block.flights
    ]
    report = reports[KINDS[0]]
    sections = [
        replace(section, blocks=[FlightPicker(flights=flights)])
        if section.anchor == "flights"
        else section
        for section in report.sections
    ]
    path = tmp_path_factory.mktemp("page") / "report.html"
    write_html(replace(report, sections=sections), path)
    return path


def show(browser, page, width=WIDTH):
    """Open a page, or, where it is open, give it a width."""
    if browser.run("location.href") == page.as_uri():
        browser.errors.clear()
        browser.resize(width, HEIGHT)
    else:
        browser.open(page, width, HEIGHT)


def picked(browser, first=""):
    """Return the name of the flight that is picked, after the first one was whose name begins so."""
    known = f"[...pick.options].map((option) => option.value).find((value) => value.startsWith({json.dumps(first)}))"
    change = f"if (!pick.value.startsWith({json.dumps(first)})) {{ pick.value = {known}; pick.dispatchEvent(new Event('change')); }}"
    return browser.run(
        f"(() => {{ const pick = document.getElementById('pick'); {change} return pick.value; }})()"
    )


def turned(angle, other):
    """Return the angle between two courses or banks [rad]."""
    return abs(math.remainder(angle - other, math.tau))


def test_a_flight_opens_before_its_closest_approach_and_plays_once_it_is_seen(browser, runs, page):
    # Played from the top of the page, where the replay is not seen yet.
    browser.open(page, WIDTH, HEIGHT)
    flight = picked(browser, "sulphur/").removeprefix("sulphur/")
    history = runs["sulphur"].history(flight)
    north, east = (history[f"{axis}_m"] - history[f"vessel_{axis}_m"] for axis in ("north", "east"))
    # The least distance is that of a sample of the replay, 0.2 s apart, and the height is the same.
    nearest = history["time_s"].iloc[np.hypot(north, east).argmin()]
    opened = browser.run("window.replay.time")
    # Four seconds before, to a sample of 0.2 s; it may have begun to play.
    assert nearest - 4.5 <= opened <= nearest + 8.0
    browser.run("document.getElementById('replay').scrollIntoView()")
    moves = "new Promise((done) => setTimeout(() => done(window.replay.playing), 500))"
    assert browser.run(moves) is True
    assert browser.run("window.replay.time") > nearest - 4.5
    browser.run("window.replay.play(false)")
    jumps = "[...document.querySelectorAll('[data-part=jumps] button')].map((b) => b.textContent)"
    assert {"start", "closest approach", "end"} <= set(browser.run(jumps))


@pytest.mark.parametrize("kind", KINDS)
def test_the_time_slider_takes_the_aircraft_to_where_it_was(kind, browser, runs, page):
    show(browser, page)
    flight = picked(browser, f"{kind}/").removeprefix(f"{kind}/")
    history = runs[kind].history(flight)
    for share in (0.0, 0.37, 0.8):
        sample = history.iloc[round(share * (len(history) - 1))]
        moved = f"slider.value = {sample['time_s']}; slider.dispatchEvent(new Event('input')); return window.replay.place();"
        place = browser.run(
            f"(() => {{ const slider = document.querySelector('[data-part=time]'); {moved} }})()"
        )
        # The slider's steps are those of the history, 0.1 s.
        assert place["time"] == pytest.approx(sample["time_s"], abs=1e-9)
        # Samples are good to 0.5 cm, the cubic between them to 3.4 cm in any of 60 flights of all
        # studies, turbulence among them.
        for axis in ("north", "east"):
            assert place[axis] == pytest.approx(sample[f"{axis}_m"], abs=0.05)
        assert place["altitude"] == pytest.approx(sample["altitude_m"], abs=0.05)
        # A kinematic vehicle has a course alone. Angles are good to 1 mrad; where a bank
        # begins to change, to 0.06 rad.
        heading = (
            sample["heading_rad"] if np.isfinite(sample["heading_rad"]) else sample["course_rad"]
        )
        assert turned(place["heading"], heading) < 0.02
        assert turned(place["roll"], np.nan_to_num(sample["roll_rad"])) < 0.06
        assert browser.run("window.replay.world.smoke.mesh.geometry.instanceCount") > 50
    assert browser.errors == []


def test_the_page_loads_nothing_and_its_picture_is_not_blank(browser, page):
    show(browser, page)
    assert browser.run("performance.getEntriesByType('resource').map((entry) => entry.name)") == []
    shades = browser.run(
        "(() => { const {world, camera, renderer} = window.replay, {width, height} = renderer.domElement;"
        " window.replay.place(); renderer.render(world.scene, camera.camera); const gl = renderer.getContext(),"
        " pixels = new Uint8Array(4 * width * height); gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);"
        " return new Set(new Uint32Array(pixels.buffer)).size; })()"
    )
    # Sky and sea alone would be a few shades.
    assert shades > 200


def test_smoke_is_where_the_parcels_are_and_the_gas_is_that_of_the_file(browser, runs, page):
    show(browser, page)
    flight = picked(browser, "sulphur/").removeprefix("sulphur/")
    run = runs["sulphur"]
    smoke, history = run.smoke(flight), run.history(flight)
    when = 30.0
    drawn = {
        number: (north, east, up)
        for number, north, east, up in browser.run(
            f"(() => {{ const all = []; window.replay.flight.smoke.each({when}, (i, p) =>"
            " all.push([i, p.north, p.east, p.height])); return all; })()"
        )
    }
    assert len(drawn) > 20
    north, east, across = (np.array(smoke[name]) for name in ("north", "east", "across"))
    emitted = smoke["first"] + smoke["step"] * np.arange(len(north))
    drift = [np.interp(when, emitted, smoke[f"drift_{axis}"]) for axis in ("north", "east")]
    ages = np.linspace(0.0, smoke["age_max"], len(smoke["table"][0]))
    for i, place in drawn.items():
        height, _, _, meander_y, meander_z = (
            np.interp(when - emitted[i], ages, [row[k] for row in smoke["table"][0]])
            for k in range(5)
        )
        away = np.array([north[i - 1] - north[i + 1], east[i - 1] - east[i + 1]])
        along = away / np.hypot(*away)
        expected = (
            north[i] + drift[0] - meander_y * across[i] * along[1],
            east[i] + drift[1] + meander_y * across[i] * along[0],
            abs(height + meander_z * smoke["up"][i]),
        )
        # What is sent is rounded to 5 cm, and to a hundredth of a meander of 10 m.
        assert place == pytest.approx(expected, abs=0.25)
    read = history["co2_reading_ppm"].to_numpy()
    for time in (20.0, 40.0, 60.0):
        gas = browser.run(f"window.replay.flight.at({time}).gas")
        # The cubic between samples of a reading that stays and jumps.
        near = read[np.abs(history["time_s"] - time) < 0.5] - np.nanquantile(read, 0.05)
        assert near.min() - 0.1 * np.ptp(near) - 0.1 <= gas <= near.max() + 0.1 * np.ptp(near) + 0.1
    assert browser.errors == []


def test_the_keyboard_moves_time_camera_and_play(browser, page):
    show(browser, page)
    browser.run(
        "window.replay.play(false), window.replay.seek(0),"
        " document.querySelector('[data-part=stage]').focus()"
    )
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
    moved = (
        "(function wait() { window.replay.time > 1 ? done(true) : requestAnimationFrame(wait); })()"
    )
    assert browser.run(f"new Promise((done) => {moved})")
    browser.press(" ")
    assert browser.run("window.replay.playing") is False
    assert browser.errors == []


def test_a_flight_opens_with_its_aircraft_in_the_picture(browser, page):
    show(browser, page)
    place = (
        "(() => { const {world, camera} = window.replay; window.replay.place();"
        " const at = world.aircraft.position.clone().project(camera.camera); return [at.x, at.y, at.z]; })()"
    )
    for kind in KINDS:
        picked(browser, f"{kind}/")
        browser.run("window.replay.look('vessel')")
        # Of the picture from -1 to 1; 1 is how far the camera sees.
        assert np.max(np.abs(browser.run(place))) < 1.0, kind
        # Nearer by its end, where the aircraft is; a view that was turned by hand keeps its
        # distance.
        far = (
            "window.replay.camera.camera.position.distanceTo(window.replay.camera.controls.target)"
        )
        begun = browser.run(far)
        browser.run("window.replay.seek(window.replay.flight.end)")
        ended = browser.run(f"(window.replay.place(), {far})")
        assert ended <= begun * 1.001, kind
        browser.run("window.replay.camera.move(0.1, 0, 1.5)")
        turned_by_hand = browser.run(far)
        browser.run("window.replay.seek(0)")
        assert browser.run(f"(window.replay.place(), {far})") == pytest.approx(turned_by_hand), kind


def test_without_webgl_a_sentence_stands_in_its_place_and_the_curves_stay(browser, page):
    without = """{
        const known = HTMLCanvasElement.prototype.getContext;
        HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
            return kind.startsWith("webgl") ? null : known.call(this, kind, ...more);
        };
    }"""
    script = browser.send("Page.addScriptToEvaluateOnNewDocument", source=without)["identifier"]
    try:
        browser.open(page)
        assert browser.run("document.querySelector('[data-part=without]').innerText").startswith(
            "This browser does not draw in three"
        )
        assert browser.run("window.replay.place()") is None
        browser.run("window.replay.seek(12.5)")
        browser.settle()
        assert browser.run("document.querySelector('[data-part=clock]').textContent").startswith(
            "12.5 s"
        )
        assert browser.errors == []
    finally:
        browser.send("Page.removeScriptToEvaluateOnNewDocument", identifier=script)
