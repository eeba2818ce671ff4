"""Vehicles behind the closed loop, and what their sensors read."""

import math
from dataclasses import replace

import numpy as np
import pytest
from flight_cases import plan

from aircraft.fdm import Fdm
from aircraft.fleet.x8 import X8
from aircraft.trim import trim
from aircraft.weather import Weather
from aircraft.wind import WindField, constant_wind
from gnc.estimation.health import CHECK_INTERVAL, STUCK
from gnc.estimation.navigation import MeasuredMotion
from gnc.guidance import Guidance
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.flight.turn_reversal import TurnReversalResponse
from scenarios.experiment.requests import Experiment
from scenarios.scenario.files import load_study
from scenarios.scenario.sections.equipment import SensorsConfig
from scenarios.vehicles.jsbsim import JsbsimVehicle
from scenarios.vehicles.kinematic import KinematicVehicle
from scenarios.vehicles.sensors import SensorErrors
from scenarios.vehicles.vehicle_setup import VehicleSetup, _slower_turns, kinematic_setup

SPEED = 19.42


def make(lag=0.0, time_step=0.05, **wind):
    place = {"north": 10.0, "east": -20.0, "altitude": 60.0, "course": 0.5, "speed": SPEED}
    return KinematicVehicle(**place, time_step=time_step, lag=lag, **wind)


def test_it_flies_a_circle_of_speed_over_heading_rate():
    vehicle = make(time_step=2.0 * math.pi / 0.3 / 400)
    places = []
    for _ in range(400):
        vehicle.advance(0.3, SPEED)
        places.append(vehicle.motion()[:2])
    centre = np.mean(places, axis=0)
    radius = np.hypot(*(np.array(places) - centre).T)
    # Equation (1) at a constant heading rate: a circle of radius v/omega, closed after 2 pi/omega.
    # Roundings of 400 steps.
    assert radius == pytest.approx(np.full(400, SPEED / 0.3), rel=1e-10)
    assert places[-1] == pytest.approx((10.0, -20.0), abs=1e-9)


@pytest.mark.parametrize("lag", [0.0, 0.3])
def test_in_wind_it_flies_the_calm_path_carried_along(lag):
    calm, windy = make(lag), make(lag, wind=constant_wind(-6.0, 2.5))
    for _ in range(200):
        calm.advance(0.3, SPEED)
        windy.advance(0.3, SPEED)
    # 200 steps of 0.05 s in a wind of (-6, 2.5) m/s; roundings of 200 sums.
    difference = np.subtract(windy.motion(), calm.motion())
    assert difference == pytest.approx([-60.0, 25.0, -6.0, 2.5, 0.0], abs=1e-9)
    assert windy.air_data() == calm.air_data()


def test_in_a_wind_that_changes_it_is_carried_by_what_blows_at_its_time_and_height():
    # From rest to 10 m/s northward within 10 s, and twice that at twice the height of 50 m.
    blown = [[[0.0, 0.0], [0.0, 0.0]], [[10.0, 0.0], [20.0, 0.0]]]
    wind = WindField(blown, times=(0.0, 10.0), heights=(50.0, 100.0))
    for height, speed in ((50.0, 10.0), (100.0, 20.0)):
        still, windy = make(), make(wind=wind)
        windy.command_altitude(height)
        for _ in range(200):
            still.advance(0.3, SPEED)
            windy.advance(0.3, SPEED)
        # Velocity is held for a step of 0.05 s: the sum lags half a step behind the integral, 0.25
        # m at most.
        off_north, off_east, faster, *_ = np.subtract(windy.motion(), still.motion())
        assert (off_north, off_east) == pytest.approx((0.5 * speed * 10.0, 0.0), abs=0.6)
        assert faster == pytest.approx(speed, rel=1e-9)


