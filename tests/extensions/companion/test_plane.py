"""The modes of the simulated vehicle: what GUIDED takes, for how long, and what it refuses."""

import math
from types import SimpleNamespace

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from common.geodesy import LocalFrame
from extensions.companion.fields import degrees_e7, equivalent_over_true, roll_target
from extensions.companion.plane import ACCEPTED, DENIED, FAILED, UNSUPPORTED, Plane, PlaneMode
from scenarios.vehicles.kinematic import KinematicVehicle

STEP, SPEED, ALTITUDE = 0.05, 20.0, 60.0
PARAMETERS = {
    "ROLL_LIMIT_DEG": 45.0,
    "AIRSPEED_MIN": 15.0,
    "AIRSPEED_MAX": 25.0,
    "AIRSPEED_CRUISE": SPEED * equivalent_over_true(ALTITUDE),
    "WP_LOITER_RAD": 80.0,
    "GUIDED_P": 5000.0,
    "GUIDED_TIMEOUT": 3.0,
    "FS_GCS_ENABL": 1.0,
    "FS_LONG_TIMEOUT": 5.0,
    "FS_LONG_ACTN": 1.0,
}
FRAME = LocalFrame(math.radians(57.5), math.radians(11.2), ALTITUDE)


@pytest.fixture
def plane():
    vehicle = KinematicVehicle(
        north=0.0, east=0.0, altitude=ALTITUDE, course=0.5, speed=SPEED, time_step=STEP, lag=0.0
    )
    return Plane(vehicle, FRAME, time_step=STEP, altitude=ALTITUDE, airspeed=SPEED,
                 parameters=PARAMETERS, mode=PlaneMode.GUIDED)  # fmt: skip


def command(number, *values, x=0, y=0, z=0.0, frame=mavlink.MAV_FRAME_GLOBAL):
    first, second, third, fourth = (*values, 0.0, 0.0, 0.0, 0.0)[:4]
    return SimpleNamespace(command=number, param1=first, param2=second, param3=third, param4=fourth,
                           x=x, y=y, z=z, frame=frame)  # fmt: skip


def fly(plane, seconds):
    for _ in range(round(seconds / STEP)):
        plane.step()


def rolled(plane):
    return plane.vehicle.air_data()[2]


def heading(plane):
    return plane.vehicle.air_data()[1]


def test_a_roll_is_flown_until_its_time_out_and_then_the_loiter(plane):
    plane.set_attitude(roll_target(0.0, 1, 1, -0.3))
    fly(plane, 2.9)
    assert rolled(plane) == pytest.approx(-0.3)
    fly(plane, 0.2)
    # About the place where GUIDED was entered, clockwise: back to the right.
    assert rolled(plane) > 0.0
    fly(plane, 200.0)
    motion = plane.vehicle.motion()
    # L1 on a circle has an error of centimetres without wind; the step adds some.
    assert math.hypot(motion.north, motion.east) == pytest.approx(80.0, abs=2.0)


def test_a_roll_turns_right_at_the_rate_of_a_coordinated_turn_and_is_cut_at_the_limit(plane):
    before = heading(plane)
    plane.set_attitude(roll_target(0.0, 1, 1, 0.4))
    fly(plane, 1.0)
    assert heading(plane) - before == pytest.approx(9.80665 * math.tan(0.4) / SPEED, rel=1e-9)
    plane.set_attitude(roll_target(0.0, 1, 1, 1.2))
    fly(plane, STEP)
    assert rolled(plane) == pytest.approx(math.radians(45.0))


def test_a_heading_is_sticky_and_by_true_north(plane):
    change = command(
        mavlink.MAV_CMD_GUIDED_CHANGE_HEADING, mavlink.HEADING_TYPE_HEADING, 120.0, 9.0
    )
    assert plane.command(change) == ACCEPTED
    fly(plane, 60.0)
    at = FRAME.to_geodetic(plane.vehicle.motion().north, plane.vehicle.motion().east)
    turned = float(FRAME.true_north(*at))
    assert heading(plane) - turned == pytest.approx(math.radians(120.0), abs=1e-3)
    # 50 degrees of roll per radian is a lag of V/(g k) = 2.3 s, and stays without further commands.
    assert rolled(plane) == pytest.approx(0.0, abs=1e-3)


def test_a_turn_to_a_heading_is_bounded_by_its_acceleration(plane):
    plane.command(command(mavlink.MAV_CMD_GUIDED_CHANGE_HEADING, 1, 200.0, 2.0))
    fly(plane, STEP)
    assert rolled(plane) == pytest.approx(math.atan(2.0 / 9.80665))


