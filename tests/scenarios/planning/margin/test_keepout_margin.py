"""The planned margin: Rice's formula against a simulated process, the loop against hand
calculation, the spread against flights.
"""

import copy
import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from aircraft.fleet.x8 import X8
from aircraft.weather import low_altitude_turbulence
from common.physics import METRES_PER_FOOT
from gnc.airspeed import PaceHold, air_turn, design_speed_hold
from gnc.paper import Oscillation
from gnc.tracker import Tracker
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.gusts import GUSTS
from scenarios.planning.margin.keepout_margin import (
    STEERED_BY,
    Spread,
    beyond_limits,
    level_crossed,
    planned_margin,
    steering_gains,
)
from scenarios.planning.margin.tracking_spread import (
    gusts_on_orbit,
    tracking_spreads,
)
from scenarios.planning.missions import plan_flight
from scenarios.scenario.files import load_study, with_values
from scenarios.vehicles.jsbsim import JsbsimVehicle
from scenarios.vehicles.vehicle_setup import kinematic_setup

pytestmark = pytest.mark.slow

MIDDLE = 2
LIGHT = low_altitude_turbulence(60.0, 7.717)  # 15 knots at 20 ft
SPREAD = Spread(
    along=0.4,
    across=0.3,
    radial=0.5,
    radial_rate=0.35,
    airspeed=1.2,
    airspeed_rate=0.7,
    airspeed_limit=4.4,
)


def plan(**guidance):
    """Return the plan of a flight at nu = 0.5 of a vehicle with a lag of 0.4 s, half a step of the
    guidance among them.
    """
    values = {"vessel.speed_ratio": 0.5, "guidance.keepout_guard": False}
    scenario = with_values(
        load_study("sweep_nu"),
        values | {f"guidance.{key}": value for key, value in guidance.items()},
    )
    setup = replace(kinematic_setup(scenario), lag=0.375)
    return plan_flight(scenario, flight_id="x", seed=1, setup=setup)


def test_a_gaussian_process_goes_above_a_level_as_often_as_rice_says():
    # A sum of 400 sinusoids of random phase is as good as Gaussian up to 2 sigma; the square of its
    # rate's deviation is the mean square of its frequencies.
    generator = np.random.default_rng(7)
    frequencies = generator.uniform(0.5, 3.0, 400)
    phases = generator.uniform(0.0, 2.0 * math.pi, 400)
    time = np.arange(0.0, 4000.0, 0.05)
    process = sum(
        math.sqrt(2.0 / 400) * np.cos(w * time + phase)
        for w, phase in zip(frequencies, phases, strict=True)
    )
    rate = math.sqrt(float(np.mean(frequencies**2)))
    for level in (0.5, 1.0, 1.5):
        counted = (
            np.count_nonzero((process[:-1] < level) & (process[1:] >= level)) * 3600.0 / time[-1]
        )
        per_hour = 3600.0 * rate / (2.0 * math.pi) * math.exp(-0.5 * level**2)
        # About 1100, 750 and 400 crossings are counted; clustered ones make their spread 1.5 times
        # that of independent ones: 5, 6 and 8 %, and three times that is let pass for the least.
        assert counted == pytest.approx(per_hour, rel=0.15)
        assert level_crossed(1.0, rate, per_hour) == pytest.approx(level, rel=1e-9)


def test_the_margin_grows_with_the_spread_and_with_care():
    margin = planned_margin(SPREAD, touches_per_hour=1e-3)
    # With deviation and rate alike the part by tracking grows in proportion, that by limits not at
    # all.
    tracking = margin - beyond_limits(SPREAD, 1e-3)
    wider = replace(SPREAD, radial=1.3, radial_rate=0.91)
    assert planned_margin(wider, touches_per_hour=1e-3) - margin == pytest.approx(
        1.6 * tracking, rel=1e-9
    )
    assert (
        planned_margin(SPREAD, touches_per_hour=1e-4)
        > margin
        > planned_margin(SPREAD, touches_per_hour=1e-2)
    )


def test_gusts_on_an_orbit_vary_as_the_course_makes_them():
    oscillation = Oscillation(nu=0.5, speed=19.42, eta=1.521, omega_0=0.3307, limit="heading rate")
    step = 0.01  # of rad/s, against corners of 0.09
    frequencies = step * (np.arange(2000) + 0.5)
    found = gusts_on_orbit(LIGHT, oscillation, frequencies, airspeed=19.42, span=2.1)[
        :, GUSTS.index("gust_along")
    ]
    theta = np.linspace(0.0, 2.0 * math.pi, 721)[:-1]
    time = LIGHT.horizontal_length / 19.42
    for delay in (0.0, 1.0, 4.75, 9.5):
        # Of a frozen field: MIL-F-8785C's correlations along and across a wave, and the mean cosine
        # of the course between.
        longitudinal, lateral = (
            math.exp(-delay / time),
            math.exp(-delay / time) * (1.0 - 0.5 * delay / time),
        )
        turned = 1.521 * (np.cos(theta + 0.3307 * delay) - np.cos(theta))
        expected = (
            LIGHT.horizontal**2 * 0.5 * (longitudinal + lateral) * float(np.mean(np.cos(turned)))
        )
        correlation = step * float(np.sum(found * np.cos(frequencies * delay))) / math.pi
        # Beyond 20 rad/s lies 2/pi (20 L/V)^-1 of a wave along, 1.5 times that of one across: 0.35
        # % of the variance.
        assert correlation == pytest.approx(expected, abs=5e-3 * LIGHT.horizontal**2)


