"""The X8 under its autopilot: released, in other air, in steps and turns, and at limits."""

import math
from dataclasses import replace

import numpy as np
import pytest
from innerloop_flights import TIME_STEP, after, fly

from aircraft.fdm import EARTH_RATE, Fdm
from aircraft.fleet.x8 import X8
from aircraft.trim import trim
from aircraft.weather import TURBULENCE, Gust, Weather
from aircraft.wind import constant_wind
from common.physics import METRES_PER_FOOT, STANDARD_GRAVITY
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.flight.responses import flown_step, measure_lag, predicted_step

MIDDLE = 2


@pytest.mark.parametrize("index", [1, 3])
def test_a_released_aircraft_stays_in_its_equilibrium(x8_schedule, x8_aircraft, index):
    found = x8_schedule.level(index)
    flight = fly(x8_aircraft, found, 20.0)
    # Integrators start at zero and the equilibrium's controls are in the tables: what moves is what
    # the kink of the tables at wings level makes of 0.3 mrad of bank. Centimetres, cm/s and
    # milliradians.
    assert np.abs(flight["altitude"] - found.altitude).max() < 0.02
    assert np.abs(flight["airspeed"] - found.airspeed).max() < 0.02
    assert np.abs(flight["heading_rate"]).max() < 2e-3


@pytest.mark.parametrize("altitude", [10.0, 2000.0])
def test_the_autopilot_designed_near_the_sea_flies_at_other_altitudes(x8_aircraft, altitude):
    found = trim(Fdm(X8), airspeed=20.0, altitude=altitude)
    flight = fly(
        x8_aircraft, found, 30.0, [(1.0, "heading_rate", 0.25), (15.0, "heading_rate", 0.0)]
    )
    # Integral action takes up the different equilibrium: at 2000 m, with a fifth less density, 0.2
    # m at first.
    assert np.abs(flight["altitude"] - altitude).max() < 0.5
    assert np.abs(flight["airspeed"] - 20.0).max() < 0.2
    assert np.abs(after(flight, 28.0, "altitude") - altitude).max() < 0.01


def test_an_aircraft_released_off_its_equilibrium_is_brought_there(x8_schedule, x8_aircraft):
    found = x8_schedule.level(MIDDLE)
    upset = replace(found.state(), roll=0.5, pitch=0.15, rates_body=(0.3, -0.2, 0.1))
    x8_aircraft.release(upset, airspeed=20.0, altitude=x8_schedule.altitude)
    x8_aircraft.fdm.step(15 * 120)
    read = x8_aircraft.fdm.read
    # Fifteen seconds, seven time constants of the slowest pole.
    assert read("attitude/phi-rad") == pytest.approx(found.roll, abs=2e-3)
    assert read("velocities/vt-fps") * 0.3048 == pytest.approx(20.0, abs=0.02)
    assert read("position/h-sl-meters") == pytest.approx(x8_schedule.altitude, abs=0.05)


