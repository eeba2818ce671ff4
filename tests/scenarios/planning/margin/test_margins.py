"""The planned margin: formulas against simulated processes, and the spread against flights."""

import copy
import itertools
import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lfilter

from aircraft.fleet.x8 import X8
from aircraft.weather import low_altitude_turbulence
from common.physics import METRES_PER_FOOT
from gnc.airspeed import PaceHold, air_turn, design_speed_hold
from gnc.estimation.vessel import ReachableSet, VesselFilter, VesselReport, tube
from gnc.paper import Oscillation
from gnc.reference.reference import CirclingReference
from gnc.tracker import Tracker
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.gusts import GUSTS
from scenarios.planning.guidance import speed_hold, tracking_parameters
from scenarios.planning.limits import PLAN_PERIOD
from scenarios.planning.margin.keepout_margin import (
    GUARDED_PER_HOUR,
    STEERED_BY,
    filter_parameters,
    level_crossed,
    noise_allowance,
    planned_margin,
    position_scatter,
    steering_gains,
    vessel_limits,
    widest_tube,
)
from scenarios.planning.margin.tracking_spread import FREQUENCIES, gusts_on_orbit, tracking_spreads
from scenarios.planning.margin.turn_spread import displacement_sigma
from scenarios.planning.missions import plan_flight
from scenarios.scenario.files import load_study, with_values
from scenarios.vehicles.jsbsim import JsbsimVehicle
from scenarios.vehicles.sensors import NAVIGATION_TIME
from scenarios.vehicles.vehicle_setup import KINEMATIC_BANDWIDTH, kinematic_setup
from scenarios.world.ais.track import received_reports
from scenarios.world.vessel import SteadyVessel

MIDDLE = 2
LIGHT = low_altitude_turbulence(60.0, 7.717)  # 15 knots at 20 ft


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


@pytest.mark.slow
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


@pytest.mark.slow
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
        longitudinal = math.exp(-delay / time)
        lateral = longitudinal * (1.0 - 0.5 * delay / time)
        turned = 1.521 * (np.cos(theta + 0.3307 * delay) - np.cos(theta))
        expected = (
            LIGHT.horizontal**2 * 0.5 * (longitudinal + lateral) * float(np.mean(np.cos(turned)))
        )
        correlation = step * float(np.sum(found * np.cos(frequencies * delay))) / math.pi
        # Beyond 20 rad/s lies 2/pi (20 L/V)^-1 of a wave along, 1.5 times that of one across: 0.35
        # % of the variance.
        assert correlation == pytest.approx(expected, abs=5e-3 * LIGHT.horizontal**2)


@pytest.mark.slow
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
        aircraft, start, X8.envelope, north=reference.north, east=reference.east, altitude=60.0,
        course=reference.course, time_step=flight.time_step,
    )  # fmt: skip
    milspec = "atmosphere/turbulence/milspec"
    aircraft.fdm.write("atmosphere/randomseed", seed)
    aircraft.fdm.write("atmosphere/turb-type", 4)
    wind_fps = 10.0 * LIGHT.vertical / METRES_PER_FOOT
    aircraft.fdm.write(f"{milspec}/windspeed_at_20ft_AGL-fps", wind_fps)
    aircraft.fdm.write(f"{milspec}/severity", 3)
    law = PaceHold(speed=reference.speed, hold=hold)
    errors = []
    for _ in range(round(300.0 / flight.time_step)):
        north, east, v_north, v_east, rate = vehicle.motion()
        speed, course = math.hypot(v_north, v_east), math.atan2(v_east, v_north)
        airspeed = vehicle.sample()[1]
        reference = tracker.reference
        to_north, to_east = reference.north - north, reference.east - east
        cos, sin = math.cos(reference.course), math.sin(reference.course)
        along, across = to_north * cos + to_east * sin, to_east * cos - to_north * sin
        errors.append((along, across))
        turned = air_turn(rate, speed=airspeed, airspeed=speed)
        command = tracker.step(north, east, course, speed, turned)
        vehicle.advance(
            air_turn(command, speed=speed, airspeed=airspeed),
            law.airspeed(law.pace(along), SimpleNamespace(speed=speed, airspeed=airspeed), False),
        )
    # 30 s: three of the slowest gusts' times, to grow from smooth air.
    return np.array(errors[600:])


@pytest.mark.slow
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


SPEED, TURN_RATE = 19.42, 0.5
SIGMA, CORRELATED = 0.02, 2.0
"""Of a deviation of the course rate [rad/s, s]."""

STEP = 0.02


def spectrum(sigma):
    """Return the density of a process of exponential correlation, shape (frequencies, 1)."""
    return (2.0 * sigma**2 * CORRELATED / (1.0 + (FREQUENCIES * CORRELATED) ** 2))[:, None]