@pytest.mark.parametrize(
    ("message", "result"),
    [
        (command(mavlink.MAV_CMD_GUIDED_CHANGE_SPEED, mavlink.SPEED_TYPE_AIRSPEED, 18.0), ACCEPTED),
        (command(mavlink.MAV_CMD_GUIDED_CHANGE_SPEED, 1, 18.0), DENIED),
        (command(mavlink.MAV_CMD_GUIDED_CHANGE_SPEED, mavlink.SPEED_TYPE_AIRSPEED, 30.0), FAILED),
        (command(mavlink.MAV_CMD_GUIDED_CHANGE_SPEED, 0, math.nan), FAILED),
        (command(mavlink.MAV_CMD_GUIDED_CHANGE_ALTITUDE, z=80.0), ACCEPTED),
        (command(mavlink.MAV_CMD_GUIDED_CHANGE_ALTITUDE, z=0.0), DENIED),
        (command(mavlink.MAV_CMD_GUIDED_CHANGE_ALTITUDE, z=80.0, frame=99), DENIED),
        (command(mavlink.MAV_CMD_GUIDED_CHANGE_HEADING, 0, 360.0, 2.0), DENIED),
        (command(mavlink.MAV_CMD_GUIDED_CHANGE_HEADING, 0, -1.0, 2.0), DENIED),
        (command(mavlink.MAV_CMD_DO_REPOSITION, -1.0, x=0, y=0, z=80.0), DENIED),
        (command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1.0), UNSUPPORTED),
    ],
)
def test_commands_are_acknowledged_as_arduplane_does(plane, message, result):
    assert plane.command(message) == result


def test_nothing_is_taken_in_another_mode(plane):
    plane.set_mode(PlaneMode.LOITER)
    speed = command(mavlink.MAV_CMD_GUIDED_CHANGE_SPEED, mavlink.SPEED_TYPE_AIRSPEED, 18.0)
    assert plane.command(speed) == FAILED
    assert plane.command(command(mavlink.MAV_CMD_DO_REPOSITION, -1.0, 0.0, x=575, y=112)) == FAILED
    assert plane.mode is PlaneMode.LOITER
    fly(plane, STEP)
    before = rolled(plane)
    plane.set_attitude(roll_target(0.0, 1, 1, -0.6))
    fly(plane, STEP)
    assert rolled(plane) == pytest.approx(before, abs=0.02)


def test_airspeed_is_an_equivalent_one_and_changes_at_the_rate_that_is_asked_for(plane):
    plane.command(command(mavlink.MAV_CMD_GUIDED_CHANGE_SPEED, 0, 18.0, 0.5))
    fly(plane, 1.0)
    assert plane.vehicle.air_data()[0] == pytest.approx(SPEED - 0.5)
    fly(plane, 10.0)
    assert plane.vehicle.air_data()[0] == pytest.approx(18.0 / equivalent_over_true(ALTITUDE))


def test_altitudes_are_above_the_sea_or_above_home(plane):
    relative = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT
    plane.command(command(mavlink.MAV_CMD_GUIDED_CHANGE_ALTITUDE, z=30.0, frame=relative))
    fly(plane, STEP)
    assert plane.vehicle.sample()[0] == pytest.approx(ALTITUDE + 30.0)
    plane.command(command(mavlink.MAV_CMD_GUIDED_CHANGE_ALTITUDE, 0.0, 0.0, 2.0, z=70.0))
    fly(plane, 5.0)
    assert plane.vehicle.sample()[0] == pytest.approx(80.0)


def test_a_reposition_is_loitered_about_and_ends_a_heading(plane):
    plane.command(command(mavlink.MAV_CMD_GUIDED_CHANGE_HEADING, 1, 10.0, 9.0))
    latitude, longitude = FRAME.to_geodetic(300.0, -200.0)
    place = {"x": degrees_e7(float(latitude)), "y": degrees_e7(float(longitude)), "z": ALTITUDE}
    assert (
        plane.command(command(mavlink.MAV_CMD_DO_REPOSITION, -1.0, 0.0, 100.0, **place)) == ACCEPTED
    )
    fly(plane, 200.0)
    motion = plane.vehicle.motion()
    assert math.hypot(motion.north - 300.0, motion.east + 200.0) == pytest.approx(100.0, abs=2.0)


def test_a_ground_station_that_falls_silent_is_a_failsafe_and_one_that_was_never_heard_is_none(
    plane,
):
    fly(plane, 10.0)
    assert plane.mode is PlaneMode.GUIDED
    plane.ground_station_seen()
    fly(plane, 4.9)
    assert plane.mode is PlaneMode.GUIDED
    fly(plane, 0.3)
    assert plane.mode is PlaneMode.RTL