BANK_MAX = X8.envelope.bank_max  # 50 degrees


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_huge_heading_rate_command_stays_within_the_envelopes_bank(
    x8_schedule, x8_aircraft, sign
):
    flight = fly(x8_aircraft, x8_schedule.level(MIDDLE), 20.0, [(1.0, "heading_rate", sign * 5.0)])
    # The command is clipped: the limit as written in the file, nine digits. It is reached, else
    # nothing was tried.
    assert np.abs(flight["bank_command"]).max() <= BANK_MAX * (1.0 + 1e-8)
    assert np.abs(flight["bank_command"]).max() == pytest.approx(BANK_MAX, rel=1e-6)
    # The bank overshoots its command by 1.5 degrees in the first second; three is a small part of
    # what is left to stall.
    assert np.abs(flight["bank"]).max() < BANK_MAX + math.radians(3.0)
    # Steady: within 0.2 degrees, what the turn-compensation tables leave for feedback without
    # integral on bank.
    assert np.abs(after(flight, 5.0, "bank")) == pytest.approx(BANK_MAX, abs=math.radians(0.2))
    assert np.abs(flight["altitude"] - x8_schedule.altitude).max() < 1.0
    assert np.abs(flight["airspeed"] - 20.0).max() < 0.5


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_half_a_minute_of_saturated_bank_leaves_no_lasting_offset(x8_schedule, x8_aircraft, sign):
    commands = [(1.0, "heading_rate", sign * 5.0), (31.0, "heading_rate", 0.0)]
    flight = fly(x8_aircraft, x8_schedule.level(MIDDLE), 52.0, commands)
    # Wound up by 30 s of 4 rad/s of error it would turn on for long. It rolls out at once, past
    # level by less than 5 degrees ...
    rolled_out = after(flight, 32.0, "bank")
    assert np.abs(rolled_out).max() < math.radians(5.0)
    # ... and after ten time constants of its heading integral (near 1.3 s) is as straight as
    # before: 1e-3 rad/s is 0.06 degrees a second, 1e-3 rad of bank is 0.06 degrees.
    assert np.abs(after(flight, 44.0, "heading_rate")).max() < 1e-3
    assert np.abs(after(flight, 44.0, "bank") - flight["bank"][0]).max() < 1e-3


@pytest.mark.parametrize(
    ("commanded", "held"), [(100.0, X8.envelope.airspeed_max), (1.0, X8.envelope.airspeed_min)]
)
def test_an_airspeed_command_outside_the_envelope_is_held_at_its_limit(
    x8_schedule, x8_aircraft, commanded, held
):
    flight = fly(x8_aircraft, x8_schedule.level(MIDDLE), 35.0, [(1.0, "airspeed", commanded)])
    # After 30 s there is nothing left of the change; the limit itself is in the file with nine
    # digits.
    assert after(flight, 30.0, "airspeed") == pytest.approx(held, abs=0.01)
    # On the way it passes the limit by 0.6 m/s at most; 1 m/s is how far the design airspeeds reach
    # past the envelope.
    assert flight["airspeed"].min() > X8.envelope.airspeed_min - 1.0
    assert flight["airspeed"].max() < X8.envelope.airspeed_max + 1.0
    assert np.abs(flight["altitude"] - x8_schedule.altitude).max() < 2.0


def test_a_descent_that_is_to_end_is_not_flown_on_by_its_own_integral(x8_schedule, x8_aircraft):
    level = x8_schedule.level(MIDDLE)
    x8_aircraft.release(level.state(), airspeed=level.airspeed, altitude=level.altitude)
    altitude = x8_aircraft.fdm.node("position/h-sl-ft").get_double_value

    def altitudes(seconds, ahead):
        """Return the altitude at each half second [m] under a command ``ahead`` of it [m]."""
        flown = []
        for _ in range(2 * seconds):
            x8_aircraft.command_altitude(altitude() * METRES_PER_FOOT + ahead)
            x8_aircraft.fdm.step(60)
            flown.append(altitude() * METRES_PER_FOOT)
        return flown

    descent = altitudes(10, -1.4)
    assert descent[-2] - descent[-1] > 1.0  # at 2 m/s and more, or nothing was tried
    # The error that is integrated is beyond its limit from now on, and what was integrated goes on
    # descending.
    climb = altitudes(30, 3.0)
    assert min(climb) > descent[-1] - 4.0
    assert climb[-1] > climb[-20] > climb[-40]


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_controls_stay_within_their_range_whatever_is_commanded(x8_schedule, x8_aircraft, sign):
    commands = [
        *((1.0 + t, "heading_rate", sign * 5.0 * (-1.0) ** t) for t in range(8)),
        *((1.5 + 2 * t, "airspeed", 20.0 + 30.0 * (-1.0) ** t) for t in range(4)),
        *((1.2 + 2 * t, "altitude", x8_schedule.altitude + 50.0 * (-1.0) ** t) for t in range(4)),
        *(
            (10.0, name, value)
            for name, value in (
                ("heading_rate", 0.0),
                ("airspeed", 20.0),
                ("altitude", x8_schedule.altitude),
            )
        ),
    ]
    flight = fly(x8_aircraft, x8_schedule.level(MIDDLE), 40.0, commands)
    for name in ("elevator", "aileron", "throttle"):
        limits = X8.input(name)
        assert flight[name].min() >= limits.lower
        assert flight[name].max() <= limits.upper
    assert all(np.isfinite(channel).all() for channel in flight.values())
    # And it recovers: half a minute after all that it flies straight and level as before.
    assert after(flight, 38.0, "altitude") == pytest.approx(x8_schedule.altitude, abs=0.1)
    assert after(flight, 38.0, "airspeed") == pytest.approx(20.0, abs=0.05)
    assert np.abs(after(flight, 38.0, "heading_rate")).max() < 1e-3


