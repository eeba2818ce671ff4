"""Fields of messages against their definitions, as an independent reader of MAVLink decodes them."""

import dataclasses
import math

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from aircraft.fdm import Fdm
from aircraft.fleet.find import find_spec
from aircraft.state import RigidBodyState
from common.physics import METRES_PER_FOOT
from extensions.companion.fields import (
    AircraftState,
    VesselState,
    equivalent_over_true,
    roll_of,
    roll_target,
    wind,
)
from scenarios.world.ais.size import ShipSize

# Climbing, banked to the right, to the south-west: every sign differs from its opposite.
STATE = AircraftState(
    time=12.345,
    latitude=math.radians(57.5),
    longitude=math.radians(-11.25),
    altitude=73.5,
    height=13.5,
    velocity_north=-12.34,
    velocity_east=-5.67,
    climb=1.5,
    roll=0.4,
    pitch=0.1,
    yaw=math.radians(-155.0),
    rates=(0.01, 0.02, 0.3),
    airspeed=18.25,
    throttle=0.42,
)
VESSEL = VesselState(
    mmsi=219000001,
    name="EXAMPLE",
    latitude=math.radians(-33.25),
    longitude=math.radians(151.75),
    velocity_north=-3.0,
    velocity_east=4.0,
    bow=math.radians(130.0),
    age=7.4,
)


def sent(message):
    """Return what a receiver decodes of a message, with each field in its definition's unit."""
    packed = message.pack(mavlink.MAVLink(None, srcSystem=1, srcComponent=1))
    (decoded,) = mavlink.MAVLink(None).parse_buffer(packed)
    return decoded


def unit(message, field):
    return type(message).fieldunits_by_name.get(field, "")


def in_si(message, field):
    """Return a field in SI, by the unit that its definition states."""
    factor = {"degE7": 1e-7, "cdeg": 1e-2, "deg": 1.0, "mm": 1e-3, "m": 1.0, "cm/s": 1e-2,
              "m/s": 1.0, "rad": 1.0, "rad/s": 1.0, "ms": 1e-3, "us": 1e-6, "%": 1e-2, "s": 1.0,
              "": 1.0}[unit(message, field)]  # fmt: skip
    return factor * getattr(message, field)


def test_a_place_is_in_degrees_and_millimetres_and_velocities_point_north_east_and_down():
    decoded = sent(STATE.global_position())
    assert in_si(decoded, "time_boot_ms") == pytest.approx(12.345, abs=1e-3)
    assert in_si(decoded, "lat") == pytest.approx(57.5, abs=1e-7)
    assert in_si(decoded, "lon") == pytest.approx(-11.25, abs=1e-7)
    assert in_si(decoded, "alt") == pytest.approx(73.5, abs=1e-3)
    assert in_si(decoded, "relative_alt") == pytest.approx(13.5, abs=1e-3)
    assert in_si(decoded, "vx") == pytest.approx(-12.34, abs=0.005)
    assert in_si(decoded, "vy") == pytest.approx(-5.67, abs=0.005)
    # "Ground Z Speed (Altitude, positive down)".
    assert in_si(decoded, "vz") == pytest.approx(-1.5, abs=0.005)
    assert in_si(decoded, "hdg") == pytest.approx(205.0, abs=0.01)


def test_attitude_and_hud_are_in_radians_degrees_metres_per_second_and_percent():
    decoded, hud, fix = sent(STATE.attitude()), sent(STATE.vfr_hud()), sent(STATE.gps_raw())
    assert [in_si(decoded, name) for name in ("roll", "pitch", "yaw")] == pytest.approx(
        [0.4, 0.1, math.radians(-155.0)], abs=1e-6
    )
    assert [
        in_si(decoded, name) for name in ("rollspeed", "pitchspeed", "yawspeed")
    ] == pytest.approx(STATE.rates, abs=1e-6)
    assert in_si(hud, "airspeed") == pytest.approx(18.25, abs=1e-5)
    assert in_si(hud, "groundspeed") == pytest.approx(math.hypot(12.34, 5.67), abs=1e-5)
    assert in_si(hud, "heading") == 205.0
    assert in_si(hud, "throttle") == pytest.approx(0.42)
    assert in_si(hud, "climb") == pytest.approx(1.5, abs=1e-5)
    # The course over the ground of that velocity, to the south-west.
    assert in_si(fix, "cog") == pytest.approx(
        180.0 + math.degrees(math.atan2(5.67, 12.34)), abs=0.01
    )
    assert in_si(fix, "vel") == pytest.approx(math.hypot(12.34, 5.67), abs=0.005)
    assert fix.fix_type == mavlink.GPS_FIX_TYPE_3D_FIX


@pytest.mark.parametrize("towards", [0.0, 60.0, 200.0, 300.0])
def test_wind_is_reported_by_where_it_comes_from(towards):
    """ "wind direction (that wind is coming from)"."""
    north, east = (5.0 * f(math.radians(towards)) for f in (math.cos, math.sin))
    decoded = sent(wind(north, east))
    assert decoded.speed == pytest.approx(5.0)
    assert math.remainder(decoded.direction - towards - 180.0, 360.0) == pytest.approx(
        0.0, abs=1e-4
    )


