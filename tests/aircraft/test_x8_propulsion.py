"""Propeller and motor of the X8 against the published polynomials and motor equations."""

import math

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
            x8_fdm.command({"elevator": 0.0, "aileron": 0.0, "throttle": throttle})
            ahead = (airspeed, 0.0, 0.0)
            x8_fdm.place(RigidBodyState(altitude=100.0, roll=0.0, pitch=0.0, velocity_body=ahead))
            assert x8_fdm.settle()
            density = x8_fdm.read("atmosphere/rho-slugs_ft3") * KG_M3_PER_SLUG_FT3
            speed = x8_fdm.read("propulsion/engine/propeller-rpm") * RAD_S_PER_RPM
            thrust = x8_fdm.read("propulsion/engine/thrust-lbs") * N_PER_LBF
            torque = -x8_fdm.read("propulsion/engine/propeller-torque-ftlb") * NM_PER_LBF_FT
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
