"""The Skywalker X8's published trim: level flight at 18 m/s and 200 m with alpha = 0.0308 rad and
0.0370 rad of symmetric elevon.

Source: Gryte, Hann, Alam, Rohac, Johansen, Fossen, "Aerodynamic modeling of the Skywalker X8
Fixed-Wing Unmanned Aerial Vehicle", ICUAS 2018, and the parameter file its authors published.
Thrust in it is another model's, so only angles are compared.
"""

import math

import pytest
from scipy.optimize import brentq

from aircraft.fdm import Fdm
from aircraft.fleet.x8 import X8
from aircraft.trim import trim

ALPHA, ELEVON = 0.0308, 0.0370  # rad
ROUNDING = 5e-5  # rad, half their last digit
AIRSPEED, ALTITUDE = 18.0, 200.0  # m/s, m

MASS, WING_AREA = 3.364, 0.75  # kg, m^2
CL_0, CL_A, CL_DE = 0.08674, 4.0203, 0.27807
CD_0, CD_A, CD_AA, CD_DEDE = 0.01970, 0.07909, 1.05547, 0.06335
CM_0, CM_A, CM_DE = 0.02275, -0.4629, -0.2292

SEA_LEVEL_DENSITY = 1.225  # kg/m^3, U.S. Standard Atmosphere 1976
GRAVITY = 9.81  # m/s^2, the textbook's value
EQUATORIAL_GRAVITY = 9.7803  # m/s^2, WGS 84 on the equator, where our trims are: JSBSim flies over a turning, oblate earth


def balance(density, gravity):
    """Angle of attack and elevon [rad] by hand: no pitching moment, and lift with thrust's share
    against the weight.
    """

    def elevon(alpha):
        return -(CM_0 + CM_A * alpha) / CM_DE  # C_m = 0

    def excess(alpha):
        dynamic = 0.5 * density * AIRSPEED**2 * WING_AREA
        lift = dynamic * (CL_0 + CL_A * alpha + CL_DE * elevon(alpha))
        drag = dynamic * (CD_0 + CD_A * alpha + CD_AA * alpha**2 + CD_DEDE * elevon(alpha) ** 2)
        return (
            lift + drag * math.tan(alpha) - MASS * gravity
        )  # thrust along the body: T cos(alpha) = D, T sin(alpha) lifts

    alpha = brentq(excess, 0.0, 0.2, xtol=1e-12)
    return alpha, elevon(alpha)


def test_alpha_at_18_mps_and_200_m_is_the_published_one_within_two_milliradians():
    # Two milliradians, a ninth of a degree, is what wind-tunnel coefficients and two independent
    # simulations can be asked for.
    assert trim(Fdm(X8), airspeed=AIRSPEED, altitude=ALTITUDE).alpha == pytest.approx(
        ALPHA, abs=2e-3
    )


def test_elevon_at_18_mps_and_200_m_is_the_published_one_within_what_density_explains():
    # 2.2 mrad, not 2: the published pair balances at sea-level density (below), and at 200 m there
    # is 1.9 % less. The wing needs 1.2 mrad more there; the elevon answers with C_ma/C_mde = 2.0
    # times that, -2.5 mrad, of which JSBSim's lower gravity takes 0.4 back.
    assert trim(Fdm(X8), airspeed=AIRSPEED, altitude=ALTITUDE).driven[
        "elevator_position"
    ] == pytest.approx(ELEVON, abs=2.2e-3)


def test_the_published_elevon_follows_from_the_published_alpha_whatever_the_density():
    # C_m = 0 alone. Roundings: its own, and alpha's times C_ma/C_mde = 2.0.
    assert pytest.approx(ELEVON, abs=3.0 * ROUNDING) == -(CM_0 + CM_A * ALPHA) / CM_DE


def test_at_the_published_density_the_trim_is_the_published_one_but_for_gravity():
    found = trim(Fdm(X8), airspeed=AIRSPEED, altitude=0.0)
    # The textbook's gravity in place of the equator's, by the hand calculation that the trim agrees
    # with: 0.2 mrad of alpha.
    heavier, lighter = (
        balance(SEA_LEVEL_DENSITY, gravity) for gravity in (GRAVITY, EQUATORIAL_GRAVITY)
    )
    assert found.alpha + heavier[0] - lighter[0] == pytest.approx(ALPHA, abs=2e-4)
    assert found.driven["elevator_position"] + heavier[1] - lighter[1] == pytest.approx(
        ELEVON, abs=2e-4
    )
    # Without that correction alpha still is, and the elevon is within C_ma/C_mde = 2.0 times 0.2
    # mrad.
    assert found.alpha == pytest.approx(ALPHA, abs=2e-4)
    assert found.driven["elevator_position"] == pytest.approx(ELEVON, abs=4e-4)
