"""The Aerosonde in JSBSim against Beard and McLain: forces, propulsion, trims, linear model."""

import math

import aerosonde_published as bm
import numpy as np
import pytest

from aircraft.fdm import Fdm
from aircraft.fleet.aerosonde import AEROSONDE
from aircraft.state import RigidBodyState, body_velocity

N_PER_LBF = 4.4482216152605
NM_PER_LBF_FT = 1.3558179483314
KG_M3_PER_SLUG_FT3 = 515.37881839
RAD_S_PER_RPM = math.pi / 30.0

LAGS = bm.Lags()

# Airspeed [m/s], alpha, beta [rad], rates [rad/s], elevator, aileron, rudder [rad]. Each derivative
# on its own, then all together, attached and through the stall at 0.47 rad on both sides.
STILL = (0.0, 0.0, 0.0)
CONDITIONS = [
    *(
        (25.0, alpha, 0.0, STILL, STILL)
        for alpha in (-0.6, -0.47, -0.1, 0.0, 0.05, 0.2, 0.44, 0.47, 0.5, 0.6)
    ),
    *((25.0, 0.05, beta, STILL, STILL) for beta in (-0.15, 0.1)),
    *(
        (22.0, 0.05, 0.0, rates, STILL)
        for rates in ((0.8, 0.0, 0.0), (0.0, -0.6, 0.0), (0.0, 0.0, 0.5))
    ),
    *(
        (28.0, 0.05, 0.0, STILL, surfaces)
        for surfaces in ((-0.3, 0.0, 0.0), (0.0, 0.2, 0.0), (0.0, 0.0, -0.25))
    ),
    *((25.0, alpha, 0.1, (0.5, -0.2, 0.3), (-0.2, 0.1, 0.15)) for alpha in (0.08, 0.45)),
]


@pytest.fixture(scope="module")
def fdm():
    return Fdm(AEROSONDE)


def hold(fdm, airspeed, alpha, beta, rates, surfaces, throttle=0.7):
    """Hold the aircraft in this motion until servos and propeller stand; return the density
    [kg/m^3].
    """
    commands = {
        name: deflection / bm.FULL_DEFLECTION
        for name, deflection in zip(bm.SURFACES, surfaces, strict=True)
    }
    fdm.command({**commands, "throttle": throttle})
    fdm.place(
        RigidBodyState(
            altitude=100.0,
            roll=0.1,
            pitch=0.1,
            velocity_body=body_velocity(airspeed, alpha, beta),
            rates_body=rates,
        )
    )
    assert fdm.settle()
    return fdm.read("atmosphere/rho-slugs_ft3") * KG_M3_PER_SLUG_FT3


def test_aerodynamic_forces_and_moments_are_those_of_the_published_coefficients(fdm):
    for condition in CONDITIONS:
        airspeed, alpha, beta, rates, surfaces = condition
        with fdm.frozen():
            density = hold(fdm, *condition)
            force = np.array([fdm.read(f"forces/fb{i}-aero-lbs") for i in "xyz"]) * N_PER_LBF
            moment = np.array([fdm.read(f"moments/{i}-aero-lbsft") for i in "lmn"]) * NM_PER_LBF_FT
        velocity = body_velocity(airspeed, alpha, beta)
        expected_force, expected_moment = bm.aero(velocity, rates, surfaces, density)
        # JSBSim's unit factors carry eight digits or so; the blend multiplies those of its exponent
        # by 50. Absolute: a millionth of what a coefficient of 0.05 gives at 25 m/s.
        limits = {"rtol": 2e-6, "atol": 1e-5, "err_msg": repr(condition)}
        np.testing.assert_allclose(force, expected_force, **limits)
        np.testing.assert_allclose(moment, expected_moment, **limits)


def settled(fdm, airspeed, throttle):
    """Return density [kg/m3], speed [rad/s] and thrust [N] of the propeller that has settled."""
    with fdm.frozen():
        density = hold(fdm, airspeed, 0.0, 0.0, STILL, STILL, throttle)
        speed = fdm.read("propulsion/engine/propeller-rpm") * RAD_S_PER_RPM
        return density, speed, fdm.read("propulsion/engine/thrust-lbs") * N_PER_LBF


@pytest.mark.parametrize(
    ("airspeed", "throttle"), [(20.0, 0.5), (25.0, 0.6), (25.0, 0.77), (25.0, 1.0), (32.0, 1.0)]
)
def test_the_propeller_settles_where_the_published_quadratic_says_and_pulls_as_much(
    fdm, airspeed, throttle
):
    density, speed, thrust = settled(fdm, airspeed, throttle)
    # Interpolation in steps of 0.01 is 2.7e-6 of C_T and 0.4e-6 of C_Q off, and JSBSim's horsepower
    # 1.3e-5 of the torque.
    assert speed == pytest.approx(bm.settled_propeller_speed(throttle, airspeed, density), rel=1e-5)
    unit = density * (speed / (2.0 * math.pi)) ** 2 * bm.PROPELLER_DIAMETER**4
    assert thrust == pytest.approx(bm.thrust(airspeed, speed, density), abs=3e-6 * unit)


@pytest.mark.parametrize(
    ("airspeed", "throttle"), [(21.0, 0.3), (25.0, 0.05), (25.0, 0.2), (25.0, 0.4), (30.0, 0.1)]
)
def test_with_little_throttle_the_propeller_windmills_and_brakes_as_published(
    fdm, airspeed, throttle
):
    density, speed, thrust = settled(fdm, airspeed, throttle)
    # Beyond an advance ratio of 1; with the throttle nearly closed 7.
    assert airspeed / (speed / (2.0 * math.pi) * bm.PROPELLER_DIAMETER) > 1.0
    # Steps of up to 0.1 J: (0.1 J)^2/8 of the second derivative, 0.216, is 0.25 % of 0.108 J^2.
    published = bm.settled_propeller_speed(throttle, airspeed, density)
    assert speed == pytest.approx(published, rel=1e-3)
    assert thrust == pytest.approx(bm.thrust(airspeed, published, density), rel=2.5e-3)
    assert thrust < -10.0
