"""What the page holds of a flight for its replay."""

import base64
import json
import math
import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from reports.document.blocks import FlightPicker
from reports.document.scene import COLUMNS
from reports.registry import content
from reports.render import html, replay
from reports.replay.flight_scene import INTERVAL, flight_scene
from reports.run.run_data import read_run
from reports.run.trials import read_trials

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def trial(run_of):
    return read_trials(read_run(run_of("sweep_nu")))[0]


@pytest.fixture(scope="module")
def row(trial):
    return trial.rows.iloc[0]


@pytest.fixture(scope="module")
def scene(trial, row):
    return flight_scene(trial, row, history_of(trial, row))


@pytest.fixture(scope="module")
def measured(run_of):
    """A trial whose flight measured in a plume, and its row."""
    trial = read_trials(read_run(run_of("sulphur")))[0]
    return trial, trial.rows.iloc[0]


def history_of(trial, row):
    return trial.run.history(row["flight_id"])


def with_history(trial, row, **columns):
    """Return the scene of a flight whose time history has other columns."""
    return flight_scene(trial, row, history_of(trial, row).assign(**columns))


def decoded(column, samples):
    if "data" not in column:
        return np.linspace(column["first"], column["last"], samples)
    numbers, value, place = [], 0, 0
    for byte in base64.b64decode(column["data"]):
        value, place = value | (byte & 127) << place, place + 7
        if byte < 128:
            numbers.append(-(value + 1) // 2 if value % 2 else value // 2)
            value = place = 0
    return column["step"] * np.cumsum(np.cumsum(numbers))


def test_a_scene_has_the_samples_of_the_history_a_fifth_of_a_second_apart(trial, row, scene):
    history = history_of(trial, row)
    every = {name: history[name].to_numpy()[::2] for name in history}
    assert set(scene.columns) == set(COLUMNS)
    assert scene.interval == INTERVAL
    samples = len(scene.columns["north"])
    assert samples == len(every["time_s"])
    # Both were recorded at these times: nothing but rounding.
    for axis in ("north", "east"):
        assert scene.columns[f"vessel_{axis}"] == pytest.approx(every[f"vessel_{axis}_m"], abs=1e-6)
        assert scene.columns[axis] + every[f"vessel_{axis}_m"] == pytest.approx(
            every[f"{axis}_m"], abs=1e-6
        )
    assert np.cos(scene.columns["heading"]) == pytest.approx(np.cos(every["course_rad"]), abs=1e-9)


def test_what_is_sent_is_the_scene_to_half_a_step(scene):
    data = replay.draw_scene(scene)
    for name, values in scene.columns.items():
        sent = decoded(data["columns"][name], data["samples"])
        # A step is 1 cm or 2 mrad, that of speeds and gases coarser; 1e-6 is what a column that is
        # sent as straight may deviate.
        step = 0.002 if name in ("heading", "pitch", "roll") else STEPS.get(name, 0.01)
        assert sent == pytest.approx(values, abs=0.5001 * step + 1e-6), name
    # A ship on a steady course is sent by two numbers.
    assert set(data["columns"]["vessel_north"]) == {"first", "last"}
    json.dumps(data, allow_nan=False)


STEPS = {"gas": 0.1, "airspeed": 0.05, "wind_north": 0.05, "wind_east": 0.05, "apparent_drift": 0.1}


@given(values=arrays(np.float64, st.integers(2, 40), elements=st.floats(-1e7, 1e7)))
def test_any_column_arrives_to_half_a_step(values):
    sent = decoded(replay.packed_column(values, 0.01), len(values))
    # 1e-6 as above; sums of steps of up to 1e7 m are good to 1e-8.
    assert np.abs(sent - values).max() <= 0.5001 * 0.01 + 1e-6


def test_courses_have_no_jumps_and_what_is_not_known_stays(trial, row):
    time = history_of(trial, row)["time_s"].to_numpy()
    heading = np.mod(0.1 * time, 2.0 * np.pi)
    lost = np.where(time > 20.0, np.nan, 55.0 + 0.1 * time)
    scene = with_history(trial, row, heading_rad=heading, altitude_m=lost)
    # To rounding: a turn at a steady rate is a straight line.
    assert np.diff(scene.columns["heading"]) == pytest.approx(0.1 * INTERVAL, abs=1e-9)
    assert scene.columns["altitude"][-1] == pytest.approx(57.0)


def test_parcels_of_the_exhaust_that_was_flown_in_are_in_the_scene(measured):
    history = history_of(*measured)
    scene = flight_scene(*measured, history)
    sent = replay.draw_scene(scene)["smoke"]
    for name in ("north", "east", "wind", "across", "up", "drift_north", "drift_east"):
        # Half a step of 5 cm, or of a hundredth of a standard deviation, and what the file rounds.
        assert decoded(sent[name], sent["count"]) == pytest.approx(scene.smoke[name], abs=0.031)
    # From those that are old at the start to those of the flight's end.
    time = sent["first"] + sent["step"] * np.arange(sent["count"])
    assert time[0] < 0.0 < history["time_s"].iloc[-1] < time[-1] + sent["step"]


def test_the_track_is_coloured_by_the_gas_above_its_background(measured):
    history = history_of(*measured)
    scene = flight_scene(*measured, history)
    assert (scene.gas.name, scene.gas.unit, scene.gas.source) == ("CO2", "ppm", "as read")
    read = history["co2_reading_ppm"].to_numpy()
    background = np.nanquantile(read, 0.05)
    at = np.interp(0.2 * np.arange(len(scene.columns["gas"])), history["time_s"], read)
    assert scene.columns["gas"] == pytest.approx(at - background, abs=1e-6)
    assert 0.0 < scene.gas.most < np.nanmax(read) - background


def test_one_can_go_to_the_closest_approach_and_to_what_happened(trial, row):
    history = history_of(trial, row)
    guard = np.where(history["time_s"] >= 10.0, 1.0, 0.0)
    happened = row.copy()
    happened["fault_time_s"] = 7.5
    scene = flight_scene(trial, happened, history.assign(guard=guard))
    events = dict(scene.events)
    assert list(events.values()) == sorted(events.values())
    assert (events["fault"], events["guard acts"]) == (7.5, 10.0)
    nearest = np.hypot(
        history["north_m"] - history["vessel_north_m"], history["east_m"] - history["vessel_east_m"]
    ).argmin()
    assert events["closest approach"] == pytest.approx(
        history["time_s"].iloc[nearest], abs=INTERVAL
    )


def test_each_of_several_faults_is_an_event_at_its_time(trial, row):
    happened = row.copy()
    happened["fault"], happened["fault_time_s"] = "vessel_data", 7.5
    happened["fault_2"], happened["fault_2_time_s"] = "engine", 9.0
    happened["fault_3"], happened["fault_3_time_s"] = "none", math.nan
    events = dict(flight_scene(trial, happened, history_of(trial, row)).events)
    found = {name: time for name, time in events.items() if name.startswith("fault")}
    assert found == {"fault 1, vessel data": 7.5, "fault 2, engine": 9.0}


def test_an_axis_without_smoke_drifts_with_the_air_past_the_ship(trial, row):
    scene = flight_scene(trial, row, history_of(trial, row))
    assert scene.smoke is None
    history = history_of(trial, row)
    # In calm air as fast as the ship.
    speed = np.hypot(history["vessel_velocity_north_mps"], history["vessel_velocity_east_mps"])
    assert np.diff(scene.columns["apparent_drift"]) == pytest.approx(
        INTERVAL * speed.iloc[0], rel=1e-6
    )


@pytest.mark.parametrize("samples", [0, 1, 2])
def test_without_a_time_history_of_some_length_there_is_no_scene(trial, row, samples):
    history = history_of(trial, row).iloc[:samples] if samples else None
    assert flight_scene(trial, row, history) is None


@pytest.mark.parametrize("value", [np.inf, np.nan, 1e300])
def test_a_damaged_time_history_makes_no_page_that_cannot_be_read(trial, row, value):
    clean = history_of(trial, row)
    for name in ("time_s", "north_m", "altitude_m", "roll_rad", "vessel_north_m", "plume_axis_rad"):
        damaged = clean[name].to_numpy().copy()
        damaged[-1] = value
        scene = with_history(trial, row, **{name: damaged})
        if scene is not None:
            json.dumps(replay.draw_scene(scene), allow_nan=False)


class Scripts(HTMLParser):
    """The texts of the elements of a page that are scripts, by their identifiers."""

    def __init__(self):
        super().__init__()
        self.texts, self._name = {}, None

    def handle_starttag(self, tag, attrs):
        self._name = dict(attrs).get("id", str(len(self.texts))) if tag == "script" else None

    def handle_data(self, data):
        if self._name is not None:
            self.texts[self._name] = self.texts.get(self._name, "") + data


def test_names_of_flights_never_become_markup(run_of, tmp_path):
    hostile = "</script><!--<script>alert(1)//"
    report, path = content(read_run(run_of("sweep_nu"))), tmp_path / "report.html"

    def renamed(block):
        flights = [replace(flight, flight_id=hostile, label=hostile) for flight in block.flights]
        return replace(block, flights=flights)

    sections = [
        replace(
            section,
            blocks=[
                renamed(block) if isinstance(block, FlightPicker) else block
                for block in section.blocks
            ],
        )
        for section in report.sections
    ]
    html.write_html(report, path)
    whole = Scripts()
    whole.feed(path.read_text(encoding="utf-8"))
    html.write_html(replace(report, sections=sections), path)
    page = Scripts()
    page.feed(path.read_text(encoding="utf-8"))
    assert list(page.texts) == list(whole.texts)
    assert list(json.loads(page.texts["replay-data"])["flights"]) == [hostile]
    assert list(json.loads(page.texts["flight-figures"])) == [hostile]


@pytest.mark.parametrize("text", [replay.library(), replay.scripts()])
def test_no_script_of_the_page_ends_its_element_or_asks_a_network(text):
    assert not re.search(r"</script|<!--|<script", text, re.IGNORECASE)
    # The one address is that of a namespace of XML, which is never fetched.
    assert set(re.findall(r"https?://[\w./]+", text)) <= {"http://www.w3.org/1999/xhtml"}
    assert "sourceMappingURL" not in text