def simulated(sigma, count, steps, seed):
    """Return such processes at steps of 0.02 s, shape (count, steps)."""
    kept = math.exp(-STEP / CORRELATED)
    kicks = np.random.default_rng(seed).standard_normal((count, steps))
    kicks[:, 1:] *= math.sqrt(1.0 - kept**2)
    return sigma * lfilter([1.0], [1.0, -kept], kicks, axis=1)


@pytest.mark.parametrize(
    ("time", "by_speed", "by_rate"),
    [(1.0, 20.0, 1.0), (4.0, 0.0, 1.0), (9.0, 20.0, 0.0), (9.0, 20.0, 1.0)],
)
def test_the_deviation_is_that_of_simulated_turns(time, by_speed, by_rate):
    steps = round(time / STEP)
    gusts = simulated(SIGMA, 3000, steps, seed=20261128)
    course = STEP * np.cumsum(by_rate * gusts, axis=1)
    turned = TURN_RATE * STEP * (np.arange(steps) + 0.5)
    velocity = (SPEED + by_speed * gusts) * np.exp(1j * (turned + course))
    off = STEP * (velocity - SPEED * np.exp(1j * turned)).sum(axis=1)
    covariance = np.cov(off.real, off.imag)
    worst = math.sqrt(np.linalg.eigvalsh(covariance).max())
    response = np.ones((len(FREQUENCIES), 1), dtype=complex)
    found = displacement_sigma(
        time, by_speed * response, by_rate * response, spectrum(SIGMA), SPEED, TURN_RATE
    )
    # 3,000 deviations are known to 1.3 %; waves slower than 0.003 rad/s are left out.
    assert found == pytest.approx(worst, rel=0.05)


TOUCHES = 0.5
"""Declared [1/h]: often enough to be counted."""


def deviations(**values):
    """Return k of flights of a day, so long that it hardly matters how each begins."""
    values = {"following.touches_per_hour": TOUCHES, "flight.duration_max_s": 86_400.0} | values
    return vessel_limits(with_values(load_study("sea_wind"), values), 9.0).deviations


@pytest.mark.slow
def test_the_wandering_error_of_the_own_place_comes_to_exceed_it_no_oftener():
    generator, time_step, hours = np.random.default_rng(20261126), 0.25, 400.0
    kept = math.exp(-time_step / NAVIGATION_TIME)
    kicks = math.sqrt(1.0 - kept**2) * generator.standard_normal(
        (2, round(hours * 3600.0 / time_step))
    )
    beyond = np.hypot(*lfilter([1.0], [1.0, -kept], kicks)) > deviations(
        **{"sensors.position_sigma_m": 1.5}
    )
    begins = time_step * np.flatnonzero(beyond[1:] & ~beyond[:-1])
    # It crosses a level many times when it comes there: what begins within a time constant is one
    # event.
    events = 1 + np.count_nonzero(np.diff(begins) > NAVIGATION_TIME)
    # Some 150 are counted, to 8 %. The rate that k follows from is that of large k, too high for
    # such a small one.
    assert 0.5 * TOUCHES < events / hours < TOUCHES


@pytest.mark.slow
def test_errors_of_reports_exceed_it_at_some_age_no_oftener():
    k = deviations(**{"reports.interval_s": [6.0, 6.0]})
    place, velocity = np.random.default_rng(20261126).standard_normal((2, 2, 1_000_000))
    # As a report ages, its error goes from place to velocity: place cos(angle) + velocity
    # sin(angle), over a quarter of a circle.
    squares = np.sum(place**2, axis=0), np.sum(velocity**2, axis=0)
    both = np.sum(place * velocity, axis=0)
    within = 0.5 * (squares[0] + squares[1]) + np.hypot(0.5 * (squares[0] - squares[1]), both)
    largest = np.where(both > 0.0, within, np.maximum(*squares))
    per_hour = 600.0 * float(np.mean(largest > k * k))
    # Some 800 are counted, to 3.5 %.
    assert per_hour == pytest.approx(TOUCHES, rel=0.12)


TURN = 6.7
"""Duration of a turn away of the X8 [s]."""


def reaches(scenario, limits, hours):
    """Return how far north of the vessel's estimated place its discs reach, just before each report
    [m].
    """
    received = received_reports(
        scenario.reports,
        SteadyVessel(7.0, 0.0),
        duration=3600.0 * hours,
        outages=(),
        generator=np.random.default_rng(3),
    )
    known, reach = VesselFilter(filter_parameters(scenario.reports)), ReachableSet(limits)
    found = []
    for (_, report), (until, _) in itertools.pairwise(received):
        known.report(report)
        reach.report(report)
        taken = known.at(until)
        north = taken.north + TURN * taken.velocity_north
        discs = reach.tubes(until)
        reached = [of.north + TURN * of.velocity_north + of.reach(TURN) for of in discs]
        found.append(min(reached) - north)
    # With the first reports the filter knows less.
    return np.array(found[12:])