def test_the_guidance_is_the_same_for_both_vehicles():
    # Fidelity does not enter the plan: the same start and the same guidance, but for the lag, which
    # is measured.
    plans = []
    for fidelity in ("kinematic", "six_dof"):
        study = load_study("sim3", [f"fidelity={fidelity}"])
        given = Experiment("sim3", study).request(0).scenario
        plans.append(plan(given, seed=7, setup=kinematic_setup(given)))
    assert plans[0].start == plans[1].start
    # References are equal if they move alike.
    assert replace(plans[0].guidance, mission=None) == replace(plans[1].guidance, mission=None)
    commands = []
    for one in plans:
        guidance = Guidance(one.guidance)
        for step in range(100):
            guidance.step(step * one.time_step, (-400.0, 30.0, 18.5, 5.7, 0.1))
        commands.append((guidance.heading_rate_command, guidance.airspeed_command))
    assert commands[0] == commands[1]


MIDDLE = 2
WIND = (4.0, -9.0)


@pytest.fixture
def place(x8_schedule, x8_root):
    """A function from a weather to the X8 at (10, -20) m with an air-relative course of 0.7 rad."""

    def make(weather, *, time_step=0.05, **how):
        place = {"north": 10.0, "east": -20.0, "altitude": 60.0, "course": 0.7}
        aircraft = AutopilotedAircraft(X8, x8_root, **how)
        level = x8_schedule.level(MIDDLE)
        more = {"time_step": time_step, "weather": weather}
        return JsbsimVehicle(aircraft, level, X8.envelope, **place, **more)

    return make


def test_it_starts_with_its_course_against_the_air_and_the_wind_on_top(place, x8_schedule):
    airspeed = x8_schedule.level(MIDDLE).airspeed
    north, east, v_north, v_east, _ = place(Weather(wind=constant_wind(*WIND))).motion()
    # Of plumes and tracks of hundreds of metres.
    assert (north, east) == pytest.approx((10.0, -20.0), abs=0.1)
    ground = (airspeed * math.cos(0.7) + WIND[0], airspeed * math.sin(0.7) + WIND[1])
    # 1e-6 ft/s of north wind, and a globe's roundings.
    assert (v_north, v_east) == pytest.approx(ground, abs=1e-5)


def test_it_climbs_and_sinks_to_a_commanded_altitude(place):
    vehicle = place(None)
    vehicle.command_altitude(65.0)
    for _ in range(400):
        vehicle.advance(0.0, 20.0)
    # 20 s, of a loop that settles within 10 (its design's record).
    assert vehicle.sample()[0] == pytest.approx(65.0, abs=0.1)


@pytest.mark.parametrize("rate_hz", [5.0, 8.0, 40.0])
def test_sound_elevons_are_where_they_were_commanded_to_be_however_slow_the_guidance_is(
    place, rate_hz
):
    flown = place(None, time_step=1.0 / rate_hz, failable=True)
    generator = np.random.default_rng(1)

    def errors(seconds, turns=(-0.5, 0.5)):
        # Hard over at random, and up and down: commands of the elevons come and go between two
        # steps of the guidance.
        for second in range(seconds):
            flown.command_altitude(68.0 if second % 2 else 52.0)
            for _ in range(round(rate_hz)):
                yield flown.servo_error()
                flown.advance(float(generator.choice(turns)), 18.0 if second % 3 else 22.0)

    # Those that the monitor of the vehicle's health looks at.
    looks = slice(None, None, max(1, round(CHECK_INTERVAL * rate_hz)))
    assert max(list(errors(30))[looks]) < STUCK
    flown.fail("left_elevon")
    assert max(list(errors(2, turns=(0.5,)))[looks]) > STUCK


