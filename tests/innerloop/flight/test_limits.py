"""Limits and saturation: commands that cannot be met, and their effects afterwards."""

import math

import numpy as np
import pytest
from innerloop_flights import METRES_PER_FOOT, after, fly

from aircraft.fleet.x8 import X8

MIDDLE = 2
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
