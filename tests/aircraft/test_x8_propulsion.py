"""Propeller and motor of the X8 against the published polynomials and motor equations."""

import math

import numpy as np
import pytest
import x8_published as x8

from aircraft.state import RigidBodyState
from common.physics import RAD_S_PER_RPM

N_PER_LBF = 4.4482216152605
NM_PER_LBF_FT = 1.3558179483314
KG_M3_PER_SLUG_FT3 = 515.37881839
TIME_STEP = 1.0 / 120.0

# Linear interpolation of a parabola in steps of h is off by h^2/8 times its second derivative at
# most: 0.2158 for C_T, 0.03328 for C_Q; and the tables carry six decimals (C_P = 2 pi C_Q).
CT_ERROR = 0.05**2 / 8.0 * 0.2158 + 5e-7
CQ_ERROR = 0.05**2 / 8.0 * 0.03328 + 5e-7 / (2.0 * math.pi)

# Airspeed [m/s] and throttle [-]: from windmilling (J = 0.87) to full power, slow and fast; all
# with J inside the tables' 0 to 1.
CONDITIONS = [
    (14.0, 0.3),
    (20.0, 0.5),
    (20.0, 0.667),
    (20.0, 1.0),
    (14.0, 1.0),
    (26.0, 1.0),
    (26.0, 0.7),
]


def settled(fdm, airspeed, throttle, rates=(0.0, 0.0, 0.0)):
    """Hold the aircraft, moving straight ahead, until the propeller stands; return its speed
    [rad/s] and the density [kg/m^3].
    """
    fdm.command({"elevator": 0.0, "aileron": 0.0, "throttle": throttle})
    fdm.place(
        RigidBodyState(
            altitude=100.0,
            roll=0.0,
            pitch=0.0,
            velocity_body=(airspeed, 0.0, 0.0),
            rates_body=rates,
        )
    )
    assert fdm.settle()
    return propeller_speed(fdm), fdm.read("atmosphere/rho-slugs_ft3") * KG_M3_PER_SLUG_FT3


def propeller_speed(fdm):
    return fdm.read("propulsion/engine/propeller-rpm") * RAD_S_PER_RPM


def shaft_torque(fdm):
    return -fdm.read("propulsion/engine/propeller-torque-ftlb") * NM_PER_LBF_FT


def speed_where_torques_meet(airspeed, throttle, density):
    """Speed [rad/s] at which the published motor and propeller have the same torque."""
    low, high = 50.0, x8.BATTERY / x8.MOTOR_KT
    for _ in range(60):  # bisection: the motor's torque falls with speed, the propeller's rises
        middle = 0.5 * (low + high)
        if x8.motor_torque(throttle, middle) > x8.propeller_torque(airspeed, middle, density):
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def test_settled_thrust_torque_and_speed_are_those_of_the_published_equations(x8_fdm):
    for airspeed, throttle in CONDITIONS:
        with x8_fdm.frozen():
            speed, density = settled(x8_fdm, airspeed, throttle)
            thrust = x8_fdm.read("propulsion/engine/thrust-lbs") * N_PER_LBF
            torque = shaft_torque(x8_fdm)
        unit = density * (speed / (2.0 * math.pi)) ** 2 * x8.PROPELLER_DIAMETER**4
        torque_error = CQ_ERROR * unit * x8.PROPELLER_DIAMETER
        assert thrust == pytest.approx(x8.thrust(airspeed, speed, density), abs=CT_ERROR * unit)
        # V = I R + Kt omega and Q = Kt (I - I0). JSBSim's conversion from watts to ft lbf/s (745.7
        # W a horsepower) is 1.3e-5 off.
        assert torque == pytest.approx(x8.motor_torque(throttle, speed), rel=2e-5)
        assert torque == pytest.approx(
            x8.propeller_torque(airspeed, speed, density), abs=torque_error + 2e-5 * abs(torque)
        )
        # The interpolated torque's error over the stiffness of motor and propeller, at least
        # Kt^2/R = 0.0082 N m s/rad.
        stiffness = x8.MOTOR_KT**2 / x8.MOTOR_RESISTANCE
        expected = speed_where_torques_meet(airspeed, throttle, density)
        assert speed == pytest.approx(expected, abs=1.1 * torque_error / stiffness)


def test_the_propeller_follows_the_throttle_with_the_time_constant_of_motor_and_load(x8_fdm):
    airspeed, throttle = 20.0, 0.667
    with x8_fdm.frozen():
        start, density = settled(x8_fdm, airspeed, throttle)
        x8_fdm.command({"throttle": throttle + 0.001})
        moved = []
        for _ in range(20):
            x8_fdm.step()
            moved.append(propeller_speed(x8_fdm))
        assert x8_fdm.settle()
        end = propeller_speed(x8_fdm)
    share = (np.array(moved) - start) / (end - start)
    # J d(omega)/dt = Kt ((V - Kt omega)/R - I0) - Q(omega): without load the time constant is J
    # R/Kt^2 = 0.051 s, and the load's slope shortens it to 0.044 s. JSBSim steps this with Euler's
    # rule: (1 - dt/T)^n of the step is left after n steps.
    load = x8.propeller_torque(airspeed, start + 0.5, density) - x8.propeller_torque(
        airspeed, start - 0.5, density
    )
    rate = (x8.MOTOR_KT**2 / x8.MOTOR_RESISTANCE + load) / x8.PROPELLER_INERTIA
    assert 1.0 / rate == pytest.approx(0.0438, abs=0.0005)
    expected = 1.0 - (1.0 - TIME_STEP * rate) ** np.arange(1, 21)
    # The load's slope between two table points is off by half a step of 0.05 times the second
    # derivative of C_Q: 4 % of a load that is a seventh of the whole, which moves the curve by 0.3
    # % of the step.
    np.testing.assert_allclose(share, expected, atol=0.003)


def test_the_airframe_feels_the_motors_torque_against_the_propellers_turn(x8_fdm):
    with x8_fdm.frozen():
        settled(x8_fdm, 20.0, 0.667)
        roll, pitch, yaw = (
            x8_fdm.read(f"moments/{axis}-prop-lbsft") * NM_PER_LBF_FT for axis in "lmn"
        )
        torque = shaft_torque(x8_fdm)
    # Clockwise seen from behind (sense 1): the reaction rolls left. The thrust line passes the
    # centre of gravity. Exact but for rounding.
    assert torque > 0.1
    assert (roll, pitch, yaw) == pytest.approx((-torque, 0.0, 0.0), abs=1e-9)


def test_the_turning_propeller_resists_like_a_gyroscope(x8_fdm):
    rates = (0.3, -0.4, 0.5)
    with x8_fdm.frozen():
        speed, _ = settled(x8_fdm, 20.0, 0.667, rates)
        moment = np.array(
            [x8_fdm.read(f"moments/{axis}-prop-lbsft") * NM_PER_LBF_FT for axis in "lmn"]
        )
        moment[0] += shaft_torque(x8_fdm)
    # The airframe turns the rotor's angular momentum H, ahead for clockwise seen from behind, and
    # feels -omega x H.
    momentum = np.array([x8.PROPELLER_INERTIA * speed, 0.0, 0.0])
    # JSBSim's kg m^2 is 9e-5 off (test_x8_forces), and a step passes between speed and moment:
    # nothing once settled.
    np.testing.assert_allclose(moment, -np.cross(rates, momentum), rtol=2e-4, atol=1e-9)
