"""The world that a scenario describes: winds, gusts, faults, the vessel, and the plume's true axis."""

import contextlib
import math

import numpy as np
import pytest
from flight_cases import scenario

from aircraft.wind import constant_wind
from gnc.errors import InfeasibleError
from scenarios.scenario.sections.equipment import FaultConfig
from scenarios.scenario.sections.world import PlumeConfig, VesselConfig
from scenarios.world.faults import SATELLITES, VESSEL_DATA, in_order, sampled_fault
from scenarios.world.plume import StraightPlume
from scenarios.world.vessel import (
    ManoeuvringVessel,
    SteadyVessel,
    check_manoeuvres,
    given_place,
    largest_inconsistency,
)
from scenarios.world.wind import sampled_weather, wind_of
from scenarios.world.world import apparent_wind, plume_of, vessel_of

EAST_WIND = {"vessel": {"speed_mps": 6.0}, "wind": {"speed_mps": 6.0, "from_deg": 270.0}}


def test_the_apparent_wind_is_the_vessels_speed_through_the_air():
    def found(**changes):
        given = scenario(**changes)
        wind = apparent_wind(given, vessel_of(given))
        return wind.at_start, wind.least, wind.greatest

    # North at 6 m/s in a wind to the east at 6 m/s; and from 8 m/s to rest.
    assert found(**EAST_WIND) == pytest.approx([math.hypot(6.0, 6.0)] * 3, abs=1e-12)
    stop = {"at_s": 10.0, "speed_mps": 0.0, "acceleration_mps2": 0.5}
    stopping = found(vessel={"speed_mps": 8.0, "manoeuvres": [stop]})
    assert stopping == pytest.approx((8.0, 0.0, 8.0), abs=1e-12)


@pytest.mark.parametrize(
    ("direction", "degrees"), [(None, 135.0), ("apparent_wind", 135.0), ("given", 180.0)]
)
def test_the_plume_of_a_vessel_that_is_followed_trails_by_the_wind_unless_it_is_given(
    direction, degrees
):
    given = scenario(**EAST_WIND, plume={"direction": direction})
    axis = plume_of(given, vessel_of(given)).axis(0.0)
    assert math.remainder(axis - math.radians(degrees), math.tau) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("roughness", [1e-8, 2e-4, 1.0])
def test_a_wind_with_a_profile_is_the_one_given_at_its_height_for_any_roughness(roughness):
    profile = {"roughness_m": roughness, "height_m": 20.0}
    given = scenario(wind={"speed_mps": 10.0, "from_deg": 180.0} | profile)
    field = wind_of(given, given_place(given.place, 60.0))
    # Rounding of logarithms; and V(z) = V(h) ln(z/z0)/ln(h/z0).
    assert field.now(0.0, 20.0) == pytest.approx((10.0, 0.0), abs=1e-12)
    speed = 10.0 * math.log(60.0 / roughness) / math.log(20.0 / roughness)
    assert field.now(0.0, 60.0)[0] == pytest.approx(speed, rel=1e-12)


def test_gusts_come_one_after_the_other_and_are_no_stronger_than_they_may():
    turbulence = {"gusts": 5, "gust_speed_mps": 8.0, "gust_length_s": 4.0}
    flight = {"duration_max_s": 500.0}
    given = scenario(fidelity="six_dof", turbulence=turbulence, flight=flight)
    wind = wind_of(given, given_place(given.place, 60.0))
    weather = sampled_weather(given, wind, np.random.default_rng(9))
    assert len(weather.gusts) == 5
    for i, gust in enumerate(weather.gusts):
        # A hundred seconds for each, of which it takes four to rise and four to fall.
        assert 100.0 * i <= gust.start
        assert gust.start + gust.rise + gust.fall <= 100.0 * (i + 1)
        assert 4.0 <= math.hypot(*gust.velocity_ned) <= 8.0
        assert gust.velocity_ned[2] == 0.0
    assert weather.turbulence is None


@pytest.mark.parametrize(("kind", "lasts"), [(VESSEL_DATA, 60.0), (SATELLITES, 10.0)])
def test_a_passing_fault_lasts_from_its_beginning_to_its_end(kind, lasts):
    fault = sampled_fault(FaultConfig(kind=kind, at_s=(100.0, 250.0)), np.random.default_rng(9))
    assert 100.0 <= fault.begins <= 250.0
    assert fault.ends == fault.begins + lasts
    assert not fault.of_aircraft()
    faults = in_order([fault])
    times = (fault.begins - 0.01, fault.begins, fault.ends - 0.01, fault.ends)
    assert [faults.lasts(kind, time) for time in times] == [False, True, True, False]
    assert not faults.lasts(SATELLITES if kind == VESSEL_DATA else VESSEL_DATA, fault.begins)


DURATION = 600.0


def behind(vessel, wind, heading_deg=None):
    """Return the plume behind a vessel; by the wind, or at an angle from its bow."""
    by_wind = heading_deg is None
    config = PlumeConfig() if by_wind else PlumeConfig(heading_deg=heading_deg)
    return StraightPlume(config, vessel, constant_wind(*wind), DURATION, by_wind=by_wind)