@pytest.mark.slow
@pytest.mark.parametrize("acceleration", [0.0, 0.25])
def test_discs_reach_farther_than_planned_as_often_as_is_allowed(acceleration):
    # Reports as by AIS, of a ship that keeps its course and speed.
    given = {"reports.interval_s": [2.0, 10.0], "reports.latency_max_s": 2.0}
    given |= {"following.vessel_acceleration_mps2": acceleration}
    scenario, hours = with_values(load_study("sea_wind"), given), 12.0
    limits = vessel_limits(scenario, TURN)
    disc = tube(VesselReport(-PLAN_PERIOD - 10.0 - 2.0, 0.0, 0.0, 0.0, 0.0), limits, 0.0)
    widest = widest_tube(limits, scenario.reports, plan_period=PLAN_PERIOD)
    found = reaches(scenario, limits, hours)
    # 12 are expected at most; of a Poisson variable of that mean one in a thousand is above 24.
    assert np.count_nonzero(found > widest.reach(TURN)) <= 2.0 * hours * GUARDED_PER_HOUR
    # The disc of a report that is as old as it becomes is not enough.
    assert np.count_nonzero(found > disc.reach(TURN)) > 3.0 * hours * GUARDED_PER_HOUR


KINEMATIC = {"fidelity": "kinematic", "kinematic.heading_rate_lag_s": 0.4}
MINUTES = 40.0


def seen_errors(tracking, hold, turn, speed, lag):
    """Return errors along and right that a vehicle sees whose position has noise of 1 m, on a
    circle, over time [m].
    """
    step, noise, course, rate, faster = tracking.time_step, np.zeros(2), 0.0, turn, 0.0
    tracker = Tracker(tracking, CirclingReference(speed=speed, heading_rate=turn, time_step=step))
    north, east, found = 0.0, 0.0, []
    rates = (1.0 / NAVIGATION_TIME, 1.0 / lag, KINEMATIC_BANDWIDTH)
    kept, answered, sped = (math.exp(-step * of) for of in rates)
    generator = np.random.default_rng(1)
    kicks = math.sqrt(1.0 - kept**2) * generator.standard_normal((round(60.0 * MINUTES / step), 2))
    for kick in kicks.tolist():
        noise = kept * noise + kick
        at_north, at_east = north + float(noise[0]), east + float(noise[1])
        cos, sin = math.cos(tracker.reference.course), math.sin(tracker.reference.course)
        off_north, off_east = tracker.reference.north - at_north, tracker.reference.east - at_east
        found.append((off_north * cos + off_east * sin, off_east * cos - off_north * sin))
        heading = math.remainder(course, 2.0 * math.pi)
        command = tracker.step(at_north, at_east, heading, speed + faster, rate)
        then = answered * rate + (1.0 - answered) * command
        middle = course + 0.25 * (rate + then) * step
        north += (speed + faster) * math.cos(middle) * step
        east += (speed + faster) * math.sin(middle) * step
        course += 0.5 * (rate + then) * step
        rate, faster = then, faster + (1.0 - sped) * (hold.gain * found[-1][0] - faster)
    return np.array(found[round(60.0 / step) :])


@pytest.mark.slow
def test_the_error_that_a_vehicle_sees_scatters_as_predicted():
    turn = 0.3
    scenario = with_values(load_study("sea_wind"), KINEMATIC)
    setup, speed = kinematic_setup(scenario), scenario.guidance.airspeed_mps
    tracking, hold = tracking_parameters(scenario, setup), speed_hold(scenario, setup)
    how = {"speed": speed, "lag": setup.lag, "airspeed_bandwidth": KINEMATIC_BANDWIDTH}
    predicted = position_scatter(tracking, hold, [turn], **how, noise_time=NAVIGATION_TIME)
    found = seen_errors(tracking, hold, turn, speed, setup.lag)
    # 40 minutes are some 500 time constants of the loop, 4 to 5 s: one deviation of the deviation
    # is 3 %.
    assert math.sqrt(np.linalg.eigvalsh(np.cov(found.T)).max()) == pytest.approx(predicted, rel=0.1)
    assert 0.2 < predicted < 0.4


@pytest.mark.slow
def test_the_allowance_is_exceeded_no_oftener_than_allowed():
    # The probability that a normal error exceeds it, times the steps of an hour at 20 Hz.
    deviations = noise_allowance(0.3, 0.4, time_step=0.05) / 0.5
    assert 72_000.0 * 0.5 * math.erfc(deviations / math.sqrt(2.0)) < GUARDED_PER_HOUR
