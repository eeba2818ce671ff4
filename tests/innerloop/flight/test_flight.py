"""Releasing an aircraft under its autopilot."""

from dataclasses import replace

import numpy as np
import pytest
from innerloop_flights import after, fly

from aircraft.fdm import Fdm
from aircraft.fleet.x8 import X8
from aircraft.trim import trim

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