def test_a_vessel_has_a_course_a_bow_and_a_speed_of_their_own():
    decoded = sent(VESSEL.ais())
    assert (in_si(decoded, "lat"), in_si(decoded, "lon")) == pytest.approx(
        (-33.25, 151.75), abs=1e-7
    )
    # South-east by north -3 and east 4.
    assert in_si(decoded, "COG") == pytest.approx(
        90.0 + math.degrees(math.atan2(3.0, 4.0)), abs=0.01
    )
    assert in_si(decoded, "heading") == pytest.approx(130.0, abs=0.01)
    assert in_si(decoded, "velocity") == pytest.approx(5.0, abs=0.005)
    assert (decoded.MMSI, decoded.name, in_si(decoded, "tslc")) == (219000001, "EXAMPLE", 7.0)
    assert decoded.flags & mavlink.AIS_FLAGS_VALID_COG
    back = VesselState.of(decoded)
    assert (back.velocity_north, back.velocity_east) == pytest.approx((-3.0, 4.0), abs=0.01)
    assert back.latitude == pytest.approx(VESSEL.latitude, abs=1e-9)
    adsb = sent(VESSEL.adsb())
    assert in_si(adsb, "heading") == pytest.approx(130.0, abs=0.01)
    assert in_si(adsb, "hor_velocity") == pytest.approx(5.0, abs=0.005)


def test_a_vessel_without_a_place_or_a_velocity_is_none():
    def changed(**fields):
        decoded = sent(VESSEL.ais())
        for name, value in fields.items():
            setattr(decoded, name, value)
        return VesselState.of(decoded)

    assert changed() is not None
    assert changed(lat=0, lon=0) is None
    # 91 and 181 degrees are AIS's "not available".
    assert changed(lat=910000000) is None
    assert changed(lon=1810000000) is None
    assert changed(flags=mavlink.AIS_FLAGS_VALID_COG) is None
    assert changed(flags=mavlink.AIS_FLAGS_VALID_VELOCITY) is None


def test_a_vessel_may_say_its_size_and_where_its_bow_points():
    decoded = sent(VESSEL.ais())
    assert VesselState.of(decoded).size is None
    decoded.flags |= mavlink.AIS_FLAGS_VALID_DIMENSIONS
    decoded.dimension_bow, decoded.dimension_stern = 225, 70
    decoded.dimension_port, decoded.dimension_starboard = 1, 31
    assert VesselState.of(decoded).size == ShipSize(295.0, 32.0, 225.0, 1.0)
    # More than the field can say.
    decoded.flags |= mavlink.AIS_FLAGS_LARGE_BOW_DIMENSION
    assert VesselState.of(decoded).size is None
    assert VesselState.of(decoded).bow == pytest.approx(VESSEL.bow)
    # 511 degrees are "not available": the bow is taken to point along the course.
    decoded.heading = 51100
    course = math.atan2(VESSEL.velocity_east, VESSEL.velocity_north)
    assert VesselState.of(decoded).bow == pytest.approx(course, abs=1e-3)


def test_a_vessel_at_rest_has_no_course():
    decoded = sent(dataclasses.replace(VESSEL, velocity_north=0.0, velocity_east=0.0).ais())
    assert not decoded.flags & mavlink.AIS_FLAGS_VALID_COG
    assert VesselState.of(decoded).velocity_north == 0.0


@pytest.mark.parametrize("roll", [-0.7, 0.0, 0.3])
def test_a_roll_is_commanded_alone_and_comes_back_by_the_definition_of_the_quaternion(roll):
    decoded = sent(roll_target(3.0, 1, 1, roll))
    w, x, y, z = decoded.q
    # Aerospace sequence, w x y z, "zero-rotation is 1, 0, 0, 0".
    assert math.atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)) == pytest.approx(roll)
    # ArduPlane takes roll where the roll rate is not ignored; everything else is ignored.
    assert decoded.type_mask == 0xFF & ~1 & ~0b00111000
    assert roll_of(decoded) == pytest.approx(roll, abs=1e-6)


def test_a_target_without_roll_or_without_a_quaternion_is_no_roll():
    decoded = sent(roll_target(3.0, 1, 1, 0.3))
    decoded.type_mask |= mavlink.ATTITUDE_TARGET_TYPEMASK_BODY_ROLL_RATE_IGNORE
    assert roll_of(decoded) is None
    decoded = sent(roll_target(3.0, 1, 1, 0.3))
    decoded.q = [0.0, 0.0, 0.0, 0.0]
    assert roll_of(decoded) is None
    decoded.q = [math.nan, 0.0, 0.0, 0.0]
    assert roll_of(decoded) is None


def test_equivalent_airspeed_is_that_of_jsbsim():
    """JSBSim computes equivalent airspeed from its own atmosphere."""
    fdm = Fdm(find_spec("x8"))
    for altitude in (60.0, 1000.0):
        state = RigidBodyState(
            altitude=altitude, roll=0.0, pitch=0.0, velocity_body=(20.0, 0.0, 0.0)
        )
        fdm.place(state)
        equivalent = fdm.read("velocities/ve-fps") * METRES_PER_FOOT
        # The formula is rounded to five figures.
        assert 20.0 * equivalent_over_true(altitude) == pytest.approx(equivalent, rel=1e-4)
