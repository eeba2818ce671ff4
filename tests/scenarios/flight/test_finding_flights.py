"""Flights of the kinematic vehicle that search for a plume, are told where it is, and leave when
they have enough.
"""

import numpy as np
import pytest

from gnc.mission.mission import Mode
from measurement.estimate.verdict import GUARD
from scenarios.engine.task import Task
from scenarios.experiment.requests import Experiment
from scenarios.flight_runner import FlightRunner
from scenarios.planning.spreads import PredictedSpreads
from scenarios.scenario.files import load_study
from tests.run_tables import history_in

pytestmark = pytest.mark.slow

QUICK = (
    "fidelity=kinematic",
    "reports.interval_s=[0,0]",
    "sensors={}",
    "start.place_m=[-250,-120]",
    "start.course_deg=-90",
    "wind.speed_mps=3",
    "wind.from_deg=40",
    "vessel.speed_mps=8",
    "emission.fuel=vlsfo",
    "emission.sulphur_percent=1.5",
    "emission.load=0.6",
    "payload.sensor=fast",
    "following={source_height_m=[20.0, 60.0], load=[0.2, 0.9], climb_gradient=0.08, plume='estimated'}",
    "flight.altitude_m=60",
    "flight.after_settling_s=120",
    "flight.duration_max_s=300",
)


def flown(*overrides):
    scenario = load_study("sulphur", (*QUICK, *overrides))
    work = FlightRunner(
        experiments=(Experiment("sulphur", scenario),),
        histories=1,
        setup=None,
        spreads=PredictedSpreads(),
    )
    result = work.run(Task(number=0))
    (row,) = result.tables["summary.csv"]
    return row, history_in(result)


@pytest.fixture(scope="module")
def until_verdict():
    return flown("flight.until=verdict", "start.place_m=[-600,-120]")


def modes(history):
    numbers = history["mode"].to_numpy().astype(int)
    return [list(Mode)[number] for number in numbers[np.flatnonzero(np.diff(numbers, prepend=-1))]]


def test_a_plume_is_found_and_the_flight_leaves_with_a_verdict(until_verdict):
    row, history = until_verdict
    assert row["outcome"] == "completed"
    # 1.5 % are fifteen times the limit: nothing but a verdict above it ends the flight before its
    # time.
    assert row["enough"] == "verdict: above"
    assert row["sulphur_verdict"] == "above"
    # By a guard band that is wider than that of one look.
    assert row["verdict_looks"] >= 1
    assert row["verdict_guard"] > GUARD
    assert modes(history)[0] is Mode.APPROACH
    assert {Mode.SEARCHING, Mode.FOUND} & set(modes(history))
    assert modes(history)[-1] is Mode.DEPARTING
    assert row["duration_s"] < row["settling_time_s"] + 120.0


def test_what_is_believed_stands_beside_the_truth_in_the_time_history(until_verdict):
    _, history = until_verdict
    searched = history["mode"] == Mode.FOUND.number
    believed, deviation = history["axis_height_estimated_m"], history["axis_height_deviation_m"]
    assert np.isnan(believed[history["mode"] == Mode.APPROACH.number]).all()
    assert (deviation[searched] > 0.0).all()
    at = searched & (history["plume_across_m"].abs() < 10.0)
    truth = (history["altitude_m"] - history["plume_above_m"])[at]
    # Within four of its standard deviations at the last crossing.
    assert abs(believed[at].iloc[-1] - truth.iloc[-1]) < 4.0 * deviation[at].iloc[-1]


def test_a_sniffer_that_dies_is_recognised_and_the_flight_leaves_without_a_verdict():
    row, history = flown(
        "flight.until=verdict",
        "emission.sulphur_percent=0.1",
        "fault.kind=sniffer_dead",
        "fault.at_s=60",
    )
    assert row["outcome"] == "incomplete"
    assert row["enough"] == "sensor failed"
    assert "sensor failed" in row["message"]
    assert Mode.SENSOR_FAILED in modes(history)
    assert row["keepout_violations"] == 0