SMALL = {"airspeed": 0.2, "altitude": 0.2, "heading_rate": 0.02}  # m/s, m, rad/s


@pytest.mark.parametrize(("index", "sign"), [(1, -1.0), (2, 1.0), (2, -1.0), (3, 1.0)])
@pytest.mark.parametrize("command", SMALL)
def test_a_small_step_is_flown_as_the_linear_design_predicts(
    x8_schedule, x8_aircraft, command, index, sign
):
    size = sign * SMALL[command]
    flown = flown_step(x8_aircraft, x8_schedule.level(index), command, size, 6.0)
    predicted = predicted_step(x8_schedule, index, command, size, 6.0)
    difference = np.asarray(flown.channels[command]) - np.asarray(predicted.channels[command])
    # Measured 1 to 2.2 % of the step: JSBSim works in steps of 1/120 s, in first order, on motion
    # of up to 16 rad/s, of which the linear model knows the delay and not the rest; and tables kink
    # at wings level. 4 % leaves room for neither a wrong gain (10 % of any shows) nor another
    # platform's rounding to matter.
    assert np.abs(difference).max() < 0.04 * abs(size)


@pytest.mark.parametrize("size", [0.25, -0.25])
def test_a_heading_rate_step_is_quick_and_disturbs_neither_altitude_nor_airspeed(
    x8_schedule, x8_aircraft, size
):
    flown = flown_step(x8_aircraft, x8_schedule.level(MIDDLE), "heading_rate", size, 8.0)
    # Requirements: the guidance's commands reach 0.25 rad/s at frequencies near 0.3 rad/s, so 0.8 s
    # of rise time is a small part of its period; altitude and airspeed are constant in the paper,
    # and 1 m and 0.5 m/s are small against plume and speed.
    assert flown.rise_time() <= 0.8
    assert flown.overshoot() <= 0.15
    assert flown.largest("altitude") <= 1.0
    assert flown.largest("airspeed") <= 0.5
    # And it arrives: integral action leaves a thousandth of the step after 8 s, eight of its time
    # constants or so.
    assert flown.channels["heading_rate"][-1] == pytest.approx(size, rel=2e-3)


@pytest.mark.parametrize("command", ["airspeed", "altitude"])
def test_steps_of_airspeed_and_altitude_settle_on_the_command(x8_schedule, x8_aircraft, command):
    flown = flown_step(x8_aircraft, x8_schedule.level(MIDDLE), command, 1.0, 25.0)
    # The slowest closed-loop pole is near 0.5 rad/s: 25 s are twelve of its time constants.
    assert flown.channels[command][-1] == pytest.approx(1.0, abs=1e-3)
    assert flown.overshoot() < 0.3


@pytest.mark.parametrize("index", [1, 3])
def test_the_flown_heading_rate_lags_its_command_by_the_lag_of_the_model(
    x8_schedule, x8_aircraft, index
):
    weights = x8_schedule.weights
    # A second-order model lags slow commands by 2 zeta/omega_n: 2 times 0.9 over 4.83 rad/s is
    # 0.373 s. 0.03 s is left for its own phase at 0.5 rad/s (0.2 ms), two steps of computing (8 ms
    # each), and how well the aircraft follows the model.
    expected = 2.0 * weights.model_damping / weights.model_frequency
    assert measure_lag(x8_aircraft, x8_schedule.level(index), X8.envelope.bank) == pytest.approx(
        expected, abs=0.03
    )


