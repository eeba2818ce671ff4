"""The guard beside several vessels at once: none of their areas is entered, whatever is demanded."""

import math

import numpy as np
import pytest
from gnc_cases import HEADING_RATE_MAX, SPEED
from guard_cases import TIME_STEP, known_motion, moved, parameters_of

from gnc.estimation.traffic import OtherVessel, Traffic
from gnc.estimation.vessel import ReachableSet, VesselLimits, VesselReport
from gnc.guard.common_turn import remaining
from gnc.guard.guard import GuardStatus, HeadingRateFilter
from gnc.numeric import limited, wrap

pytestmark = pytest.mark.slow

KNOWN = VesselLimits(
    acceleration=0.0,
    speed_max=math.inf,
    position_sigma=0.0,
    velocity_sigma=0.0,
    deviations=0.0,
    horizon=11.0,
)
"""Of vessels that keep their course and are known exactly."""


class Ships:
    """Steady vessels: places at time 0 and velocities, shape (n, 2) [m, m/s], and radii [m]; the
    first one is measured.
    """

    def __init__(self, places, velocities, radii):
        self.places, self.velocities, self.radii = places, velocities, radii
        self._reach = ReachableSet(KNOWN)
        others = [
            OtherVessel(name=f"ship {i}", radius=float(radius), limits=KNOWN)
            for i, radius in enumerate(radii[1:])
        ]
        self.traffic = Traffic(others, speed_max=SPEED, horizon=60.0)

    def at(self, time):
        return self.places + self.velocities * time

    def discs(self, time, own):
        for i, (place, velocity) in enumerate(zip(self.at(time), self.velocities, strict=True)):
            report = VesselReport(time, *place.tolist(), *velocity.tolist())
            if i == 0:
                self._reach.report(report)
            else:
                self.traffic.report(i - 1, report)
        self.traffic.update(time, own)
        return self._reach.tubes(time)

    def clearance(self, time, state):
        return float(np.min(np.hypot(*(self.at(time) - state[:2]).T) - self.radii))


def random_ships(generator, count, half_side):
    """Return ships at random in a square, none of which is near the vehicle's start."""
    while True:
        places = generator.uniform(-half_side, half_side, (count, 2))
        radii = np.concatenate([[200.0], generator.uniform(60.0, 200.0, count - 1)])
        if np.min(np.hypot(*places.T) - radii) > 350.0:
            break
    course, speed = generator.uniform(-math.pi, math.pi, count), generator.uniform(0.0, 12.0, count)
    velocities = np.column_stack([speed * np.cos(course), speed * np.sin(course)])
    return Ships(places, velocities, radii)


def aimed(ships, generator):
    """Demand a turn to a ship, another one every 20 s."""
    target = [0]

    def want(step, time, state):
        if step % 400 == 0:
            target[0] = int(generator.integers(len(ships.radii)))
        north, east = ships.at(time)[target[0]]
        turn = wrap(math.atan2(east - state[1], north - state[0]) - state[2])
        return limited(1.5 * turn, HEADING_RATE_MAX)

    return want


def held(generator):
    """Demand full turns and anything between, each for two seconds."""
    now = [0.0]

    def want(step, *_):
        if step % 40 == 0:
            turns = [-1.0, 1.0, float(generator.uniform(-1.0, 1.0))]
            now[0] = HEADING_RATE_MAX * float(generator.choice(turns))
        return now[0]

    return want


def flown(ships, want, *, duration, blind=False):
    """Return the least distance beyond any radius [m], the guard's statuses, and how often it turned
    away from several vessels at once; a ``blind`` guard knows the measured vessel alone.
    """
    guard, state = HeadingRateFilter(parameters_of(lag=0.4)), (0.0, 0.0, 0.0, 0.0)
    away, several = guard.common_turns.away, []
    guard.common_turns.away = lambda motions: several.append(1) or away(motions)
    closest, statuses, discs = math.inf, set(), ()
    for step in range(round(duration / TIME_STEP)):
        time, own = step * TIME_STEP, known_motion(state, speed=SPEED)
        if step % 10 == 0:
            discs = ships.discs(time, own)
        near = () if blind else ships.traffic.near
        command = guard.limit(want(step, time, state), time, own, discs, SPEED, math.inf, near)
        statuses.add(guard.status)
        for half in (1, 2):
            state = moved(state, command, 0.4, 0.5 * TIME_STEP)
            closest = min(closest, ships.clearance(time + 0.5 * half * TIME_STEP, state))
    return closest, statuses, len(several)


