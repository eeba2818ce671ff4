"""The paper's vehicle, Cartesian motion to check against, and kinematic flights, for all tests.

The paper does not print V_r and omega_max; 19.42 m/s and 0.503 rad/s reproduce its Simulation 3.
"""

import math
import os
from collections import deque
from typing import NamedTuple

import numpy as np
from hypothesis import settings
from hypothesis import strategies as st

from gnc.airspeed import AlongTrackTrim
from gnc.estimation.navigation import MeasuredMotion
from gnc.guidance import Guidance, GuidanceParameters
from gnc.laws import CascadeLaw
from gnc.mission.track import DirectParameters
from gnc.paper import (
    design_oscillation,
    half_widths,
    look_ahead,
    relative_state,
    relative_velocity,
    unicycle_rates,
)
from gnc.reference.moving_centre import CentreParameters
from gnc.reference.oscillating import OscillatingReference
from gnc.tracker import TrackingParameters
from gnc.unicycle import unicycle_move

SPEED, HEADING_RATE_MAX, TIME_STEP = 19.42, 0.503, 0.05
LOOK_AHEAD = look_ahead(0.005, 60.0)

courses = st.floats(-math.pi, math.pi)

DEPTH = int(os.environ.get("FUZZ_DEPTH", "1"))


def examples(count):
    """Settings of a property: the same examples on every machine.

    A quarter of ``count``, but twelve where there are as many: all of them, and more, with the
    environment variable FUZZ_DEPTH, as in tests/test_fuzz.py.
    """
    return settings(
        max_examples=max(min(count // 2, 12), count * DEPTH // 4), deadline=None, derandomize=True
    )


def paper_oscillation(nu, **changes):
    return design_oscillation(
        **({"nu": nu, "speed": SPEED, "heading_rate_max": HEADING_RATE_MAX} | changes)
    )


OSCILLATION = paper_oscillation(0.5)


def oscillating(time):
    """omega_r [rad/s] of equation (2), about a vessel on a straight course."""
    return -OSCILLATION.amplitude * math.sin(OSCILLATION.omega_0 * time)


def circling(time):
    """omega_r [rad/s] of the paper's Sim. 1, a circle."""
    return 0.2


def tracking_motion(steer, reference_heading_rate, *, reference_speed=SPEED, speed=SPEED):
    """Return the right-hand side of the tracking problem in Cartesian coordinates: (1) and (13),
    nothing of the delta formulation.

    The state is the reference's north, east and course, then the vehicle's, whose heading rate is
    ``steer(state, time)``.
    """

    def rates(time, state):
        of_reference = unicycle_rates(reference_speed, state[2], reference_heading_rate(time))
        return np.array([*of_reference, *unicycle_rates(speed, state[5], steer(state, time))])

    return rates


def moved(rates, time, state, step):
    """Return the state a small ``step`` away, by one classical Runge-Kutta step."""
    state = np.asarray(state, dtype=float)
    k_1 = rates(time, state)
    k_2 = rates(time + 0.5 * step, state + 0.5 * step * k_1)
    k_3 = rates(time + 0.5 * step, state + 0.5 * step * k_2)
    k_4 = rates(time + step, state + step * k_3)
    return state + step / 6.0 * (k_1 + 2.0 * k_2 + 2.0 * k_3 + k_4)


def relative(state, parameters=LOOK_AHEAD):
    """Return the relative state (19) of a Cartesian state."""
    return relative_state(parameters, state[0] - state[3], state[1] - state[4], state[2], state[5])


@st.composite
def tracking_starts(draw, *, phi_max=math.pi):
    """The reference at the origin, the vehicle up to 300 m about it, phi no more than ``phi_max``
    [rad] to either side.
    """
    north, east = draw(st.floats(-300.0, 300.0)), draw(st.floats(-300.0, 300.0))
    reference_course = draw(courses)
    z_course = -relative([0.0, 0.0, reference_course, north, east, 0.0]).phi
    return [0.0, 0.0, reference_course, north, east, z_course + draw(st.floats(-phi_max, phi_max))]


def delta_steering(law, reference_heading_rate, parameters=LOOK_AHEAD):
    """Return ``steer`` for a law of the relative state and omega_rho."""

    def steer(state, time):
        there, omega_r = relative(state, parameters), reference_heading_rate(time)
        return law(there, relative_velocity(parameters, there, SPEED, SPEED, omega_r)[1])

    return steer


def tracking_parameters(**changes):
    """Return how the paper's vehicle tracks; it answers at once."""
    defaults = {"law": CascadeLaw(), "heading_rate_max": HEADING_RATE_MAX, "lag": 0.0}
    return TrackingParameters(**(defaults | {"time_step": TIME_STEP} | changes))


def make_reference(
    oscillation, *, phase=0.0, centre=(0.0, 0.0), vessel_course=0.0, time_step=TIME_STEP
):
    return OscillatingReference(
        oscillation,
        phase=phase,
        centre_north=centre[0],
        centre_east=centre[1],
        vessel_course=vessel_course,
        time_step=time_step,
    )


def paper_parameters(mission, *, vessel=(0.0, 0.0), guard=None, airspeed_gain=0.0, **tracking):
    """Return the guidance of the paper's flights: beside a vessel that is known exactly, at a
    velocity [m/s], in still air.
    """
    return GuidanceParameters(
        speed=SPEED,
        altitude=60.0,
        tracking=tracking_parameters(**tracking),
        airspeed_law=AlongTrackTrim(speed=SPEED, gain=airspeed_gain, change_max=1.0),
        airspeed_bandwidth=math.inf,
        airspeed_overshoot=0.0,
        navigation=None,
        vessel=vessel,
        guard=guard,
        mission=mission,
        health=None,
    )


def make_guidance(reference, **how):
    """Return the paper's guidance, which tracks a reference from the first step on; ``how`` same as
    in ``paper_parameters``.
    """
    return Guidance(paper_parameters(DirectParameters(reference=reference), **how))


def centre_parameters(**changes):
    """Return how the centre of oscillation astern of a vessel moves; it keeps 203 m."""
    widths = [
        half_widths(paper_oscillation(nu, roll_rate_max=math.radians(40.0)))
        for nu in np.linspace(0.0, 0.97, 49)
    ]
    along, across = zip(*widths, strict=True)
    defaults = {"distance_min": 203.0, "speed_ratio_max": 0.97, "along": along, "across": across}
    defaults |= {"plume_heading": None, "vessel_course": 0.0, "apparent_wind_min": 1.0}
    return CentreParameters(**(defaults | {"speed": SPEED, "heading_rate_max": 0.505} | changes))


def motion(north, east, course, speed=SPEED, heading_rate=0.0):
    """Return a motion as the guidance takes it: velocities instead of course and speed."""
    return MeasuredMotion(
        north, east, speed * math.cos(course), speed * math.sin(course), heading_rate
    )


class KinematicFlight(NamedTuple):
    """Histories, one entry per guidance step: commanded heading rate, distances to the reference
    and to the vessel, and whether the guard acted.
    """

    command: np.ndarray
    distance: np.ndarray
    to_vessel: np.ndarray
    guarded: np.ndarray


def fly(guidance, start, *, duration, delay=0.0):
    """Fly a unicycle that answers the guidance's heading rate exactly, ``delay`` seconds late."""
    north, east, course = start
    pending, rate, rows = deque([0.0] * round(delay / TIME_STEP)), 0.0, []
    for step in range(round(duration / TIME_STEP)):
        reference, target = guidance.mission.tracker.reference, guidance.target
        distance = math.hypot(reference.north - north, reference.east - east)
        guidance.step(step * TIME_STEP, motion(north, east, course, SPEED, rate))
        to_vessel = math.hypot(north - target.north, east - target.east)
        rows.append((guidance.heading_rate_command, distance, to_vessel, guidance.guarding))
        pending.append(guidance.heading_rate_command)
        rate = pending.popleft()
        north, east, course = unicycle_move(north, east, course, SPEED, rate, TIME_STEP)
    return KinematicFlight(*np.array(rows).T)
