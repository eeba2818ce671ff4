"""When a flight has settled, when it ends early, and how it ended."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from gnc.estimation.health import Fault
from gnc.estimation.navigation import MeasuredMotion
from gnc.estimation.plume.passes import SensorState
from gnc.mission.axis import PlumeEstimate, SearchedAxis
from gnc.mission.mission import NO_CENTRE, Mode, OrbitStatus
from scenarios.flight import ending
from scenarios.flight.ending import LOOK_INTERVAL, EarlyStop, Ending, Settling, StopReason
from scenarios.scenario.sections.equipment import FaultConfig
from scenarios.world.faults import in_order, sampled_fault

PERIOD = 19.0
AXIS = 2.0


def make(crossings=0, **more):
    return Settling(band=8.0, period=PERIOD, crossings=crossings, **more)


def sample(settling, time, *, tracking=1.0, centre=1.0, along=200.0, across=5.0):
    """Hand over a sample ``along`` the plume's axis and ``across`` it to the right."""
    x = along * math.cos(AXIS) - across * math.sin(AXIS)
    y = along * math.sin(AXIS) + across * math.cos(AXIS)
    return settling.update(time, tracking, centre, x, y, AXIS)


def test_it_has_settled_from_the_first_moment_from_which_it_stays_near_for_a_period():
    settling = make()
    sample(settling, 9.5, tracking=8.0)
    for step in range(39):
        # Before the period is over that does not show.
        assert math.isnan(settling.at)
        sample(settling, 10.0 + 0.5 * step)
    assert settling.at == 10.0


def test_crossings_count_from_the_first_moment_on_and_begin_again_after_it_was_too_far():
    settling = make(crossings=40)
    for step in range(5):
        sample(settling, 0.5 * step, across=(-1.0) ** step)
    # The first sample has none before it.
    assert settling.crossings == 4
    sample(settling, 2.5, across=-1.0, tracking=8.0)
    assert settling.crossings == 0
    for step in range(6, 46):
        sample(settling, 0.5 * step, across=(-1.0) ** step)
    assert (settling.at, settling.crossings) == (3.0, 39)


def test_it_is_complete_one_sample_after_the_last_crossing_and_no_earlier_than_settled():
    settling = make(crossings=2)
    done = [sample(settling, 0.5 * step, across=(-1.0) ** step) for step in range(41)]
    # Both crossings are flown after 1 s; that it has settled shows after 19 s, in the sample before
    # the last but one.
    assert done == [False] * 39 + [True] * 2
    settling = make(crossings=1)
    for step in range(50):
        assert not sample(settling, 0.5 * step)
    assert not sample(settling, 25.0, across=-3.0)
    # One sample after it the record holds it.
    assert sample(settling, 25.5, across=-4.0)


