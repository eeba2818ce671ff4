"""The keep-out guard's prediction of a turn away against the X8 in six degrees of freedom, in the
middle of a roll.
"""

import math

import numpy as np
import pytest

from aircraft.fdm import TIME_STEP
from aircraft.fleet.x8 import X8
from common.physics import METRES_PER_FOOT, STANDARD_GRAVITY
from gnc.estimation.navigation import AirMotion
from gnc.estimation.vessel import Tube
from gnc.guard.guard import CommandHistory, GuardParameters, HeadingRateFilter
from gnc.guard.turn import TurnStart, pending_turn_rate
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.flight.turn_reversal import TurnReversalResponse, _Flight
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
    """Return, for each time of rolling to the left out of a turn to the right, the commands with the
    motion at each, the motion at their end, and the path of the turn back.
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
        return AirMotion(
            ground_north=place[0],
            ground_east=place[1],
            course=math.atan2(read[1](), read[0]()),
            heading_rate=turning(),
        )

    found = []
    for held in HELD:
        given = []
        for command, duration in ((rate, 5.0), (-rate, held)):
            for _ in range(round(duration / STEP)):
                given.append((own(), command))
                fly(command)
        now = own()
        path = np.array([point for _ in range(round(6.0 / STEP)) for point in fly(rate)])
        found.append((given, now, path))
    return rate, level.airspeed, found


def lacking(flights, record, *, remembers):
    """Return by how much nearer to discs each turn came than predicted [m], with pending course
    (``remembers``) or without.
    """
    rate, speed, found = flights
    lacks = []
    for given, now, path in found:
        guard = HeadingRateFilter(
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
        far_off = (Tube(0.0, 1e5, 0.0, 0.0, 0.0),)
        for step, (own, command) in enumerate(given):
            assert guard.limit(command, step * STEP, own, far_off, speed) == command
        pending = guard.history.take_in(now.heading_rate)
        time = len(given) * STEP
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
                motion = guard.relative_motion(
                    disc, time, now, speed, speed, pending if remembers else 0.0
                )
                (then,) = guard.motions_when_acting(motion)
                turn = guard.prediction.turn_away(
                    1.0,
                    TurnStart(then.x, then.y, then.course, then.heading_rate),
                    then,
                    change=guard.history.change,
                    time=record["delay_s"],
                    floor=-math.inf,
                )
                flown = np.hypot(*(path - place + closing * after[:, None] * towards).T)
                if np.argmin(flown) < len(path) - 1:
                    lacks.append(turn.slack - float(np.min(flown) - RADIUS))
    return np.array(lacks)


def test_a_turn_back_out_of_a_roll_comes_no_nearer_than_the_record_says(rolled_back, record):
    lacks = lacking(rolled_back, record, remembers=True)
    assert len(lacks) > 50
    # Turns from rolling to the other side change the heading rate by 0.9 to 1.1 of a full reversal.
    assert lacks.max() <= 1.1 * record["deviation_max_m"]


def test_without_pending_course_it_would_come_nearer_by_metres(rolled_back, record):
    lacks = lacking(rolled_back, record, remembers=False)
    assert lacks.max() > 2.0 * lacking(rolled_back, record, remembers=True).max()
    assert lacks.max() > 4.0


def test_search_and_guard_agree_on_the_course_that_is_still_to_come(x8_root, x8_schedule, record):
    level = x8_schedule.level(x8_schedule.middle)
    response = TurnReversalResponse(delay=record["delay_s"], lag=record["lag_s"])
    slow_lag = record["slow_lag_s"]
    rate = STANDARD_GRAVITY * math.tan(X8.envelope.bank) / level.airspeed
    aircraft = AutopilotedAircraft(X8, x8_root)
    searched = _Flight(aircraft, level, response, slow_lag, rate)
    turning = aircraft.fdm.node(HEADING_RATE).get_double_value
    guarded = CommandHistory(
        lag=response.lag,
        delay=response.delay,
        slow_lag=slow_lag,
        time_step=STEP,
        heading_rate_max=rate,
    )
    guarded.take_in(0.0)
    lacks, courses = [], []
    for share, duration in ((1.0, 4.0), (-1.0, 0.5), (0.3, 1.0), (-1.0, 2.0)):
        for _ in range(round(duration / STEP)):
            guarded.append(share * rate, turning())
            searched.fly(share * rate, STEP)
            lack = searched.lack
            pending = (
                pending_turn_rate(lack, turning(), slow_lag, response.lag),
                guarded.take_in(turning()),
            )
            lacks.append(lack)
            courses.append([response.lag * each for each in pending])
        # The guard counts the change within a window of dead time and lag, whenever it looks; the
        # search counts it at once, and lets it fade meanwhile. So the guard counts at least as much.
        assert 0.99 * searched.change <= guarded.change <= 1.1 * searched.change
    own, others = np.array(courses).T
    assert np.max(np.abs(lacks)) > 0.05
    # The search takes the dead time to whole steps of the simulation, 4 ms at most, and the course:
    # 0.5 rad/s for that time are 2 mrad.
    np.testing.assert_allclose(own, others, rtol=0.0, atol=4e-3)