def test_the_plume_trails_behind_the_motion_through_the_air():
    # Course north at 6 m/s in a wind to the east at 6 m/s: through the air it goes north-west, and
    # the smoke south-east.
    steady = SteadyVessel(6.0, 0.0)
    axis = behind(steady, (0.0, 6.0)).axis(10.0)
    assert math.remainder(axis - 0.75 * math.pi, math.tau) == pytest.approx(0.0, abs=1e-12)
    # A given plume keeps its angle from the bow, whatever the wind.
    plume = behind(SteadyVessel(8.0, math.radians(30.0)), (5.0, 5.0), heading_deg=150.0)
    assert plume.axis(0.0) == plume.axis(500.0) == pytest.approx(math.pi, rel=1e-15)


def test_the_plumes_course_never_jumps_where_its_angle_is_wrapped():
    # Behind a vessel that turns right round, seen from the air: a full turn in all.
    turn = {"at_s": 10.0, "turn_deg": 360.0, "turn_rate_deg_s": 2.0}
    config = VesselConfig.model_validate({"speed_mps": 8.0, "manoeuvres": [turn]})
    plume = behind(ManoeuvringVessel(config, 8.0, DURATION), (3.0, 0.0))
    axis = np.array([plume.axis(t) for t in np.arange(0.0, 300.0, 0.1)])
    # 2 deg/s over the ground, by up to 8/(8 - 3) as much through the air, in 0.1 s.
    assert np.abs(np.diff(axis)).max() < math.radians(0.2 * 8.0 / 5.0) * 1.01
    assert axis[-1] - axis[0] == pytest.approx(2.0 * math.pi, abs=1e-9)


def track(vessel, duration=600.0):
    """Return the vessel of a ``[vessel]`` section."""
    config = VesselConfig.model_validate(vessel)
    return ManoeuvringVessel(config, config.speed_mps, duration)


def test_a_steady_turn_is_a_circle():
    # From north, to the right, all the way round at 1 deg/s: radius 8/0.01745 m, centred to
    # starboard.
    turn = {"at_s": 0.0, "turn_deg": 360.0, "turn_rate_deg_s": 1.0}
    vessel = track({"speed_mps": 8.0, "manoeuvres": [turn]}, 400.0)
    rate = math.radians(1.0)
    radius = 8.0 / rate
    for time in (0.0, 33.33, 90.0, 200.017, 360.0):
        angle = rate * time
        north, east, v_north, v_east = vessel.motion(time)
        # The trapezoidal rule over 0.05 s: h^2/12 of the acceleration's change, 0.28 m/s^2 at most,
        # 6e-5 m.
        place = radius * math.sin(angle), radius * (1.0 - math.cos(angle))
        assert (north, east) == pytest.approx(place, abs=1e-4)
        # Velocity linear in between: h^2/8 of 8 rate^2, 8e-7 m/s.
        velocity = 8.0 * math.cos(angle), 8.0 * math.sin(angle)
        assert (v_north, v_east) == pytest.approx(velocity, abs=1e-6)
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
        faster = 0.5 * accelerating**2 + takes * (since - accelerating)
        way = 400.0 + 8.0 * since + sign * faster
        # The trapezoidal rule is exact but for the two corners, which lie on points of the table.
        assert vessel.motion(50.0 + since)[1] == pytest.approx(way, abs=1e-6)
    assert vessel.motion(50.0 + takes + 1.0)[3] == pytest.approx(end, abs=1e-12)


@pytest.mark.parametrize(
    ("second", "words"),
    [
        ({"at_s": 99.0, "turn_deg": 90.0}, "begins at 99 s, before an earlier one has ended, at"),
        # From 11 m/s, which the first one ends with, not from 8.
        ({"at_s": 195.0, "speed_mps": 8.0}, None),
        ({"at_s": 190.0, "turn_deg": -90.0}, None),
    ],
)
def test_manoeuvres_that_overlap_are_refused(second, words):
    first = {"at_s": 10.0, "turn_deg": 90.0, "turn_rate_deg_s": 0.5, "speed_mps": 11.0}
    config = VesselConfig.model_validate({"speed_mps": 8.0, "manoeuvres": [first, second]})
    with pytest.raises(InfeasibleError, match=words) if words else contextlib.nullcontext():
        check_manoeuvres(config, config.speed_mps)


class Weaving:
    """A track whose places are the integral of its velocity, and drift off by ``drift`` [m/s]
    besides.
    """

    manoeuvres_end = math.nan

    def __init__(self, drift):
        self.drift = drift

    def motion(self, time):
        east = 40.0 * (1.0 - math.cos(0.05 * time))
        north = 8.0 * time + self.drift * max(0.0, time - 100.0)
        return north, east, 8.0, 2.0 * math.sin(0.05 * time)

    def course(self, _time):
        return 0.0


def test_places_that_do_not_follow_from_the_velocity_are_noticed():
    assert largest_inconsistency(Weaving(0.0), 200.0) < 1e-4
    # 0.02 m/s for 100 s, and the 0.1 s that a track goes on beyond its duration.
    assert largest_inconsistency(Weaving(-0.02), 200.0) == pytest.approx(2.0, abs=3e-3)
    # As long as the flight does not last until then, nothing shows.
    assert largest_inconsistency(Weaving(-0.02), 90.0) < 1e-4
    assert largest_inconsistency(track({"speed_mps": 8.0}), 200.0) == 0.0
