"""What a flight cannot depend on: the motion of the air as a whole, which way is north, and left
and right.
"""

import math

import numpy as np
import pytest

from scenarios import fly

pytestmark = pytest.mark.slow

AIRSPEED, THROUGH_AIR = 19.42, 9.0
"""V_r of the vehicle, and the vessel's speed through the air, along a course of 0 in it [m/s]."""


def flown(place, start_course, wind=(1e-9, 0.0), turned=0.0):
    """Return where the vehicle is from the vessel, shape (n, 2) [m], in the frame of the vessel's
    motion through the air on a course [rad]; place [m] and course [deg] of the start and the wind
    [m/s] are in that frame, too.
    """
    turn = np.array([[math.cos(turned), -math.sin(turned)], [math.sin(turned), math.cos(turned)]])
    wind_north, wind_east = turn @ wind
    over_ground = turn @ [THROUGH_AIR, 0.0] + [wind_north, wind_east]
    course = math.atan2(over_ground[1], over_ground[0])
    cos, sin = math.cos(course), math.sin(course)
    from_bow = np.array([[cos, sin], [-sin, cos]]) @ turn @ place
    settings = {
        "vessel.course_deg": math.degrees(course) % 360.0,
        "wind.speed_mps": math.hypot(wind_north, wind_east),
        "wind.from_deg": math.degrees(math.atan2(-wind_east, -wind_north)) % 360.0,
        "start.place_m": from_bow.tolist(),
        "start.course_deg": math.degrees(turned) + start_course,
        "flight.duration_max_s": 60.0,
    }
    ratio = float(np.hypot(*over_ground)) / AIRSPEED
    history = fly("sweep_nu", fidelity="kinematic", nu=ratio, **settings).history
    relative = [history[f"{axis}_m"] - history[f"vessel_{axis}_m"] for axis in ("north", "east")]
    return np.column_stack(relative) @ turn


STARTS = {"astern": ([-400.0, 150.0], 30.0), "ahead": ([300.0, 250.0], -150.0)}


@pytest.mark.parametrize("start", STARTS)
def test_a_flight_is_the_same_in_a_wind_and_on_another_course(start):
    # Places over the ground, wind and compass are used all the way; as seen from the ship in moving
    # air it is one flight.
    plain = flown(*STARTS[start])
    assert np.hypot(*plain.T).min() < 230.0
    for changed in ({"wind": (3.0, -5.0)}, {"turned": 2.5}, {"wind": (-3.0, 2.0), "turned": -1.0}):
        assert flown(*STARTS[start], **changed) == pytest.approx(plain, abs=1e-4), changed


@pytest.mark.parametrize("start", STARTS)
def test_left_and_right_are_alike(start):
    (ahead, right), course = STARTS[start]
    both = []
    for side in (1.0, -1.0):
        keys = {"start.place_m": [ahead, side * right], "start.course_deg": side * course}
        keys["flight.duration_max_s"] = 60.0
        both.append(fly("sweep_nu", fidelity="kinematic", nu=0.5, **keys).history)
    for name, sign in (("north_m", 1.0), ("east_m", -1.0)):
        assert both[0][name].to_numpy() == pytest.approx(sign * both[1][name].to_numpy(), abs=1e-6)
