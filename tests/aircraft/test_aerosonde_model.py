"""The Aerosonde in JSBSim against Beard and McLain: forces, propulsion, trims, linear model."""

import math

import aerosonde_published as bm
import numpy as np
import pytest
from x8_published import equatorial_gravity, standard_density

from aircraft.fdm import TIME_STEP, Fdm
from aircraft.fleet.aerosonde import AEROSONDE
from aircraft.linearise import linearise
from aircraft.state import RigidBodyState, body_velocity
from aircraft.trim import trim

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


def test_mass_and_inertia_are_the_published_ones(fdm):
    with fdm.frozen():
        hold(fdm, 25.0, 0.05, 0.0, STILL, STILL)
    assert fdm.read("inertia/mass-slugs") * 14.593902937 == pytest.approx(bm.MASS, rel=1e-7)
    # JSBSim's kg m^2 is 9e-5 off (test_x8_forces). The sign of Jxz shows in how it answers moments
    # (the doublets of verification).
    for name, published in (("ixx", bm.JX), ("iyy", bm.JY), ("izz", bm.JZ)):
        assert fdm.read(f"inertia/{name}-slugs_ft2") * NM_PER_LBF_FT == pytest.approx(
            published, rel=2e-4
        )


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


TRIMS = {
    "slow": {"airspeed": 20.0},
    "middle": {"airspeed": 25.0},
    "fast": {"airspeed": 30.0},
    "climbing": {"airspeed": 25.0, "climb_angle": 0.1},
    "descending": {"airspeed": 25.0, "climb_angle": -0.1},
    "turning right": {"airspeed": 25.0, "bank": math.radians(45.0)},
    "turning left": {"airspeed": 22.5, "bank": math.radians(-55.0)},
    "climbing turn": {"airspeed": 25.0, "bank": 0.5, "climb_angle": 0.08},
}


def published_state(found):
    """A trim in the order of FLOWN_STATES, and its commands."""
    velocity = body_velocity(found.airspeed, found.alpha, found.beta)
    surfaces = [found.driven[f"{name}_position"] for name in bm.SURFACES]
    body = [*velocity, found.roll, found.pitch, 0.0, *found.rates_body, found.altitude]
    return np.array([*body, *surfaces, found.driven["propeller_speed"]]), [
        *surfaces,
        found.inputs["throttle"],
    ]


@pytest.mark.parametrize("name", TRIMS)
def test_the_published_equations_are_in_balance_at_every_trim(fdm, name):
    found = trim(fdm, altitude=100.0, **TRIMS[name])
    world = bm.World(standard_density, equatorial_gravity(100.0))
    rates = dict(
        zip(bm.FLOWN_STATES, bm.flown_rates(*published_state(found), world, LAGS), strict=True)
    )
    # The earth turns (2 omega V = 4e-3 m/s^2 where motion is not north, in turns) and is round
    # (V^2/R = 1e-4 m/s^2).
    coriolis = 2.0 * 7.292e-5 * found.airspeed
    assert (rates["u"], rates["v"], rates["w"]) == pytest.approx((0.0, 0.0, 0.0), abs=coriolis)
    # A thousandth of full elevator gives 0.03 rad/s^2. What is left is density (2e-5) and inertia
    # (9e-5) of moments that balance.
    assert (rates["p"], rates["q"], rates["r"]) == pytest.approx((0.0, 0.0, 0.0), abs=1e-3)
    assert (rates["roll"], rates["pitch"]) == pytest.approx((0.0, 0.0), abs=1e-12)  # rounding
    assert rates["yaw"] == pytest.approx(found.yaw_rate, abs=1e-12)
    assert rates["altitude"] == pytest.approx(
        found.airspeed * math.sin(found.climb_angle), abs=1e-9
    )
    # rad/s^2. Interpolation in steps of 0.01 is 4e-7 of C_Q off, whose unit is 390 N m at 30 m/s,
    # on a rotor of 2.1e-3 kg m^2; and JSBSim's horsepower is 1.3e-5 of 1 N m.
    assert rates["propeller_speed"] == pytest.approx(0.0, abs=0.09)
    assert found.beta == pytest.approx(0.0, abs=1e-9)  # what the rudder is for
    assert found.residual < 1e-5


@pytest.mark.parametrize("bank", [0.0, 0.6])
def test_the_poles_of_the_linear_model_are_those_of_the_published_equations(bank):
    time_step = TIME_STEP / 10.0
    found = trim(Fdm(AEROSONDE), airspeed=25.0, altitude=100.0, bank=bank)
    model = linearise(Fdm(AEROSONDE, time_step=time_step), found)
    y, commands = published_state(found)
    world = bm.World(standard_density, equatorial_gravity(100.0))
    steps = np.diag([1e-4] * 9 + [1.0] + [1e-4] * 3 + [1e-2])
    columns = [
        (
            bm.flown_rates(y + step, commands, world, LAGS)
            - bm.flown_rates(y - step, commands, world, LAGS)
        )
        / (2.0 * step.sum())
        for step in steps
    ]
    # Yaw does not act back: a pole at zero.
    without_yaw = [i for i, name in enumerate(bm.FLOWN_STATES) if name != "yaw"]
    expected = np.linalg.eigvals(np.column_stack(columns)[np.ix_(without_yaw, without_yaw)])
    found_poles = model.poles()
    for pole in expected:
        nearest = found_poles[np.argmin(np.abs(found_poles - pole))]
        # The propeller's pole k (52 rad/s) is read from JSBSim's Euler steps as -ln(1 - k dt)/dt,
        # 2.2 % more in steps of 1/1200 s. Otherwise inertia 9e-5, and 0.6 % of thrust's slope for
        # the phugoid; the earth's rate, 7e-5 rad/s, for the slowest.
        assert abs(nearest - pole) < (0.025 if pole.real < -45.0 else 2e-3) * abs(pole) + 1e-3, pole
    assert len(found_poles) == len(expected)
