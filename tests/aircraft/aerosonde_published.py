"""Beard and McLain's equations of motion of the Aerosonde, written down from what they publish:
what JSBSim is compared with.

Nothing here is imported from the packages under test. Source: Beard and McLain, "Small Unmanned
Aircraft: Theory and Practice" (equations by number), and the parameter file they publish with it
(byu-magicc/mavsim_public, mavsim_python/parameters/aerosonde_parameters.py at c08df563). Density
and gravity are arguments, for theirs are not JSBSim's.

Theirs are twelve states, surfaces that move at once and a propeller that turns as fast as it will
at once. ``Lags`` adds what the flown model has besides: first-order servos and a rotor with
inertia.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import root

MASS = 11.0  # kg
JX, JY, JZ, JXZ = 0.8244, 1.135, 1.759, 0.1204  # kg m^2
WING_AREA, SPAN, CHORD, OSWALD = 0.55, 2.8956, 0.18994, 0.9  # m^2, m, m, -
ASPECT_RATIO = SPAN**2 / WING_AREA

CL_0, CL_A, CL_Q, CL_DE = 0.23, 5.61, 7.95, 0.13
CD_P, CD_Q, CD_DE = 0.043, 0.0, 0.0135
CM_0, CM_A, CM_Q, CM_DE = 0.0135, -2.74, -38.21, -0.99
CY_B, CY_P, CY_R, CY_DA, CY_DR = -0.98, 0.0, 0.0, 0.075, 0.19
# Rolling moment, "C_ell" in the source.
CR_B, CR_P, CR_R, CR_DA, CR_DR = -0.13, -0.51, 0.25, 0.17, 0.0024
CN_B, CN_P, CN_R, CN_DA, CN_DR = 0.073, 0.069, -0.095, -0.011, -0.069
STALL_BLEND, STALL_ALPHA = 50.0, 0.47  # 1/rad, rad

PROPELLER_DIAMETER = 20.0 * 0.0254  # m
CT_0, CT_1, CT_2 = 0.09357, -0.06044, -0.1079
CQ_0, CQ_1, CQ_2 = 0.005230, 0.004970, -0.01664
MOTOR_KQ = 60.0 / (2.0 * math.pi * 145.0)  # V s/rad and N m/A, of a 145 rpm/V motor
MOTOR_RESISTANCE = 0.042  # ohm
MOTOR_NO_LOAD = 1.5  # A
BATTERY = 12 * 3.7  # V

STATES = ("u", "v", "w", "roll", "pitch", "yaw", "p", "q", "r", "altitude")
"""Rigid body: m/s, rad, rad/s, m."""

SURFACES = ("elevator", "aileron", "rudder")
FLOWN_STATES = (*STATES, *SURFACES, "propeller_speed")
"""With deflections [rad] and propeller speed [rad/s]."""

FULL_DEFLECTION = (
    0.7854  # rad for a command of 1: the 45 degrees that the authors' autopilot goes to
)


@dataclass(frozen=True)
class World:
    """Air density by altitude, and gravity [kg/m^3, m/s^2]."""

    density_at: object
    gravity: float

    def density(self, altitude: float) -> float:
        return self.density_at(altitude) if callable(self.density_at) else self.density_at


@dataclass(frozen=True)
class Lags:
    """What the flown model adds to the published one: servo pole [rad/s] and inertia of rotor and
    propeller [kg m^2].
    """

    servo: float = 40.0
    rotor_inertia: float = 2.1e-3


def lift_coefficient(alpha: float) -> float:
    """Equation 4.9 with the blend of 4.10."""
    rise, fall = (
        math.exp(-STALL_BLEND * (alpha - STALL_ALPHA)),
        math.exp(STALL_BLEND * (alpha + STALL_ALPHA)),
    )
    sigma = (1.0 + rise + fall) / ((1.0 + rise) * (1.0 + fall))
    flat_plate = 2.0 * math.copysign(1.0, alpha) * math.sin(alpha) ** 2 * math.cos(alpha)
    return (1.0 - sigma) * (CL_0 + CL_A * alpha) + sigma * flat_plate


def drag_coefficient(alpha: float, parasitic: float = CD_P) -> float:
    """Equation 4.11."""
    return parasitic + (CL_0 + CL_A * alpha) ** 2 / (math.pi * OSWALD * ASPECT_RATIO)


def aero(velocity, rates, surfaces, density, parasitic=CD_P):
    """Body force [N] and moment [N m] of the air, equations 4.18 and 4.20 without propeller and
    weight.
    """
    u, v, w = velocity
    airspeed = math.sqrt(u * u + v * v + w * w)
    alpha, beta = math.atan2(w, u), math.asin(v / airspeed)
    p_hat, q_hat, r_hat = (
        rate * length / (2.0 * airspeed)
        for rate, length in zip(rates, (SPAN, CHORD, SPAN), strict=True)
    )
    elevator, aileron, rudder = surfaces
    lift = lift_coefficient(alpha) + CL_Q * q_hat + CL_DE * elevator
    drag = drag_coefficient(alpha, parasitic) + CD_Q * q_hat + CD_DE * elevator
    side = CY_B * beta + CY_P * p_hat + CY_R * r_hat + CY_DA * aileron + CY_DR * rudder
    roll = CR_B * beta + CR_P * p_hat + CR_R * r_hat + CR_DA * aileron + CR_DR * rudder
    pitch = CM_0 + CM_A * alpha + CM_Q * q_hat + CM_DE * elevator
    yaw = CN_B * beta + CN_P * p_hat + CN_R * r_hat + CN_DA * aileron + CN_DR * rudder
    sin_alpha, cos_alpha = math.sin(alpha), math.cos(alpha)
    unit = 0.5 * density * airspeed**2 * WING_AREA
    force = unit * np.array(
        [lift * sin_alpha - drag * cos_alpha, side, -lift * cos_alpha - drag * sin_alpha]
    )
    return force, unit * np.array([SPAN * roll, CHORD * pitch, SPAN * yaw])


def thrust(speed: float, propeller_speed: float, density: float) -> float:
    """Thrust [N] at a speed through the air [m/s] and a propeller speed [rad/s]."""
    n = propeller_speed / (2.0 * math.pi)
    j = speed / (n * PROPELLER_DIAMETER)
    return density * n**2 * PROPELLER_DIAMETER**4 * (CT_0 + CT_1 * j + CT_2 * j**2)


def propeller_torque(speed: float, propeller_speed: float, density: float) -> float:
    """Torque that the air takes [N m]."""
    n = propeller_speed / (2.0 * math.pi)
    j = speed / (n * PROPELLER_DIAMETER)
    return density * n**2 * PROPELLER_DIAMETER**5 * (CQ_0 + CQ_1 * j + CQ_2 * j**2)


def motor_torque(throttle: float, propeller_speed: float) -> float:
    """Torque on the shaft [N m] by the three constants of the motor."""
    return MOTOR_KQ * (
        (BATTERY * throttle - MOTOR_KQ * propeller_speed) / MOTOR_RESISTANCE - MOTOR_NO_LOAD
    )


def settled_propeller_speed(throttle: float, speed: float, density: float) -> float:
    """Speed [rad/s] at which motor and air balance: the positive root of the supplement's
    quadratic.
    """
    a = density * PROPELLER_DIAMETER**5 * CQ_0 / (2.0 * math.pi) ** 2
    b = (
        density * PROPELLER_DIAMETER**4 * CQ_1 * speed / (2.0 * math.pi)
        + MOTOR_KQ**2 / MOTOR_RESISTANCE
    )
    c = (
        density * PROPELLER_DIAMETER**3 * CQ_2 * speed**2
        - MOTOR_KQ * BATTERY * throttle / MOTOR_RESISTANCE
    )
    c += MOTOR_KQ * MOTOR_NO_LOAD
    return (-b + math.sqrt(b * b - 4.0 * a * c)) / (2.0 * a)


def angular_acceleration(rates, moment):
    """Equation 3.17, with the Gammas of 3.13."""
    p, q, r = rates
    roll, pitch, yaw = moment
    gamma = JX * JZ - JXZ**2
    g1, g2 = JXZ * (JX - JY + JZ) / gamma, (JZ * (JZ - JY) + JXZ**2) / gamma
    g3, g4, g5, g6 = JZ / gamma, JXZ / gamma, (JZ - JX) / JY, JXZ / JY
    g7, g8 = ((JX - JY) * JX + JXZ**2) / gamma, JX / gamma
    return np.array(
        [
            g1 * p * q - g2 * q * r + g3 * roll + g4 * yaw,
            g5 * p * r - g6 * (p**2 - r**2) + pitch / JY,
            g7 * p * q - g1 * q * r + g4 * roll + g8 * yaw,
        ]
    )


def state_rates(state, surfaces, thrust_force, shaft_moment, world, parasitic=CD_P):
    """Rates of ``STATES``, equations 3.14 to 3.17, from deflections [rad], thrust [N] and the
    propeller's moment [N m].
    """
    u, v, w, roll, pitch, _, p, q, r, altitude = (float(x) for x in state)
    sr, cr, sp, cp = math.sin(roll), math.cos(roll), math.sin(pitch), math.cos(pitch)
    force, moment = aero((u, v, w), (p, q, r), surfaces, world.density(altitude), parasitic)
    fx, fy, fz = force / MASS + np.array([thrust_force / MASS, 0.0, 0.0])
    gx, gy, gz = -world.gravity * sp, world.gravity * cp * sr, world.gravity * cp * cr
    yaw_rate = (q * sr + r * cr) / cp
    return np.array(
        [
            r * v - q * w + fx + gx,
            p * w - r * u + fy + gy,
            q * u - p * v + fz + gz,
            p + yaw_rate * sp,
            q * cr - r * sr,
            yaw_rate,
            *angular_acceleration((p, q, r), moment + shaft_moment),
            u * sp - v * sr * cp - w * cr * cp,
        ]
    )


def trim_level(airspeed: float, altitude: float, world: World, parasitic: float = CD_P):
    """Straight, level equilibrium without sideslip.

    Returns the state in the order of ``STATES``, deflections in the order of ``SURFACES`` [rad],
    the throttle [-] and the propeller speed [rad/s].
    """

    def unpack(unknowns):
        alpha, roll, elevator, aileron, rudder, throttle = (float(x) for x in unknowns)
        pitch = math.atan(math.tan(alpha) * math.cos(roll))  # no climb without sideslip
        u, w = airspeed * math.cos(alpha), airspeed * math.sin(alpha)
        state = np.array([u, 0.0, w, roll, pitch, 0.0, 0.0, 0.0, 0.0, altitude])
        return state, (elevator, aileron, rudder), throttle

    def residual(unknowns):
        state, surfaces, throttle = unpack(unknowns)
        density = world.density(altitude)
        speed = settled_propeller_speed(throttle, state[0], density)
        torque = np.array([-propeller_torque(state[0], speed, density), 0.0, 0.0])
        rates = state_rates(
            state, surfaces, thrust(state[0], speed, density), torque, world, parasitic
        )
        return [*rates[:3], *rates[6:9]]

    found = root(residual, [0.05, 0.0, -0.1, 0.0, 0.0, 0.7], options={"xtol": 1e-12})
    left = np.abs(residual(found.x)).max()
    if left > 1e-9:
        raise RuntimeError(
            f"no equilibrium at {airspeed} m/s: {left} m/s^2 or rad/s^2 are left; {found.message}"
        )
    state, surfaces, throttle = unpack(found.x)
    return (
        state,
        surfaces,
        throttle,
        settled_propeller_speed(throttle, state[0], world.density(altitude)),
    )


def flown_rates(y, commands, world: World, lags: Lags):
    """Rates of ``FLOWN_STATES``: the published equations with ``lags``, under three commanded
    deflections [rad] and a throttle.

    A rotor with inertia turns the body with the motor's torque rather than the air's, and resists
    being turned: -omega x H. The propeller turns clockwise seen from behind. With a rotor inertia
    of 0 the propeller is the published one: it turns as fast as it will at once, whatever the last
    of ``FLOWN_STATES`` says, and does neither.
    """
    *deflections, throttle = commands
    body, surfaces, propeller = y[:10], y[10:13], float(y[13])
    density = world.density(float(body[9]))
    _, q, r = body[6:9]
    servos = lags.servo * (np.asarray(deflections) - surfaces)
    if lags.rotor_inertia == 0.0:
        speed = settled_propeller_speed(throttle, float(body[0]), density)
        moment = np.array([-propeller_torque(float(body[0]), speed, density), 0.0, 0.0])
        return np.concatenate(
            [
                state_rates(body, surfaces, thrust(float(body[0]), speed, density), moment, world),
                servos,
                [0.0],
            ]
        )
    shaft = motor_torque(throttle, propeller)
    momentum = lags.rotor_inertia * propeller
    moment = np.array([-shaft, -r * momentum, q * momentum])
    pull = thrust(float(body[0]), propeller, density)
    spin = (shaft - propeller_torque(float(body[0]), propeller, density)) / lags.rotor_inertia
    return np.concatenate([state_rates(body, surfaces, pull, moment, world), servos, [spin]])


def fly(y, commands, breaks, world: World, lags: Lags, at):
    """Integrate ``flown_rates`` from ``y``, to one part in a thousand million.

    Parameters
    ----------
    commands : function of time [s] to three deflections [rad] and throttle [-], constant between
        the times ``breaks`` [s]
    at : times of the answers [s], from 0

    Returns
    -------
    array, shape (len(at), 14) : ``FLOWN_STATES``
    """
    rows = []
    for begin, end in zip([0.0, *breaks], [*breaks, at[-1]], strict=True):
        piece = commands(0.5 * (begin + end))
        inside = at[(at >= begin) & ((at < end) | (end == at[-1]))]
        answer = solve_ivp(
            lambda _, x, piece=piece: flown_rates(x, piece, world, lags),
            (begin, end),
            y,
            method="DOP853",
            t_eval=np.union1d(inside, end),
            rtol=1e-9,
            atol=1e-10,
        )
        if not answer.success:
            raise RuntimeError(answer.message)
        rows.append(answer.y[:, : len(inside)].T)
        y = answer.y[:, -1]
    return np.vstack(rows)
