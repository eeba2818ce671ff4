"""The vessel's true motion."""

import math

import pytest

from gnc.errors import InfeasibleError
from scenarios.scenario.sections.world import VesselConfig
from scenarios.world.vessel import (
    ManoeuvringVessel,
    check_manoeuvres,
    largest_inconsistency,
)


def track(vessel, duration=600.0):
    """Return the vessel of a ``[vessel]`` section."""
    config = VesselConfig.model_validate(vessel)
    return ManoeuvringVessel(config, config.speed_mps, duration)


def test_a_steady_turn_is_a_circle():
    # From north, to the right, all the way round at 1 deg/s: radius 8/0.01745 m, centred to
    # starboard.
    vessel = track(
        {
            "speed_mps": 8.0,
            "manoeuvres": [{"at_s": 0.0, "turn_deg": 360.0, "turn_rate_deg_s": 1.0}],
        },
        400.0,
    )
    rate = math.radians(1.0)
    radius = 8.0 / rate
    for time in (0.0, 33.33, 90.0, 200.017, 360.0):
        angle = rate * time
        north, east, v_north, v_east = vessel.motion(time)
        # The trapezoidal rule over 0.05 s: h^2/12 of the acceleration's change, 0.28 m/s^2 at most,
        # 6e-5 m.
        assert (north, east) == pytest.approx(
            (radius * math.sin(angle), radius * (1.0 - math.cos(angle))), abs=1e-4
        )
        # Velocity linear in between: h^2/8 of 8 rate^2, 8e-7 m/s.
        assert (v_north, v_east) == pytest.approx(
            (8.0 * math.cos(angle), 8.0 * math.sin(angle)), abs=1e-6
        )
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
        way = (
            400.0
            + 8.0 * since
            + 0.5 * sign * accelerating**2
            + sign * takes * (since - accelerating)
        )
        # The trapezoidal rule is exact but for the two corners, which lie on points of the table.
        assert vessel.motion(50.0 + since)[1] == pytest.approx(way, abs=1e-6)
    assert vessel.motion(50.0 + takes + 1.0)[3] == pytest.approx(end, abs=1e-12)


@pytest.mark.parametrize(
    ("second", "words"),
    [
        (
            {"at_s": 99.0, "turn_deg": 90.0},
            "begins at 99 s, before an earlier one has ended, at 190 s",
        ),
        # From 11 m/s, which the first one ends with, not from 8.
        ({"at_s": 195.0, "speed_mps": 8.0}, None),
        ({"at_s": 190.0, "turn_deg": -90.0}, None),
    ],
)
def test_manoeuvres_that_overlap_are_refused(second, words):
    first = {"at_s": 10.0, "turn_deg": 90.0, "turn_rate_deg_s": 0.5, "speed_mps": 11.0}
    config = VesselConfig.model_validate({"speed_mps": 8.0, "manoeuvres": [first, second]})
    if words is None:
        check_manoeuvres(config, config.speed_mps)
        return
    with pytest.raises(InfeasibleError, match=words):
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
        return (
            8.0 * time + self.drift * max(0.0, time - 100.0),
            east,
            8.0,
            2.0 * math.sin(0.05 * time),
        )

    def course(self, _time):
        return 0.0


def test_places_that_do_not_follow_from_the_velocity_are_noticed():
    assert largest_inconsistency(Weaving(0.0), 200.0) < 1e-4
    # 0.02 m/s for 100 s, and the 0.1 s that a track goes on beyond its duration.
    assert largest_inconsistency(Weaving(-0.02), 200.0) == pytest.approx(2.0, abs=3e-3)
    # As long as the flight does not last until then, nothing shows.
    assert largest_inconsistency(Weaving(-0.02), 90.0) < 1e-4
    assert largest_inconsistency(track({"speed_mps": 8.0}), 200.0) == 0.0