def test_without_preview_steering_is_the_law_linearised_by_hand():
    tracking = plan(preview=False).guidance.tracking
    speed, radius, gain = 19.42, tracking.law.look_ahead_m, tracking.law.gain_per_s
    found = dict(zip(STEERED_BY, steering_gains(tracking, 0.0, speed), strict=True))
    # Laws (30) and (18) about a straight line, delta = rho = R: omega = -k (chi - e/R) - V chi/R,
    # with e the reference's offset to the right. Differences of 1e-5 are good to 1e-6.
    assert found["right"] == pytest.approx(gain / radius, rel=1e-5)
    assert found["course"] == pytest.approx(-gain - speed / radius, rel=1e-5)
    for name in ("along", "speed", "airspeed", "heading_rate", "last"):
        assert found[name] == pytest.approx(0.0, abs=1e-5), name


def fly_in_turbulence(root, start, flight, hold, seed):
    """Errors along and across [m], settled, at 20 Hz, of a flight that starts on its reference."""
    aircraft = AutopilotedAircraft(X8, root)
    tracker = Tracker(flight.guidance.tracking, copy.copy(flight.guidance.mission.reference))
    reference = tracker.reference
    vehicle = JsbsimVehicle(
        aircraft, start, X8.envelope, north=reference.north, east=reference.east, altitude=60.0, course=reference.course,
        time_step=flight.time_step,
    )  # fmt: skip
    milspec = "atmosphere/turbulence/milspec"
    aircraft.fdm.write("atmosphere/randomseed", seed)
    aircraft.fdm.write("atmosphere/turb-type", 4)
    aircraft.fdm.write(
        f"{milspec}/windspeed_at_20ft_AGL-fps", 10.0 * LIGHT.vertical / METRES_PER_FOOT
    )
    aircraft.fdm.write(f"{milspec}/severity", 3)
    law = PaceHold(speed=reference.speed, hold=hold)
    errors = []
    for _ in range(round(300.0 / flight.time_step)):
        north, east, v_north, v_east, rate = vehicle.motion()
        speed, airspeed, course = (
            math.hypot(v_north, v_east),
            vehicle.sample()[1],
            math.atan2(v_east, v_north),
        )
        reference = tracker.reference
        to_north, to_east = reference.north - north, reference.east - east
        cos, sin = math.cos(reference.course), math.sin(reference.course)
        along, across = to_north * cos + to_east * sin, to_east * cos - to_north * sin
        errors.append((along, across))
        command = tracker.step(
            north, east, course, speed, air_turn(rate, speed=airspeed, airspeed=speed)
        )
        vehicle.advance(
            air_turn(command, speed=speed, airspeed=airspeed),
            law.airspeed(law.pace(along), SimpleNamespace(speed=speed, airspeed=airspeed), False),
        )
    return np.array(
        errors[600:]
    )  # 30 s: three of the slowest gusts' times, to grow from smooth air


def test_light_turbulence_spreads_flights_as_predicted_and_the_margin_holds_them(
    x8_design, x8_root
):
    schedule = x8_design.schedule
    start = schedule.level(MIDDLE)  # of 20 m/s, near enough to be settled after 30 s
    # A reserve that leaves no command at its limit, which the linear model does not have.
    flight = plan(reserve=0.15)
    hold = design_speed_hold(
        bandwidth=x8_design.bandwidths.airspeed,
        speed=flight.guidance.speed,
        look_ahead=flight.guidance.tracking.law.look_ahead_m,
        airspeed_min=X8.envelope.airspeed_min,
        airspeed_max=X8.envelope.airspeed_max,
    )
    (spread,) = tracking_spreads(
        schedule, LIGHT, [flight.oscillation], flight.guidance.tracking, hold, span=2.1
    )
    errors = np.vstack(
        [fly_in_turbulence(x8_root, start, flight, hold, seed) for seed in range(1, 5)]
    )
    along, across = np.sqrt(np.mean(errors**2, axis=0))
    # 18 minutes of errors that last 5 s are 200 independent ones: 5 % of their deviation, 15 %
    # three times over. Thirty flights measure 9 % and 3 % more than predicted, for the turn and its
    # model are taken as steady.
    assert along == pytest.approx(spread.along, rel=0.25)
    assert across == pytest.approx(spread.across, rel=0.25)
    # Tracking of 3 m rms in light turbulence is what the study requires.
    assert math.hypot(along, across) <= 3.0
    # Passed in 18 minutes with a chance of 3 in 10,000, if it is an upper bound as it says;
    # measured 1.5 m of 5.6 m.
    assert np.hypot(*errors.T).max() < planned_margin(spread, touches_per_hour=1e-3)
