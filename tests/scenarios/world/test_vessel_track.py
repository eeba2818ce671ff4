import math

import numpy as np
import pytest
from sea_cases import track


def test_a_steady_turn_is_a_circle():
    # From north, to the right, all the way round at 1 deg/s: radius 8/0.01745 m, centred to starboard.
    vessel = track({"speed_mps": 8.0, "manoeuvres": [{"at_s": 0.0, "turn_deg": 360.0, "turn_rate_deg_s": 1.0}]}, 400.0)
    rate = math.radians(1.0)
    radius = 8.0 / rate
    for time in (0.0, 33.33, 90.0, 200.017, 360.0):
        angle = rate * time
        north, east, v_north, v_east = vessel.motion(time)
        # The trapezoidal rule over 0.05 s: h^2/12 of the acceleration's change, 0.28 m/s^2 at most, 6e-5 m.
        assert (north, east) == pytest.approx((radius * math.sin(angle), radius * (1.0 - math.cos(angle))), abs=1e-4)
        # Velocity linear in between: h^2/8 of 8 rate^2, 8e-7 m/s.
        assert (v_north, v_east) == pytest.approx((8.0 * math.cos(angle), 8.0 * math.sin(angle)), abs=1e-6)
    assert vessel.manoeuvres_end == pytest.approx(360.0)


@pytest.mark.parametrize(("speed", "end"), [(11.0, 11.0), (0.0, 0.0)])
def test_a_change_of_speed_is_a_parabola(speed, end):
    vessel = track({"speed_mps": 8.0, "course_deg": 90.0, "manoeuvres": [
        {"at_s": 50.0, "speed_mps": speed, "acceleration_mps2": 0.1}
    ]})  # fmt: skip
    takes = abs(speed - 8.0) / 0.1
    assert vessel.manoeuvres_end == pytest.approx(50.0 + takes)
    sign = math.copysign(0.1, speed - 8.0)
    for since in (0.0, 10.0, takes, takes + 30.0):
        accelerating = min(since, takes)
        way = 400.0 + 8.0 * since + 0.5 * sign * accelerating**2 + sign * takes * (since - accelerating)
        # The trapezoidal rule is exact but for the two corners, which lie on points of the table.
        assert vessel.motion(50.0 + since)[1] == pytest.approx(way, abs=1e-6)
    assert vessel.motion(50.0 + takes + 1.0)[3] == pytest.approx(end, abs=1e-12)


def test_manoeuvres_follow_each_other():
    vessel = track({"speed_mps": 8.0, "manoeuvres": [
        {"at_s": 10.0, "turn_deg": 90.0, "turn_rate_deg_s": 1.0},
        {"at_s": 200.0, "turn_deg": -30.0, "turn_rate_deg_s": 0.5, "speed_mps": 5.0, "acceleration_mps2": 0.1},
    ]})  # fmt: skip
    _, _, v_north, v_east = vessel.motion(150.0)
    assert (v_north, v_east) == pytest.approx((0.0, 8.0), abs=1e-9)
    _, _, v_north, v_east = vessel.motion(300.0)
    course = math.radians(60.0)
    assert (v_north, v_east) == pytest.approx((5.0 * math.cos(course), 5.0 * math.sin(course)), abs=1e-9)
    # The slower of both parts: 30/0.5 s, against 3/0.1 s.
    assert vessel.manoeuvres_end == pytest.approx(260.0)


def test_the_plume_trails_behind_the_motion_through_the_air():
    # Course north at 6 m/s in a wind to the east at 6 m/s: through the air it goes north-west, and the smoke south-east.
    vessel = track({"speed_mps": 6.0}, wind=(0.0, 6.0))
    assert math.remainder(vessel.axis(10.0) - math.radians(135.0), 2.0 * math.pi) == pytest.approx(0.0, abs=1e-12)
    assert vessel.apparent_wind_at_start == pytest.approx(math.hypot(6.0, 6.0))
    assert vessel.apparent_wind_range == pytest.approx([math.hypot(6.0, 6.0)] * 2)
    assert math.isnan(vessel.manoeuvres_end)


def test_a_given_plume_turns_with_the_vessel():
    vessel = track(
        {"speed_mps": 8.0, "manoeuvres": [{"at_s": 0.0, "turn_deg": 90.0, "turn_rate_deg_s": 1.0}]}, plume_heading=math.pi
    )
    assert vessel.axis(45.0) == pytest.approx(math.pi + math.radians(45.0), abs=1e-9)


def test_the_plumes_course_never_jumps_where_its_angle_is_wrapped():
    # Behind a vessel that turns right round, seen from the air: a full turn in all.
    vessel = track({"speed_mps": 8.0, "manoeuvres": [{"at_s": 10.0, "turn_deg": 360.0, "turn_rate_deg_s": 2.0}]}, wind=(3.0, 0.0))
    axis = np.array([vessel.axis(t) for t in np.arange(0.0, 300.0, 0.1)])
    # 2 deg/s over the ground, by up to 8/(8 - 3) as much through the air, in 0.1 s.
    assert np.abs(np.diff(axis)).max() < math.radians(0.2 * 8.0 / 5.0) * 1.01
    assert axis[-1] - axis[0] == pytest.approx(2.0 * math.pi, abs=1e-9)


def test_the_plume_of_a_vessel_that_stops_in_still_air_stays_where_it_was():
    vessel = track({"speed_mps": 8.0, "course_deg": 30.0, "manoeuvres": [
        {"at_s": 10.0, "speed_mps": 0.0, "acceleration_mps2": 0.5}
    ]})  # fmt: skip
    # No direction follows from no motion at all: it is that of the last, 210 degrees.
    assert math.remainder(vessel.axis(100.0) - math.radians(210.0), 2.0 * math.pi) == pytest.approx(0.0, abs=1e-9)
    assert vessel.apparent_wind_range == pytest.approx((0.0, 8.0), abs=1e-12)
