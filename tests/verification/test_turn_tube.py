"""The keep-out guard's prediction of a turn away against the X8 in six degrees of freedom, in the
middle of a roll.
"""

import math

import numpy as np
import pytest

from aircraft.fleet.x8 import X8
from aircraft.simulation.fdm import TIME_STEP
from common.physics.turn_tube import LEAST_CHANGE
from common.physics.units import METRES_PER_FOOT, STANDARD_GRAVITY
from gnc.estimation.own_motion import KnownMotion
from gnc.estimation.reachable_set import Tube
from gnc.safety.given_commands import GivenCommands
from gnc.safety.guard_parameters import GuardParameters
from gnc.safety.keepout_guard import KeepoutGuard
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.flight.reversal_search import _Flight
from innerloop.flight.turn_reversal import TurnReversalResponse
from innerloop.jsbsim.system import HEADING_RATE

RADIUS, STEP = 200.0, 0.05
PIECES = round(STEP / TIME_STEP)

HELD = (0.2, 0.35, 0.5, 0.65, 0.8, 1.0)
"""For how long the X8 has been rolling to the other side when it is turned back [s]."""


@pytest.fixture(scope="module")
def record(designs):
    whole = designs("x8").record
    return whole["turn_reversal"] | {"slow_lag_s": whole["heading_rate_lag_s"]}


@pytest.fixture(scope="module")
def rolled_back(x8_root, x8_schedule, record):
    """Return, for each time of rolling to the left out of a turn to the right, what the guard was
    told, and the turn flown back.
    """
    level = x8_schedule.level(x8_schedule.middle)
    rate = STANDARD_GRAVITY * math.tan(X8.envelope.bank) / level.airspeed
    aircraft = AutopilotedAircraft(X8, x8_root)
    aircraft.release(level.state(), airspeed=level.airspeed, altitude=level.altitude)
    read = [
        aircraft.fdm.node(name).get_double_value
        for name in ("velocities/v-north-fps", "velocities/v-east-fps")
    ]
    turning = aircraft.fdm.node(HEADING_RATE).get_double_value
    place = np.zeros(2)

    def fly(command):
        path = []
        aircraft.command_heading_rate(command)
        for _ in range(PIECES):
            aircraft.run()
            place[:] += [of() * METRES_PER_FOOT * TIME_STEP for of in read]
            path.append(place.copy())
        return path

    def own():
        return KnownMotion(
            ground_north=place[0],
            ground_east=place[1],
            course=math.atan2(read[1](), read[0]()),
            heading_rate=turning(),
        )

    found = []
    for held in HELD:
        told = []
        for command, duration in ((rate, 5.0), (-rate, held)):
            for _ in range(round(duration / STEP)):
                told.append((own(), command))
                fly(command)
        now = own()
        path = np.array([point for _ in range(round(6.0 / STEP)) for point in fly(rate)])
        found.append((told, now, path))
    return rate, level.airspeed, found


def lacking(flights, record, *, remembers):
    """Return by how much nearer to discs each turn came than predicted [m], what is to come known
    (``remembers``) or not.
    """
    rate, speed, found = flights
    lacks = []
    for told, now, path in found:
        guard = KeepoutGuard(
            GuardParameters(
                radius=RADIUS,
                heading_rate_max=rate,
                lag=record["lag_s"],
                delay=record["delay_s"],
                slow_lag=record["slow_lag_s"],
                time_step=STEP,
            )
        )
        # Far off, so that every command passes.
        guard.tubes = (Tube(0.0, 1e5, 0.0, 0.0, 0.0),)
        for step, (own, command) in enumerate(told):
            assert guard.limit(command, step * STEP, own, speed) == command
        to_come = guard._given.still_to_come(now.heading_rate)
        time = len(told) * STEP
        after = TIME_STEP * np.arange(1, len(path) + 1)
        for closing in (0.0, 0.5 * speed, 0.85 * speed):
            for off in np.radians([0.0, 15.0, 30.0, 50.0]):
                # Ahead to the left, so that it is away from it to the right, and coming nearer.
                towards = np.array([math.cos(now.course - off), math.sin(now.course - off)])
                place = (
                    np.array([now.ground_north, now.ground_east])
                    + (RADIUS + 20.0 + 4.0 * closing) * towards
                )
                disc = Tube(time, *place, *(-closing * towards))
                motion = guard._relative(
                    disc, time, now, speed, speed, to_come if remembers else 0.0
                )
                then = guard._prediction.when_acting(motion, guard._given.under_way)
                start = (then[0], then[1], then[4], then[6])
                kept, *_ = guard._prediction.turn_away(
                    1.0, start, then, guard._given.change, record["delay_s"], -math.inf
                )
                flown = np.hypot(*(path - place + closing * after[:, None] * towards).T)
                if np.argmin(flown) < len(path) - 1:
                    lacks.append(kept - float(np.min(flown) - RADIUS))
    return np.array(lacks)


def test_a_turn_back_out_of_a_roll_comes_no_nearer_than_the_record_says(rolled_back, record):
    lacks = lacking(rolled_back, record, remembers=True)
    assert len(lacks) > 50
    # Turns from rolling to the other side change the heading rate by 0.9 to 1.1 of a full reversal.
    assert lacks.max() <= 1.1 * record["deviation_max_m"]


def test_without_what_is_to_come_it_would_come_nearer_by_metres(rolled_back, record):
    lacks = lacking(rolled_back, record, remembers=False)
    assert lacks.max() > 2.0 * lacking(rolled_back, record, remembers=True).max()
    assert lacks.max() > 4.0


def test_the_search_and_the_guard_mean_the_same_by_what_is_still_to_come(
    x8_root, x8_schedule, record
):
    level = x8_schedule.level(x8_schedule.middle)
    response = TurnReversalResponse(delay=record["delay_s"], lag=record["lag_s"])
    searched = _Flight(AutopilotedAircraft(X8, x8_root), level, response, record["slow_lag_s"])
    rate = STANDARD_GRAVITY * math.tan(X8.envelope.bank) / level.airspeed
    guarded = GivenCommands(
        lag=response.lag,
        delay=response.delay,
        slow_lag=record["slow_lag_s"],
        time_step=STEP,
        heading_rate_max=rate,
    )
    guarded.still_to_come(0.0)
    lacks = []
    for share, duration in ((1.0, 4.0), (-1.0, 0.5), (0.3, 1.0), (-1.0, 2.0)):
        for _ in range(round(duration / STEP)):
            guarded.since.append(share * rate)
            guarded.rates.append(searched._rate())
            searched.fly(share * rate, STEP)
            guarded.still_to_come(searched._rate())
            lacks.append((searched._lack, guarded._lack))
        assert guarded.change == pytest.approx(
            max(LEAST_CHANGE, searched._change / (2.0 * rate)), rel=0.01
        )
    own, others = np.array(lacks).T
    assert np.max(np.abs(own)) > 0.05
    # The search takes the dead time to whole steps of the simulation, 4 ms at most, and the course,
    # of which 0.5 rad/s make 2 mrad.
    np.testing.assert_allclose(own, others, rtol=0.0, atol=4e-3)
