"""Flights of the kinematic vehicle that search for a plume, find it, and leave when
they have enough.
"""

import numpy as np
import pytest
from flight_cases import flown_study, modes

from gnc.mission.mission import Mode
from measurement.estimate.verdict import GUARD

pytestmark = pytest.mark.slow

QUICK = (
    "fidelity=kinematic", "reports.interval_s=[0,0]", "sensors={}", "start.place_m=[-250,-120]",
    "start.course_deg=-90", "wind.speed_mps=3", "wind.from_deg=40", "vessel.speed_mps=8",
    "emission.fuel=vlsfo", "emission.sulphur_percent=1.5", "emission.load=0.6",
    "payload.sensor=fast", "flight.altitude_m=60", "flight.after_settling_s=120",
    "flight.duration_max_s=300",
    "following={source_height_m=[20.0, 60.0], load=[0.2, 0.9], climb_gradient=0.08, plume='estimated'}",
)  # fmt: skip


def flown(*overrides):
    found = flown_study("sulphur", *QUICK, *overrides)
    return found.row, found.history, [mode for mode, _ in modes(found.history)]


def test_a_plume_is_found_and_the_flight_leaves_with_a_verdict():
    row, history, done = flown("flight.until=verdict", "start.place_m=[-600,-120]")
    # 1.5 % are fifteen times the limit: nothing but a verdict above it ends the flight before its
    # time.
    ended = (row["outcome"], row["enough"], row["sulphur_verdict"])
    assert ended == ("completed", "verdict: above", "above")
    # By a guard band that is wider than that of one look.
    assert row["verdict_looks"] >= 1
    assert row["verdict_guard"] > GUARD
    assert (done[0], done[-1]) == (Mode.APPROACH, Mode.DEPARTING)
    assert row["duration_s"] < row["settling_time_s"] + 120.0
    # What is believed is in the time history beside the truth.
    believed, deviation = history["axis_height_estimated_m"], history["axis_height_deviation_m"]
    assert np.isnan(believed[history["mode"] == Mode.APPROACH.number]).all()
    searched = history["mode"] == Mode.FOUND.number
    assert (deviation[searched] > 0.0).all()
    at = searched & (history["plume_across_m"].abs() < 10.0)
    truth = (history["altitude_m"] - history["plume_above_m"])[at]
    # Within four of its standard deviations at the last crossing.
    assert abs(believed[at].iloc[-1] - truth.iloc[-1]) < 4.0 * deviation[at].iloc[-1]


def test_a_sniffer_that_dies_is_recognised_and_the_flight_leaves_without_a_verdict():
    fault = ("fault.kind=sniffer_dead", "fault.at_s=60")
    row, _, done = flown("flight.until=verdict", "emission.sulphur_percent=0.1", *fault)
    assert row["outcome"] == "incomplete"
    assert row["enough"] == "sensor failed"
    assert Mode.SENSOR_FAILED in done
    assert row["keepout_violations"] == 0