@pytest.mark.parametrize("demand", ["aimed", "held"])
def test_no_area_of_six_ships_is_entered_whatever_is_demanded(demand):
    entered_blind, several = False, 0
    for seed in range(4):

        def fly(*, blind, seed=seed):
            generator = np.random.default_rng(seed)
            ships = random_ships(generator, 6, 1200.0)
            want = aimed(ships, generator) if demand == "aimed" else held(generator)
            return flown(ships, want, duration=90.0, blind=blind)

        closest, statuses, often = fly(blind=False)
        several += often
        # The resolution of the prediction, 4 cm, is on the safe side.
        assert closest >= 0.0
        assert GuardStatus.LOST not in statuses
        if demand == "aimed" and not entered_blind:
            entered_blind = fly(blind=True)[0] < 0.0
    assert entered_blind or demand == "held"
    assert several


def test_between_two_ships_that_close_in_the_way_out_is_along_the_gap():
    # Between their areas 440 m are left, and after 73 s nothing; full turns are demanded.
    places = np.array([[0.0, -420.0], [0.0, 420.0]])
    velocities = np.array([[0.0, 3.0], [0.0, -3.0]])
    ships = Ships(places, velocities, np.array([200.0, 200.0]))
    closest, statuses, several = flown(ships, lambda *_: HEADING_RATE_MAX, duration=100.0)
    assert closest >= 0.0
    assert GuardStatus.LOST not in statuses
    assert several


def test_ships_out_of_reach_change_no_command():
    generator = np.random.default_rng(3)
    want = [float(generator.uniform(-0.4, 0.4)) for _ in range(400)]
    far = Ships(
        np.array([[400.0, 0.0], [9000.0, 0.0], [0.0, -8000.0]]),
        np.zeros((3, 2)),
        np.array([200.0, 150.0, 150.0]),
    )
    alone, beside = HeadingRateFilter(parameters_of()), HeadingRateFilter(parameters_of())
    state = (0.0, 0.0, 0.0, 0.0)
    for step, demand in enumerate(want):
        time, own = step * TIME_STEP, known_motion(state, speed=SPEED)
        discs = far.discs(time, own)
        assert far.traffic.near == []
        commands = [
            guard.limit(demand, time, own, discs, SPEED, math.inf, others)
            for guard, others in ((alone, ()), (beside, far.traffic.near))
        ]
        assert commands[0] == commands[1]
        state = moved(state, commands[0], 0.4, TIME_STEP)


def test_the_remaining_angle_goes_once_round_but_turns_back_from_a_little_beyond():
    assert remaining(1.0, 0.0, 0.5) == pytest.approx((1.0, 0.5))
    assert remaining(-1.0, 0.0, 2.5) == pytest.approx((-1.0, 2.0 * math.pi - 2.5))
    assert remaining(1.0, 0.3, 0.0) == pytest.approx((-1.0, 0.3))


def test_a_ship_that_is_looked_at_seldom_is_near_in_time():
    # It closes in at 30 m/s from 12 km.
    ship = OtherVessel(name="a", radius=200.0, limits=KNOWN)
    traffic = Traffic([ship], speed_max=18.0, horizon=60.0)
    first_near = math.nan
    for step in range(800):
        time = 0.5 * step
        own = known_motion((0.0, 18.0 * time, 0.5 * math.pi, 0.0), speed=18.0)
        if traffic.is_due(0, time):
            traffic.report(0, VesselReport(time, 0.0, 12_000.0 - 12.0 * time, 0.0, -12.0))
        traffic.update(time, own)
        if traffic.near:
            first_near = 12_000.0 - 30.0 * time
            break
    # At 30 m/s for 60 s, and the radius; looked at 10 s late at most.
    assert 2000.0 - 300.0 <= first_near <= 2000.0 + 15.0
