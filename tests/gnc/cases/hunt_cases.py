"""Vessels that hunt a vehicle as hard as they are declared to be able to, while their reports come
late or not at all.
"""

import math
from collections import deque
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from gnc_cases import HEADING_RATE_MAX, SPEED
from guard_cases import known_motion, moved, parameters_of, polar, random_velocity
from vessel_cases import LIMITS, Mailbox, Vessel, radio, report_of

from gnc.estimation.vessel import ReachableSet, Tube
from gnc.guard.guard import GuardStatus, HeadingRateFilter
from gnc.numeric import wrap

PLAN_PERIOD = 0.5
PIECE, FINE_PIECE = 0.025, 0.01
"""For which the vessel's acceleration is held [s]; the finer one where it has to divide a delay."""


class Hunt(NamedTuple):
    """Closest approach [m], and at how many steps the guard intervened and was lost."""

    closest: float
    intervened: int
    lost: int


def towards(vessel, north, east, silent):
    """At full acceleration to the vehicle, at all times."""
    return north - vessel.north, east - vessel.east


def ahead_of(vessel, north, east, silent):
    """Straight on while it reports; then at full acceleration to the vehicle."""
    return towards(vessel, north, east, silent) if silent else (0.0, 0.0)


def braking(vessel, north, east, silent):
    """Brakes as soon as its reports cease, and stops."""
    along = vessel.velocity_north, vessel.velocity_east
    return (-along[0], -along[1]) if silent and math.hypot(*along) > 0.05 else (0.0, 0.0)


def turning(vessel, north, east, silent):
    """Turns to the side of the vehicle as tightly as it may."""
    along = vessel.velocity_north, vessel.velocity_east
    to_north, to_east = towards(vessel, north, east, silent)
    side = math.copysign(1.0, along[0] * to_east - along[1] * to_north)
    return -side * along[1], side * along[0]


HUNTERS = (towards, ahead_of, braking, turning)


def aim_at(tube, own, time):
    """Demand a turn to where a disc has its centre."""
    since = time - tube.time
    north, east = tube.north + tube.velocity_north * since, tube.east + tube.velocity_east * since
    error = wrap(math.atan2(east - own.ground_east, north - own.ground_north) - own.course)
    return min(max(1.5 * error, -HEADING_RATE_MAX), HEADING_RATE_MAX)


def as_it_was_known(reach):
    """Return the discs of a guard that takes the vessel to be where its newest report says, and no
    more.
    """
    return lambda time: (Tube(*reach.tubes(time)[0][:5]),)


class ForgetfulFilter:
    """A guard that keeps off the disc that is nearest now, and remembers none that it kept off."""

    def __init__(self, parameters):
        self._parameters = parameters
        self._filter = HeadingRateFilter(parameters)

    @property
    def status(self):
        return self._filter.status

    def limit(self, *demand):
        fresh = HeadingRateFilter(self._parameters)
        fresh.history, fresh.budget = self._filter.history, self._filter.budget
        self._filter = fresh
        return fresh.limit(*demand)


def hunted(
    seed,
    hunter,
    *,
    lag=0.4,
    delay=0.0,
    time_step=0.1,
    silence=0.0,
    speed_max=12.0,
    known=lambda reach: reach.tubes,
    make=HeadingRateFilter,
):
    """Fly a guarded vehicle that aims at a vessel against a hunter; return the hunt.

    A seed stands for vessel, start and reports, whose largest errors are in the direction that
    hides the vessel and which cease after 40 s. ``known`` makes the discs of the reachable set
    those that the guard knows.
    """
    generator, duration = np.random.default_rng(seed), 100.0 + silence
    limits = replace(LIMITS, speed_max=speed_max)
    velocity = random_velocity(generator, float(generator.uniform(2.0, 0.9 * speed_max)))
    bearing, distance = generator.uniform(-math.pi, math.pi), generator.uniform(450.0, 700.0)
    state = polar(distance, bearing, generator.uniform(-math.pi, math.pi))
    sent = sorted(
        radio(
            generator,
            interval=(2.0, 10.0),
            latency=3.0,
            missing=0.2,
            silences=[(40.0, 40.0 + silence)],
            duration=duration,
        )
    )
    guard = make(parameters_of(lag=lag, delay=delay, time_step=time_step))
    vessel = Vessel(0.0, 0.0, *velocity, limits)
    reach, post = ReachableSet(limits), Mailbox()
    tubes = known(reach)
    piece = FINE_PIECE if delay else PIECE
    under_way = deque([state[3]] * round(delay / piece))
    closest, intervened, lost, last_report, discs = math.inf, 0, 0, -math.inf, ()
    for step in range(round(duration / time_step)):
        time = step * time_step
        away = math.atan2(vessel.east - state[1], vessel.north - state[0])
        while sent and sent[0][0] <= time:
            when, arrives = sent.pop(0)
            split = float(generator.uniform(0.0, 0.5 * math.pi))
            side = away if generator.uniform() < 0.7 else away + math.pi
            post.send(
                arrives + time - when, report_of(vessel, time, split=split, place=side, drift=side)
            )
            last_report = time
        for report in post.deliver(time):
            reach.report(report)
        if step % round(PLAN_PERIOD / time_step) == 0:
            discs = tubes(time)
        own = known_motion(state)
        command = guard.limit(aim_at(discs[0], own, time), time, own, discs, SPEED)
        intervened += guard.status is not GuardStatus.FREE
        lost += guard.status is GuardStatus.LOST
        silent = not sent or sent[0][0] > time + 10.0 or time - last_report > 10.0
        for _ in range(round(time_step / piece)):
            under_way.append(command)
            state = moved(state, under_way.popleft(), lag, piece)
            north, east = hunter(vessel, state[0], state[1], silent)
            vessel.accelerate(1e3 * north, 1e3 * east, piece)
            closest = min(closest, math.hypot(state[0] - vessel.north, state[1] - vessel.east))
    return Hunt(closest, intervened, lost)
