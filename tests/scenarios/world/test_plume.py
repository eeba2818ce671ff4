"""The plume's true axis."""

import math

import numpy as np
import pytest

from aircraft.wind import constant_wind
from scenarios.scenario.sections.world import PlumeConfig, VesselConfig
from scenarios.world.plume import StraightPlume
from scenarios.world.vessel import ManoeuvringVessel, SteadyVessel

DURATION = 600.0


def behind(vessel, *, wind=(0.0, 0.0), heading_deg=None):
    """Return the plume behind a vessel; by the wind, or at an angle from its bow."""
    config = PlumeConfig() if heading_deg is None else PlumeConfig(heading_deg=heading_deg)
    return StraightPlume(
        config, vessel, constant_wind(*wind), DURATION, by_wind=heading_deg is None
    )


def steady(speed, course_deg=0.0):
    return SteadyVessel(speed, math.radians(course_deg))


def manoeuvring(*manoeuvres, speed=8.0, course_deg=0.0):
    config = VesselConfig.model_validate(
        {"speed_mps": speed, "course_deg": course_deg, "manoeuvres": manoeuvres}
    )
    return ManoeuvringVessel(config, speed, DURATION)


@pytest.mark.parametrize(
    "vessel", [steady(6.0), manoeuvring(speed=6.0)], ids=["steady", "without manoeuvres"]
)
def test_the_plume_trails_behind_the_motion_through_the_air(vessel):
    # Course north at 6 m/s in a wind to the east at 6 m/s: through the air it goes north-west, and
    # the smoke south-east.
    axis = behind(vessel, wind=(0.0, 6.0)).axis(10.0)
    assert math.remainder(axis - math.radians(135.0), 2.0 * math.pi) == pytest.approx(
        0.0, abs=1e-12
    )


def test_a_given_plume_keeps_its_angle_from_the_bow_of_a_steady_vessel_whatever_the_wind():
    plume = behind(steady(8.0, course_deg=30.0), wind=(5.0, 5.0), heading_deg=150.0)
    assert plume.axis(0.0) == plume.axis(500.0) == pytest.approx(math.pi, rel=1e-15)


def test_the_plumes_course_never_jumps_where_its_angle_is_wrapped():
    # Behind a vessel that turns right round, seen from the air: a full turn in all.
    plume = behind(
        manoeuvring({"at_s": 10.0, "turn_deg": 360.0, "turn_rate_deg_s": 2.0}), wind=(3.0, 0.0)
    )
    axis = np.array([plume.axis(t) for t in np.arange(0.0, 300.0, 0.1)])
    # 2 deg/s over the ground, by up to 8/(8 - 3) as much through the air, in 0.1 s.
    assert np.abs(np.diff(axis)).max() < math.radians(0.2 * 8.0 / 5.0) * 1.01
    assert axis[-1] - axis[0] == pytest.approx(2.0 * math.pi, abs=1e-9)
