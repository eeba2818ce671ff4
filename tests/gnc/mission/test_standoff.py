import math

import pytest
from gnc_cases import SPEED, TIME_STEP
from hypothesis import given
from hypothesis import strategies as st

from gnc.estimation.health import Fault
from gnc.estimation.navigation import TrueNavigation
from gnc.estimation.vessel import SteadyTarget
from gnc.laws import CascadeLaw
from gnc.mission.axis import AxisHeight, Climb
from gnc.mission.mission import TRACK, Mode
from gnc.mission.standoff import CirclePoint, StandoffOrbit, StandoffParameters
from gnc.tracker import TrackingParameters
from gnc.unicycle import unicycle_move

RADIUS, LIMIT = 120.0, 0.503
LEVEL = AxisHeight(source=60.0)


def mission(law, height=LEVEL):
    parameters = StandoffParameters(
        radius=RADIUS,
        tracked=12.0,
        speed=SPEED,
        speed_ratio_max=0.97,
        glide_airspeed=15.0,
        plan_interval=10,
        altitude=height.source,
        height=height,
        climb=Climb(time=20.0, gradient=0.05),
    )
    tracking = TrackingParameters(law=law, heading_rate_max=LIMIT, time_step=TIME_STEP, lag=0.0)
    return StandoffOrbit(parameters, tracking)


class Flown:
    """A kinematic flight under a law: distances from the vessel, mission, and last mode."""

    def __init__(self, law, seconds, vessel=(6.0, 3.0), start=(-400.0, 50.0, 1.0)):
        own, target, self.mission = TrueNavigation(), SteadyTarget(*vessel), mission(law)
        north, east, course = start
        self.distances, rate = [], 0.0
        for step in range(round(seconds / TIME_STEP)):
            time, renew = step * TIME_STEP, step % 10 == 0
            own.update((north, east, SPEED * math.cos(course), SPEED * math.sin(course), rate))
            target.update(time, renew)
            order = self.mission.plan(time, own, target, renew=renew, guarding=False)
            assert order.heading_rate is TRACK
            self.distances.append(math.hypot(north - target.north, east - target.east))
            rate = self.mission.tracker.step(north, east, course, SPEED, rate)
            north, east, course = unicycle_move(north, east, course, SPEED, rate, TIME_STEP)
        self.mode = order.mode


@given(bearing=st.floats(-3.1, 3.1), drift=st.floats(0.0, 0.9), towards=st.floats(-3.1, 3.1))
def test_a_vehicle_on_the_circle_with_the_references_course_and_heading_rate_stays_on_it(
    bearing, drift, towards
):
    velocity = drift * SPEED * math.cos(towards), drift * SPEED * math.sin(towards)
    point, time = CirclePoint(SPEED), 1e-3
    point.place(
        (0.0, 0.0), velocity, (RADIUS * math.cos(bearing), RADIUS * math.sin(bearing)), RADIUS
    )
    north, east, course = unicycle_move(
        point.north, point.east, point.course, SPEED, point.heading_rate, time
    )
    off = math.hypot(north - time * velocity[0], east - time * velocity[1]) - RADIUS
    # What is left is of third order: V (V/R)^2 t^3 and a constant, at up to twice the speed.
    assert off == pytest.approx(0.0, abs=1e-8)
    point.place((time * velocity[0], time * velocity[1]), velocity, (north, east), RADIUS)
    # The reference a moment later goes on the same course: second order, (V/R)^2 t^2 with the
    # speeds that add up.
    assert math.remainder(point.course - course, math.tau) == pytest.approx(0.0, abs=2e-6)


def test_the_papers_law_circles_a_moving_vessel_at_the_radius():
    flight = Flown(CascadeLaw(), 200.0)
    # Closed in, and within the centimetres of a law that is called twenty times a second.
    assert flight.mission.orbit.in_place
    assert max(abs(distance - RADIUS) for distance in flight.distances[-1000:]) < 0.2


@pytest.mark.parametrize(
    ("fault", "mode", "speed"),
    [(Fault.THRUST_LOST, Mode.GLIDING, 14.9), (Fault.ACTUATOR_STUCK, Mode.TERMINATING, SPEED)],
)
def test_a_vehicle_with_a_fault_flies_straight_out_and_sinks(fault, mode, speed):
    own, target, circling = TrueNavigation(), SteadyTarget(0.0, 0.0), mission(CascadeLaw())
    circling.react(fault)
    # South of the vessel and on a southerly course: straight on leads out.
    own.update((-RADIUS, 0.0, -speed, 0.0, 0.0))
    order = circling.plan(0.0, own, target, renew=True, guarding=False)
    assert order.heading_rate == pytest.approx(0.0, abs=1e-9)
    assert (order.airspeed, order.mode) == (15.0, mode)
    # So far below the sea that the autopilot holds its airspeed by pitch.
    assert order.altitude < -500.0