YAW, TURN = 0.6, 0.2


def fly_in_weather(aircraft, start, weather, duration, turn_at=5.0):
    """Fly on a heading of 0.6 rad, and turn from ``turn_at`` [s] on; return the channels."""
    turn = [(turn_at, "heading_rate", TURN)]
    return fly(aircraft, start, duration, turn, yaw=YAW, weather=weather)


@pytest.mark.parametrize("toward", [0.0, -90.0, 135.0])
def test_in_wind_an_aircraft_flies_the_calm_path_carried_along(x8_schedule, x8_root, toward):
    start, direction = x8_schedule.level(MIDDLE), math.radians(toward)
    wind = 10.0 * math.cos(direction), 10.0 * math.sin(direction)
    calm, windy = (
        fly_in_weather(AutopilotedAircraft(X8, x8_root), start, weather, 25.0)
        for weather in (None, Weather(wind=constant_wind(*wind)))
    )
    course = YAW + start.course_offset()
    # The velocity triangle at the release, to the last digits that are left of a globe's
    # coordinates and 1e-6 ft/s of north wind.
    found = windy["north_speed"][0] - wind[0], windy["east_speed"][0] - wind[1]
    expected = start.airspeed * math.cos(course), start.airspeed * math.sin(course)
    assert found == pytest.approx(expected, abs=1e-6)
    assert windy["airspeed"][0] == pytest.approx(start.airspeed, abs=1e-6)
    # No more of a transient in the first 5 s than in calm air. The earth turns: an aircraft that
    # goes 10 m/s faster eastward weighs 2 x 7.3e-5 x 10 m/s^2 less, 1.5e-4 of its weight, so
    # altitude and airspeed settle as much elsewhere: 0.1 mm and 0.02 mm/s were measured; and the
    # same is allowed of roll [rad], where 5e-7 were.
    lighter = 2.0 * EARTH_RATE * 10.0 / STANDARD_GRAVITY
    for name in ("airspeed", "altitude", "bank"):
        assert np.ptp(windy[name][:600]) < np.ptp(calm[name][:600]) + lighter
    # And its turns are as much wider, so the path is off by that part of their radius, 15 mm, at
    # most twice across a circle.
    for name, speed in zip(("north", "east"), wind, strict=True):
        drift = windy[name] - calm[name] - speed * calm["time"]
        assert np.abs(drift).max() < 2.0 * lighter * start.airspeed / TURN


def test_a_used_aircraft_flies_a_weather_as_a_fresh_one_does(x8_schedule, x8_root):
    start = x8_schedule.level(MIDDLE)
    rough, other = (
        Weather(
            wind=constant_wind(3.0, -5.0),
            turbulence=TURBULENCE["moderate"],
            gusts=(Gust(start=1.0, rise=0.5, hold=0.5, fall=0.5, velocity_ned=gust),),
            seed=seed,
        )
        for seed, gust in enumerate(((0.0, 3.0, 0.0), (2.0, 0.0, -1.0)))
    )
    used = AutopilotedAircraft(X8, x8_root)
    for weather in (rough, None):
        # Ends in a turn, in the middle of a gust, and of a period of the autopilot.
        fly_in_weather(used, start, other, 181 * TIME_STEP, turn_at=0.5)
        fresh = fly_in_weather(AutopilotedAircraft(X8, x8_root), start, weather, 5.0)
        again = fly_in_weather(used, start, weather, 5.0)
        for name, values in fresh.items():
            # Servos and propeller come to rest from elsewhere, to a millionth.
            np.testing.assert_allclose(again[name], values, atol=1e-5, err_msg=name)
