"""When a flight ends early: a verdict by all looks together, or a plume that cannot be measured."""

import math
from types import SimpleNamespace

import pytest

from gnc.estimation.plume.passes import SensorState
from gnc.mission.axis import PlumeEstimate, SearchedAxis
from gnc.mission.mission import NO_CENTRE, Mode, OrbitStatus
from scenarios.flight import ending
from scenarios.flight.ending import LOOK_INTERVAL, EarlyStop, StopReason


class Axis(SearchedAxis):
    """A search that has its beliefs from a test."""

    def __init__(self, *, sensor=SensorState.WORKING, measurable=1.0, mode=Mode.SEARCHING):
        self.mode = mode
        self.sensor, self.estimate, self._measurable = (
            sensor,
            PlumeEstimate(height=131.0, height_deviation=8.0),
            measurable,
        )

    __slots__ = ("_measurable",)

    def measurable(self):
        return self._measurable


class Mission:
    def __init__(self, axis):
        self.axis, self.departing = axis, False
        self.orbit = OrbitStatus(NO_CENTRE, 0.0, in_place=True)

    def depart(self):
        self.departing = True


def judged(monkeypatch, contents, *, axis=None, settled=0.0, quality="B"):
    """Return the early stop whose looks find these contents one after the other, each with half the noise
    of the one before, and its mission.
    """
    looks = iter(enumerate(contents))

    def estimate(*_, **__):
        number, content = next(looks)
        noise = 0.04 * 0.5**number
        return SimpleNamespace(
            fsc_percent=content,
            noise_percent=noise,
            total_percent=math.hypot(noise, 0.005),
            quality=quality,
        )

    monkeypatch.setattr(ending, "estimate", estimate)
    reader = SimpleNamespace(limit_percent=0.1, spec=None, readings=lambda since: since)
    mission = Mission(axis or Axis())
    return EarlyStop(reader, mission, SimpleNamespace(at=settled)), mission


def looks(stop, number, distance=230.0):
    """Let as many looks go by, sampled ten times a second; return the times at which it was over."""
    return [
        t
        for t in (0.1 * i for i in range(round(10 * number * LOOK_INTERVAL) + 1))
        if stop.has_left(t, distance)
    ]


def test_a_flight_leaves_at_the_first_look_beyond_the_guard_band_of_repeated_looks(monkeypatch):
    # 1.8 standard uncertainties above, then as many below: more than one look needs, 1.645, and
    # less than one of several.
    contents = [0.1 + 1.8 * 0.0403, 0.1 - 1.8 * 0.0206, 0.05]
    stop, mission = judged(monkeypatch, contents)
    assert looks(stop, 2) == []
    assert (stop.reason, mission.departing) == (None, False)
    again, mission = judged(monkeypatch, contents)
    looks(again, 3)
    assert (again.reason, mission.departing) == (StopReason.BELOW, True)
    assert again.left_at == pytest.approx(3 * LOOK_INTERVAL, abs=0.11)
    assert again.verdict.looks == 3


def test_off_its_orbit_and_where_it_is_detected_no_plume_is_out_of_reach(monkeypatch):
    stop, mission = judged(monkeypatch, [0.1] * 9, axis=Axis(measurable=0.01))
    mission.orbit = OrbitStatus(NO_CENTRE, 0.0, in_place=False)
    looks(stop, 3)
    found, _ = judged(monkeypatch, [0.1] * 9, axis=Axis(measurable=0.01, mode=Mode.FOUND))
    looks(found, 3)
    assert (stop.reason, found.reason) == (None, None)
