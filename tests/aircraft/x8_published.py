"""The Skywalker X8 written down once more, from the published numbers alone: what JSBSim is
compared with.

Nothing here is imported from the packages under test. Aerodynamics: Gryte, Hann, Alam, Rohac,
Johansen, Fossen, "Aerodynamic modeling of the Skywalker X8 Fixed-Wing Unmanned Aerial Vehicle",
ICUAS 2018, with the parameter file its authors published. Inertia: the set that later work on the
airframe uses. Propeller polynomials: Beard and McLain, "Small Unmanned Aircraft", supplement.
Motor: the three-constant equations with the constants that the model file declares.
"""

import math
from dataclasses import dataclass

import numpy as np

MASS = 3.364  # kg
WING_AREA, SPAN, CHORD = 0.75, 2.1, 0.35714  # m^2, m, m
# rad of symmetric (elevator) or antisymmetric (aileron) elevon for a command of 1.
ELEVON_FULL = 0.5236
# kg m^2; Jxz is the integral of x z dm, forward-right-down.
JX, JY, JZ, JXZ = 0.335, 0.140, 0.400, -0.029
# Products of inertia enter negated.
INERTIA = np.array([[JX, 0.0, -JXZ], [0.0, JY, 0.0], [-JXZ, 0.0, JZ]])

CL_0, CL_A, CL_Q, CL_DE = 0.08674, 4.0203, 3.87, 0.27807
CD_0, CD_A, CD_AA, CD_B, CD_BB, CD_DEDE = 0.01970, 0.07909, 1.05547, -0.00584, 0.14781, 0.06335
CM_0, CM_A, CM_Q, CM_DE = 0.02275, -0.4629, -1.3012, -0.2292
CY_B, CY_P, CY_R, CY_DA = -0.22387, -0.13736, 0.08387, 0.04328
# Rolling moment, "C_l" in the source.
CR_B, CR_P, CR_R, CR_DA = -0.08490, -0.40420, 0.05552, 0.12019
CN_B, CN_P, CN_R, CN_DA = 0.0283, 0.004366, -0.0720, -0.00339

PROPELLER_DIAMETER = 14.0 * 0.0254  # m
PROPELLER_INERTIA = 4.2e-4  # kg m^2
BATTERY = 14.8  # V
MOTOR_KT = 60.0 / (2.0 * math.pi * 610.0)  # N m/A, equal to V s/rad, of a 610 rpm/V motor
MOTOR_RESISTANCE = 0.030  # ohm
MOTOR_NO_LOAD = 1.5  # A


@dataclass(frozen=True)
class Air:
    """Motion through the air: airspeed [m/s], angles [rad], rates [rad/s], elevator and aileron
    deflection [rad].
    """

    airspeed: float
    alpha: float = 0.0
    beta: float = 0.0
    p: float = 0.0
    q: float = 0.0
    r: float = 0.0
    elevator: float = 0.0
    aileron: float = 0.0


def lift_coefficient(air: Air) -> float:
    q_hat = air.q * CHORD / (2.0 * air.airspeed)
    return CL_0 + CL_A * air.alpha + CL_Q * q_hat + CL_DE * air.elevator


def drag_coefficient(air: Air) -> float:
    by_alpha = CD_0 + CD_A * air.alpha + CD_AA * air.alpha**2
    return by_alpha + CD_B * air.beta + CD_BB * air.beta**2 + CD_DEDE * air.elevator**2


def aero_force(air: Air, density: float) -> np.ndarray:
    """Body force [N], forward, right, down: lift and drag along the stability axes, side force
    along body y.
    """
    p_hat, r_hat = (rate * SPAN / (2.0 * air.airspeed) for rate in (air.p, air.r))
    lift, drag = lift_coefficient(air), drag_coefficient(air)
    side = CY_B * air.beta + CY_P * p_hat + CY_R * r_hat + CY_DA * air.aileron
    sin_alpha, cos_alpha = math.sin(air.alpha), math.cos(air.alpha)
    coefficients = np.array(
        [lift * sin_alpha - drag * cos_alpha, side, -lift * cos_alpha - drag * sin_alpha]
    )
    return 0.5 * density * air.airspeed**2 * WING_AREA * coefficients


def aero_moment(air: Air, density: float) -> np.ndarray:
    """Roll, pitch and yaw moment about the centre of gravity [N m]."""
    p_hat, r_hat = (rate * SPAN / (2.0 * air.airspeed) for rate in (air.p, air.r))
    q_hat = air.q * CHORD / (2.0 * air.airspeed)
    roll = CR_B * air.beta + CR_P * p_hat + CR_R * r_hat + CR_DA * air.aileron
    pitch = CM_0 + CM_A * air.alpha + CM_Q * q_hat + CM_DE * air.elevator
    yaw = CN_B * air.beta + CN_P * p_hat + CN_R * r_hat + CN_DA * air.aileron
    return (
        0.5
        * density
        * air.airspeed**2
        * WING_AREA
        * np.array([SPAN * roll, CHORD * pitch, SPAN * yaw])
    )


def thrust_coefficient(advance_ratio: float) -> float:
    """C_T(J) = T/(rho n^2 D^4)."""
    return 0.09357 - 0.06044 * advance_ratio - 0.1079 * advance_ratio**2


def torque_coefficient(advance_ratio: float) -> float:
    """C_Q(J) = Q/(rho n^2 D^5)."""
    return 0.005230 + 0.004970 * advance_ratio - 0.01664 * advance_ratio**2


def thrust(speed_ahead: float, propeller_speed: float, density: float) -> float:
    """Thrust [N] at a speed along the shaft [m/s] and a propeller speed [rad/s]."""
    n = propeller_speed / (2.0 * math.pi)
    return (
        density
        * n**2
        * PROPELLER_DIAMETER**4
        * thrust_coefficient(speed_ahead / (n * PROPELLER_DIAMETER))
    )