@pytest.mark.parametrize(("crossings", "end"), [(0, 60.5), (20, 60.5), (40, 100.5)])
def test_a_flight_that_goes_on_after_settling_ends_when_both_its_time_and_its_crossings_are_flown(
    crossings, end
):
    settling = make(crossings=crossings, after=60.0)
    # It settles with the first sample, and crosses every 2.5 s from then on.
    done = [sample(settling, 0.5 * step, across=5.0 * (-1.0) ** (step // 5)) for step in range(300)]
    assert settling.at == 0.0
    assert 0.5 * done.index(True) == end


AT_THE_MAST, ON_THE_WATER = (60.0,), (1.0,)


GIVEN = {
    "planned": 0, "flown": 12, "settled": 80.0, "mode": Mode.TRACKING, "fault": Fault.NONE,
    "sample": AT_THE_MAST, "trouble": "", "vessel": True, "after": math.inf, "reason": None,
    "tracked": 0.0, "guarded": False, "saturated": 0.3, "fault_at": None,
}  # fmt: skip


def ended(**changes):
    """Return how a flight ended at 300 s."""
    of = SimpleNamespace(**(GIVEN | changes))
    config = FaultConfig(kind="engine", at_s=of.fault_at) if of.fault_at else FaultConfig()
    world = SimpleNamespace(faults=in_order([sampled_fault(config, np.random.default_rng(1))]))
    plan = SimpleNamespace(crossings=of.planned, after_settling=of.after, duration_max=300.0)
    plan.world, plan.settling_period = world if of.vessel else None, 19.0
    vehicle = SimpleNamespace(fault=lambda _: of.trouble)
    guidance = SimpleNamespace(monitor=SimpleNamespace(fault=of.fault), mode=of.mode)
    guidance.target = SimpleNamespace(north=0.0, east=0.0)
    early_stop = None
    if of.reason:
        early_stop = SimpleNamespace(reason=of.reason, has_left=lambda *_: True)
        early_stop.message = f"{of.reason.value}: it left"
    settling = SimpleNamespace(at=of.settled, crossings=of.flown, tracked=of.tracked)
    settling.centre_error, settling.centre_band = math.inf, 15.0
    ending = Ending(plan, vehicle, guidance, settling, early_stop)
    ending.guarded, ending.saturated = of.guarded, of.saturated
    motion = MeasuredMotion(0.0, 0.0, 0.0, 0.0, 0.0)
    ending.reached(300.0, motion, of.sample, complete=0 < of.planned <= of.flown)
    return ending


NEVER = {"settled": math.nan}
ON_ITS_WAY = {"mode": Mode.GLIDING, "settled": math.nan, "fault_at": (281.5, 281.5)}
DITCHED = {"planned": 30, "fault": Fault.THRUST_LOST, "mode": Mode.GLIDING, "sample": ON_THE_WATER}
LEFT = {"reason": StopReason.BELOW, "after": 400.0, "mode": Mode.DEPARTING}

ENDINGS = [
    ({}, "completed", ""),
    # Such a flight is on its way back to its orbit, or waits for the next report.
    ({"mode": Mode.APPROACH}, "completed", ""),
    ({"vessel": False, "settled": math.nan, "flown": 0}, "completed", ""),
    (NEVER | {"flown": 0}, "not_settled", "did not settle within 300 s"),
    (NEVER | {"tracked": 242.0}, "not_settled", "it tracked its reference for 242 s, but its"),
    (NEVER | {"guarded": True}, "not_settled", "the keep-out guard may hold it off its orbit"),
    (NEVER | {"flown": 0, "saturated": 0.98}, "not_settled", "in 98 % of the steps; check that it"),
    # Over after its time: a longer duration is no remedy.
    ({"flown": 0, "after": 200.0}, "incomplete", "fly longer (flight.after_settling_s)"),
    ({"flown": 0}, "incomplete", "flew 0 crossings after settling within 300 s"),
    ({"planned": 30}, "incomplete", "flew 12 of 30 crossings after settling within 300 s"),
    ({"after": 220.0, "mode": Mode.NO_PLUME}, "completed", ""),
    ({"after": 300.0}, "incomplete", "flew 220 of 300 s after settling within 300 s"),
    ({"mode": Mode.OUTRUN}, "incomplete", "ended outrun after 12 crossings"),
    (DITCHED, "aircraft_lost", "it came down on the sea at 300.0 s, after 12 of 30 crossings"),
    ({"mode": Mode.GLIDING, "flown": 0}, "aircraft_lost", "still gliding towards the sea at 300.0"),
    (ON_ITS_WAY, "aircraft_lost", "before it had settled, after the fault 'engine' at 281.5 s"),
    # A verdict is what such a flight is for, also where it has not settled for as long as planned.
    (LEFT, "completed", ""),
    (LEFT | {"reason": StopReason.OUT_OF_REACH}, "incomplete", "plume out of reach"),
    (LEFT | NEVER | {"reason": StopReason.SENSOR}, "incomplete", "sensor failed"),
    ({"trouble": "bank reached 90 deg"}, "diverged", "bank reached 90 deg at 300.0 s"),
]


@pytest.mark.parametrize(("flight", "outcome", "words"), ENDINGS)
def test_a_flight_completes_only_with_its_aircraft_and_its_mission(flight, outcome, words):
    ending = ended(**flight)
    assert ending.outcome.value == outcome
    assert words in ending.message
    assert bool(ending.message) == (outcome != "completed")
    # A cause that does not apply is not named.
    assert ("keep-out guard" in ending.message) <= bool(flight.get("guarded"))
    assert ("after the fault" in ending.message) <= bool(flight.get("fault_at"))


class Axis(SearchedAxis):
    """A search that has its beliefs from a test."""

    def __init__(self, *, sensor=SensorState.WORKING, measurable=1.0, mode=Mode.SEARCHING):
        self.mode = mode
        self.sensor, self._measurable = sensor, measurable
        self.estimate = PlumeEstimate(height=131.0, height_deviation=8.0)

    __slots__ = ("_measurable",)

    def measurable(self):
        return self._measurable


class Mission:
    def __init__(self, axis):
        self.axis, self.departing = axis, False
        self.orbit = OrbitStatus(NO_CENTRE, 0.0, in_place=True)

    def depart(self):
        self.departing = True


def judged(monkeypatch, contents, *, axis=None):
    """Return an early stop and its mission; looks find these contents in turn, each with half the
    noise of the one before.
    """
    looks = iter(enumerate(contents))

    def estimate(*_, **__):
        number, content = next(looks)
        noise = 0.04 * 0.5**number
        found = {"fsc_percent": content, "noise_percent": noise, "quality": "B"}
        return SimpleNamespace(**found, total_percent=math.hypot(noise, 0.005))

    monkeypatch.setattr(ending, "estimate", estimate)
    reader = SimpleNamespace(limit_percent=0.1, spec=None, readings=lambda since: since)
    mission = Mission(axis or Axis())
    return EarlyStop(reader, mission, SimpleNamespace(at=0.0)), mission


def looks(stop, number):
    """Let as many looks go by, sampled ten times a second; return the times at which it was over."""
    times = [0.1 * i for i in range(round(10 * number * LOOK_INTERVAL) + 1)]
    return [time for time in times if stop.has_left(time, 230.0)]


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
