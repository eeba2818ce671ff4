"""How a flight ended: by its aircraft, and by its mission."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from gnc.estimation.health import Fault
from gnc.estimation.navigation import MeasuredMotion
from gnc.mission.mission import Mode
from scenarios.flight.ending import Ending, StopReason
from scenarios.flight.outcome import Outcome
from scenarios.scenario.sections.equipment import FaultConfig
from scenarios.world.faults import in_order, sampled_fault

AT_THE_MAST, ON_THE_WATER = (60.0,), (1.0,)


def ended(
    *,
    asked=0,
    flown=12,
    settled=80.0,
    mode=Mode.TRACKING,
    fault=Fault.NONE,
    sample=AT_THE_MAST,
    trouble="",
    vessel=True,
    after=math.inf,
    reason=None,
    tracked=0.0,
    centre_error=math.inf,
    guarded=False,
    saturated=0.3,
    fault_at=None,
):
    """Return how a flight ended at 300 s."""
    of_world = FaultConfig(kind="engine", at_s=fault_at) if fault_at else FaultConfig()
    world = SimpleNamespace(faults=in_order([sampled_fault(of_world, np.random.default_rng(1))]))
    plan = SimpleNamespace(
        crossings=asked,
        after_settling=after,
        duration_max=300.0,
        world=world if vessel else None,
        settling_period=19.0,
    )
    vehicle = SimpleNamespace(fault=lambda _: trouble)
    guidance = SimpleNamespace(monitor=SimpleNamespace(fault=fault), mode=mode)
    guidance.target = SimpleNamespace(north=0.0, east=0.0)
    early_stop = (
        SimpleNamespace(
            reason=reason,
            has_left=lambda *_: True,
            message=f"{reason and reason.value}: it left",
        )
        if reason
        else None
    )
    settling = SimpleNamespace(
        at=settled, crossings=flown, tracked=tracked, centre_error=centre_error, centre_band=15.0
    )
    ending = Ending(plan, vehicle, guidance, settling, early_stop)
    ending.guarded, ending.saturated = guarded, saturated
    ending.reached(
        300.0, MeasuredMotion(0.0, 0.0, 0.0, 0.0, 0.0), sample, complete=0 < asked <= flown
    )
    return ending


@pytest.mark.parametrize(
    ("flight", "outcome", "words"),
    [
        ({}, Outcome.COMPLETED, ""),
        # Such a flight is on its way back to its orbit, or waits for the next report.
        ({"mode": Mode.APPROACH}, Outcome.COMPLETED, ""),
        ({"vessel": False, "settled": math.nan, "flown": 0}, Outcome.COMPLETED, ""),
        ({"settled": math.nan, "flown": 0}, Outcome.NOT_SETTLED, "did not settle within 300 s"),
        # Over after its time, as a circle about the vessel may be before it crosses the plume: a
        # longer duration is no remedy.
        (
            {"flown": 0, "after": 200.0},
            Outcome.INCOMPLETE,
            "flew no crossing in 220 s after settling: fly longer (flight.after_settling_s), or ask for crossings",
        ),
        (
            {"settled": math.nan, "tracked": 242.0},
            Outcome.NOT_SETTLED,
            "did not settle within 300 s: it tracked its reference for 242 s, but its orbit was still closing in on its place. Fly",
        ),
        (
            {"settled": math.nan, "guarded": True},
            Outcome.NOT_SETTLED,
            "may be enough, and the keep-out guard may hold it off its orbit",
        ),
        ({"flown": 0}, Outcome.INCOMPLETE, "flew 0 crossings after settling within 300 s"),
        ({"asked": 30}, Outcome.INCOMPLETE, "flew 12 of 30 crossings after settling within 300 s"),
        ({"after": 220.0, "mode": Mode.NO_PLUME}, Outcome.COMPLETED, ""),
        ({"after": 300.0}, Outcome.INCOMPLETE, "flew 220 of 300 s after settling within 300 s"),
        ({"mode": Mode.OUTRUN}, Outcome.INCOMPLETE, "ended outrun after 12 crossings"),
        ({"mode": Mode.NO_PLUME}, Outcome.INCOMPLETE, "ended no plume after 12 crossings"),
        (
            {"asked": 30, "fault": Fault.THRUST_LOST, "mode": Mode.GLIDING, "sample": ON_THE_WATER},
            Outcome.AIRCRAFT_LOST,
            "it came down on the sea at 300.0 s, after 12 of 30 crossings",
        ),
        (
            {"mode": Mode.GLIDING, "flown": 0},
            Outcome.AIRCRAFT_LOST,
            "it was still gliding towards the sea at 300.0 s",
        ),
        (
            {"mode": Mode.GLIDING, "settled": math.nan, "fault_at": (281.5, 281.5)},
            Outcome.AIRCRAFT_LOST,
            "it was still gliding towards the sea at 300.0 s, before it had settled, after the fault 'engine' at 281.5 s",
        ),
        # A verdict is what such a flight is for, also where it has not settled for as long as is
        # asked for.
        (
            {"reason": StopReason.BELOW, "after": 400.0, "mode": Mode.DEPARTING},
            Outcome.COMPLETED,
            "",
        ),
        (
            {"reason": StopReason.OUT_OF_REACH, "mode": Mode.DEPARTING},
            Outcome.INCOMPLETE,
            "plume out of reach",
        ),
        (
            {"reason": StopReason.SENSOR, "settled": math.nan, "mode": Mode.DEPARTING},
            Outcome.INCOMPLETE,
            "sensor failed",
        ),
        ({"trouble": "bank reached 90 deg"}, Outcome.DIVERGED, "bank reached 90 deg at 300.0 s"),
    ],
)
def test_a_flight_completes_only_with_its_aircraft_and_its_mission(flight, outcome, words):
    ending = ended(**flight)
    assert ending.outcome is outcome
    assert words in ending.message
    assert bool(ending.message) == (outcome is not Outcome.COMPLETED)
    assert ("neither may be enough" in ending.message) == (outcome is Outcome.NOT_SETTLED)
    # A cause that does not apply is not named.
    assert ("guard" in ending.message) <= bool(flight.get("guarded"))
    assert ("after the fault" in ending.message) <= bool(flight.get("fault_at"))


def test_a_law_that_asks_for_too_much_all_the_time_is_named_as_the_cause():
    ending = ended(settled=math.nan, flown=0, saturated=0.98)
    assert ending.outcome is Outcome.NOT_SETTLED
    assert (
        "in 98 % of the steps; check that it returns rad/s, positive to the right (guidance.law)"
        in ending.message
    )
    # To fly longer is no remedy.
    assert "more time" not in ending.message
