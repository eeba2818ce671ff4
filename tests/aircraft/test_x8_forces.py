"""Forces, moments and inertia of the X8 in JSBSim against the published numbers."""

import itertools

import numpy as np
import pytest
import x8_published as x8

from aircraft.state import RigidBodyState, body_velocity

N_PER_LBF = 4.4482216152605
NM_PER_LBF_FT = 1.3558179483314
KG_M3_PER_SLUG_FT3 = 515.37881839

# Each derivative is met on its own and all together, with both signs, below the model's limit of
# 0.2 rad of angle of attack.
STATES = [
    x8.Air(airspeed=18.0),
    *(x8.Air(airspeed=18.0, alpha=a) for a in (-0.1, 0.03, 0.18)),
    *(x8.Air(airspeed=20.0, beta=b) for b in (-0.1, 0.12)),
    *(x8.Air(airspeed=15.0, p=p) for p in (-1.0, 0.8)),
    *(x8.Air(airspeed=15.0, q=q) for q in (-0.6, 0.9)),
    *(x8.Air(airspeed=25.0, r=r) for r in (-0.7, 0.5)),
    *(x8.Air(airspeed=20.0, elevator=e) for e in (-0.3, 0.2)),
    *(x8.Air(airspeed=20.0, aileron=a) for a in (-0.2, 0.3)),
    *(
        x8.Air(
            airspeed=21.0,
            alpha=0.08,
            beta=0.05 * b,
            p=0.5 * p,
            q=0.2,
            r=-0.3 * p,
            elevator=-0.1,
            aileron=0.1 * b,
        )
        for b, p in itertools.product((-1.0, 1.0), repeat=2)
    ),
]


def hold(fdm, air, altitude=150.0):
    """Hold the aircraft still in the air's motion with its elevons at rest; return JSBSim's density
    [kg/m^3].
    """
    fdm.command(
        {
            "elevator": air.elevator / x8.ELEVON_FULL,
            "aileron": air.aileron / x8.ELEVON_FULL,
            "throttle": 0.5,
        }
    )
    fdm.place(
        RigidBodyState(
            altitude=altitude,
            roll=0.2,
            pitch=0.1,
            velocity_body=body_velocity(air.airspeed, air.alpha, air.beta),
            rates_body=(air.p, air.q, air.r),
        )
    )
    assert fdm.settle()
    return fdm.read("atmosphere/rho-slugs_ft3") * KG_M3_PER_SLUG_FT3


def test_aerodynamic_forces_and_moments_are_those_of_the_published_coefficients(x8_fdm):
    for air in STATES:
        with x8_fdm.frozen():
            density = hold(x8_fdm, air)
            force = np.array([x8_fdm.read(f"forces/fb{i}-aero-lbs") for i in "xyz"]) * N_PER_LBF
            moment = np.array([x8_fdm.read(f"moments/{i}-aero-lbsft") for i in "lmn"])
        moment *= NM_PER_LBF_FT
        # Source of the coefficients: x8_published. At JSBSim's own density (which has its own test)
        # a part in a million is left for JSBSim's unit factors, which carry eight digits or so.
        # Absolute: a millionth of what a coefficient of 0.01 gives at 20 m/s.
        expected_force, expected_moment = x8.aero_force(air, density), x8.aero_moment(air, density)
        np.testing.assert_allclose(force, expected_force, rtol=1e-6, atol=2e-6, err_msg=repr(air))
        np.testing.assert_allclose(moment, expected_moment, rtol=1e-6, atol=2e-6, err_msg=repr(air))


def test_density_is_that_of_the_standard_atmosphere(x8_fdm):
    for altitude in (0.0, 100.0, 200.0, 1000.0):
        with x8_fdm.frozen():
            density = hold(x8_fdm, x8.Air(airspeed=20.0), altitude)
        # U.S. Standard Atmosphere 1976. JSBSim rounds the molar mass of air to 28.9645 g/mol and
        # the earth's radius: 1e-5 or so.
        assert density == pytest.approx(x8.standard_density(altitude), rel=2e-5)