@pytest.mark.parametrize("heading_rate", [0.45, 0.505, 0.58])
def test_the_slower_turn_at_the_largest_bank_is_as_fast_as_is_said_and_hardly_faster(
    x8_schedule, heading_rate
):
    setup = VehicleSetup(
        lag=0.4, reversal=TurnReversalResponse(delay=0.26, lag=0.26), response_error=3.0,
        airspeed_bandwidth=1.0, airspeed_min=15.0, airspeed_max=25.0,
        turn_airspeeds=tuple(x8_schedule.airspeeds), turn_rates=_slower_turns(x8_schedule),
    )  # fmt: skip
    airspeed, bank = setup.turning_airspeed(heading_rate), x8_schedule.envelope.bank_max
    rates = []
    for side, turn in ((1.0, x8_schedule.trims[2][-1]), (-1.0, x8_schedule.trims[2][0])):
        place = {"airspeed": airspeed, "altitude": x8_schedule.altitude}
        rates.append(abs(trim(Fdm(X8), **place, bank=side * bank, start=turn).yaw_rate))
    slower = min(rates)
    assert math.degrees(bank) == pytest.approx(50.0)
    # Between trims at 45 and 55 deg and 2.5 m/s apart the turn is as fast or faster by 0.3 %.
    assert heading_rate <= slower <= 1.003 * heading_rate


TIME_STEP = 0.05
SENSORS = SensorsConfig(
    position_sigma_m=1.5,
    velocity_sigma_mps=0.1,
    airspeed_sigma_mps=0.3,
    airspeed_bias_mps=0.5,
    heading_sigma_deg=1.0,
    heading_bias_deg=2.0,
)
MOTION = MeasuredMotion(100.0, -50.0, 12.0, 3.0, 0.1)


def errors(sensors=SENSORS, *, steps, seed=2, time_step=TIME_STEP):
    generator = np.random.default_rng(seed)
    return SensorErrors(sensors, steps=steps, time_step=time_step, generator=generator)


def readings(made, steps):
    """Return errors of north, east, their rates, airspeed and heading, shape (steps, 6)."""
    rows = []
    for step in range(steps):
        position, airspeed, heading = made.read(step, MOTION, 19.0, 0.5, satellites=True)
        rows.append([*np.subtract(position, MOTION[:4]), airspeed - 19.0, heading - 0.5])
    return np.array(rows)


def test_without_errors_sensors_tell_the_truth():
    exact = errors(SensorsConfig(), steps=2)
    assert exact.read(1, MOTION, 19.0, 0.5, satellites=True) == (MOTION[:4], 19.0, 0.5)


def test_noise_and_biases_are_as_large_as_they_say():
    made = errors(steps=4000, seed=0)
    found = readings(made, 4000)
    # 4,000 of each: the deviation is known to 1.1 %; 4 sigma.
    expected = [0.1, 0.1, 0.3, math.radians(1.0)]
    np.testing.assert_allclose(found[:, 2:].std(axis=0), expected, rtol=0.045)
    # What the mean of a flight is off by is its bias: 4 sigma of a mean of 4,000.
    airspeed, heading = found[:, 4:].mean(axis=0)
    assert airspeed == pytest.approx(made.airspeed_bias, abs=4.0 * 0.3 / math.sqrt(4000))
    assert abs(heading) <= math.radians(2.0 + 4.0 / math.sqrt(4000))
    biases = [errors(steps=1, seed=seed).airspeed_bias for seed in range(60)]
    assert np.abs(biases).max() <= 0.5
    # Even over 1 m/s: deviation 0.289 m/s; of 60, known to 5 % or so (the kurtosis of a uniform is
    # low), 4 sigma.
    assert np.std(biases) == pytest.approx(1.0 / math.sqrt(12.0), rel=0.25)


def test_the_error_of_satellite_navigation_wanders_with_a_time_constant_of_a_minute():
    # 12 s steps: the correlation from one to the next is e^(-12/60).
    found = readings(errors(steps=20_000, time_step=12.0), 20_000)[:, :2]
    for column in found.T:
        correlation = float(np.corrcoef(column[1:], column[:-1])[0, 1])
        # Standard error sqrt((1 - r^2)/n) = 0.004; 4 sigma.
        assert correlation == pytest.approx(math.exp(-0.2), abs=0.016)
        # Deviation of 20,000 correlated values: worth 2,000, known to 1.6 %; 4 sigma.
        assert column.std() == pytest.approx(1.5, rel=0.065)