def propeller_torque(speed_ahead: float, propeller_speed: float, density: float) -> float:
    """Torque that the air takes [N m]."""
    n = propeller_speed / (2.0 * math.pi)
    return (
        density
        * n**2
        * PROPELLER_DIAMETER**5
        * torque_coefficient(speed_ahead / (n * PROPELLER_DIAMETER))
    )


def motor_torque(throttle: float, propeller_speed: float) -> float:
    """Torque on the shaft [N m] by the three constants: V = I R + Kt omega, Q = Kt (I - I0)."""
    current = (BATTERY * throttle - MOTOR_KT * propeller_speed) / MOTOR_RESISTANCE
    return MOTOR_KT * (current - MOTOR_NO_LOAD)


def standard_density(altitude: float) -> float:
    """Density [kg/m^3] of the U.S. Standard Atmosphere 1976 below 11 km, at a geometric altitude
    [m].
    """
    geopotential = 6356766.0 * altitude / (6356766.0 + altitude)
    temperature = 288.15 - 0.0065 * geopotential
    gas_constant = 8.31432 / 0.0289644
    pressure = 101325.0 * (temperature / 288.15) ** (9.80665 / (gas_constant * 0.0065))
    return pressure / (gas_constant * temperature)


def equatorial_gravity(altitude: float) -> float:
    """Normal gravity at the equator [m/s^2]: WGS 84's 9.7803253 less the free-air gradient; JSBSim
    flies there by default.
    """
    return 9.7803253 - 3.0877e-6 * altitude


STATES = (
    *("airspeed", "alpha", "beta", "p", "q", "r", "roll", "pitch", "altitude"),
    *("elevator_position", "aileron_position", "propeller_speed"),
)
"""The order of ``state_rates``, in m/s, rad, rad/s, m."""

RATES = (*STATES[:9], "propeller_speed", "heading_rate", "climb_rate")
"""What ``state_rates`` returns: rates of the rigid body and of the propeller, then two outputs."""


def state_rates(state: np.ndarray, throttle: float) -> np.ndarray:
    """Newton and Euler over a flat earth: rates named in ``RATES`` from a state in the order of
    ``STATES``.

    The propeller turns clockwise seen from behind, so the airframe feels minus the motor's torque
    in roll and minus omega x H.
    """
    airspeed, alpha, beta, p, q, r, roll, pitch, altitude, elevator, aileron, propeller = (
        float(x) for x in state
    )
    density = standard_density(altitude)
    air = Air(
        airspeed=airspeed, alpha=alpha, beta=beta, p=p, q=q, r=r, elevator=elevator, aileron=aileron
    )
    ahead = np.array([1.0, 0.0, 0.0])
    velocity = airspeed * np.array(
        [math.cos(alpha) * math.cos(beta), math.sin(beta), math.sin(alpha) * math.cos(beta)]
    )
    rates = np.array([p, q, r])

    specific_force = (
        aero_force(air, density) + thrust(float(velocity[0]), propeller, density) * ahead
    ) / MASS
    to_body = body_from_ned(roll, pitch)
    acceleration = specific_force + to_body @ np.array([0.0, 0.0, equatorial_gravity(altitude)])
    body_acceleration = acceleration - np.cross(rates, velocity)
    airspeed_rate = float(velocity @ body_acceleration) / airspeed
    alpha_rate = (velocity[0] * body_acceleration[2] - velocity[2] * body_acceleration[0]) / (
        velocity[0] ** 2 + velocity[2] ** 2
    )
    beta_rate = (body_acceleration[1] - airspeed_rate * math.sin(beta)) / (
        airspeed * math.cos(beta)
    )

    shaft = motor_torque(throttle, propeller)
    moment = (
        aero_moment(air, density)
        - shaft * ahead
        - np.cross(rates, PROPELLER_INERTIA * propeller * ahead)
    )
    angular_acceleration = np.linalg.solve(INERTIA, moment - np.cross(rates, INERTIA @ rates))
    propeller_rate = (
        shaft - propeller_torque(float(velocity[0]), propeller, density)
    ) / PROPELLER_INERTIA

    roll_rate = p + math.tan(pitch) * (q * math.sin(roll) + r * math.cos(roll))
    pitch_rate = q * math.cos(roll) - r * math.sin(roll)
    velocity_ned, acceleration_ned = to_body.T @ velocity, to_body.T @ acceleration
    course_rate = (
        velocity_ned[0] * acceleration_ned[1] - velocity_ned[1] * acceleration_ned[0]
    ) / (velocity_ned[:2] @ velocity_ned[:2])
    climb_rate = -velocity_ned[2]
    motion = [
        airspeed_rate,
        alpha_rate,
        beta_rate,
        *angular_acceleration,
        roll_rate,
        pitch_rate,
        climb_rate,
    ]
    return np.array([*motion, propeller_rate, course_rate, climb_rate])


def body_from_ned(roll: float, pitch: float, yaw: float = 0.0) -> np.ndarray:
    """Rotation matrix of the 3-2-1 Euler angles [rad], from its three elementary rotations."""
    cr, sr, cp, sp, cy, sy = (f(x) for x in (roll, pitch, yaw) for f in (math.cos, math.sin))
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, cr, sr], [0.0, -sr, cr]])
    about_y = np.array([[cp, 0.0, -sp], [0.0, 1.0, 0.0], [sp, 0.0, cp]])
    about_z = np.array([[cy, sy, 0.0], [-sy, cy, 0.0], [0.0, 0.0, 1.0]])
    return about_x @ about_y @ about_z
