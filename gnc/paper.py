"""The guidance and control of the paper, equation by equation, in the paper's order.

D. Escudeiro, "UAV-based Measurement of Marine Vessels Smoke Plumes - Guidance and Control System".
``# (N)`` marks the line that computes equation (N). Positions are north and east, in metres;
courses are clockwise from north, in radians. The paper's symbols are::

    V_r, V_V         speeds of vehicle and reference, and of the vessel
    chi, omega       course and heading rate of the vehicle; with the index r of the reference
    nu               speed ratio, V_V/V_r
    eta, omega_0     course amplitude A/omega_0 and frequency of the reference's oscillation
    CO, r_CO         centre of oscillation, and its distance from the vessel
    d, delta, z      from vehicle to reference, look-ahead along the reference's course, d + delta
    rho, phi, phi_r  length of z, and courses of vehicle and reference relative to the course of z

``EQUATIONS.md`` lists where the code differs from the paper, and misprints of the paper.
"""

import functools
import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from common.physics import STANDARD_GRAVITY
from gnc.errors import InfeasibleError
from gnc.numeric import limited, wrap
from gnc.reference.reference import Array, Orbit

# SciPy is imported where it is used, because `describe` needs the steering laws only.

# --- II.B Vehicle dynamics


def unicycle_rates(speed: float, course: float, heading_rate: float) -> tuple[float, float, float]:
    """Return north rate, east rate [m/s] and course rate [rad/s] of a unicycle.

    Equation (1) for the vehicle, and (13) for any reference that it can follow.
    """
    return speed * math.cos(course), speed * math.sin(course), heading_rate  # (1)  # (13)


# --- III.C The oscillation of the reference


def mean_speed_ratio(eta: float) -> float:
    """Return F(eta) = J_0(eta), the ratio of the reference's mean speed to its speed, (5) [-]."""
    from scipy.special import j0

    return float(j0(eta))  # (5)


def eta_for_speed_ratio(nu: float) -> float:
    """Return the course amplitude eta = J_0^-1(nu) [rad], equation (6).

    With this amplitude the reference's mean speed equals the vessel's speed.

    Raises
    ------
    InfeasibleError : ``nu`` is outside 0 to 1, where J_0 on [0, 2.4048] has no inverse
    """
    from scipy.optimize import brentq

    if not (math.isfinite(nu) and 0.0 <= nu <= 1.0):
        raise InfeasibleError(
            f"speed ratio nu is {nu:g}; it must lie within 0 and 1: give the vessel a speed from 0"
            " up to the speed of the UAV"
        )
    if nu == 1.0:
        return 0.0
    eta = brentq(lambda eta: mean_speed_ratio(eta) - nu, 0.0, 2.5, xtol=1e-15, rtol=1e-14)  # (6)
    return float(eta)


@dataclass(frozen=True, slots=True, kw_only=True)
class Oscillation:
    """The paper's orbit: a sinusoidal oscillation of the course about the vessel's course.

    Attributes
    ----------
    nu : speed ratio [-]
    speed : V_r [m/s]
    eta : course amplitude [rad]
    omega_0 : frequency [rad/s]
    limit : what limits the frequency, ``heading rate`` or ``roll rate``
    """

    nu: float
    speed: float
    eta: float
    omega_0: float
    limit: str

    @property
    def amplitude(self) -> float:
        """A, the amplitude of the reference's heading rate [rad/s]."""
        return self.eta * self.omega_0

    @property
    def symmetric(self) -> bool:
        """True: the second half of the orbit is the mirror image of the first."""
        return True

    @property
    def period(self) -> float:
        """T = 2 pi/omega_0 [s]."""
        return 2.0 * math.pi / self.omega_0

    @property
    def crossing_interval(self) -> float:
        """Time between crossings of the centre of oscillation, half a period [s]."""
        return math.pi / self.omega_0

    def course(self, phase: float) -> float:
        """Return the course relative to the vessel's course, at a phase omega_0 t + phi_0 [rad].

        Equation (3), and (7) at the start, where the phase is phi_0.
        """
        return self.eta * math.cos(phase)  # (3)  # (7)

    def velocity(self, phase: float) -> tuple[float, float]:
        """Return the velocity along the vessel's course and to its right, equation (4) [m/s]."""
        course = self.course(phase)
        return self.speed * math.cos(course), self.speed * math.sin(course)  # (4)

    def heading_rate(self, phase: float) -> float:
        """Return omega_r at a phase omega_0 t + phi_0, for a vessel that does not turn [rad/s].

        This is the third line of equation (2) with omega_V = 0; the first two are as in (1).
        """
        return -self.amplitude * math.sin(phase)  # (2)

    def offset(self, time: npt.ArrayLike) -> tuple[Array, Array]:
        """Return the reference's offset from the CO, see ``offset`` [m]."""
        return offset(self, time)

    def half_widths(self) -> tuple[float, float]:
        """Return the orbit's half-widths, see ``half_widths`` [m]."""
        return half_widths(self)

    def sidebands(self, orders: npt.NDArray[np.int64]) -> Array:
        """Return the power of the orbit's harmonics, J_n(eta)^2 (Jacobi-Anger) [-]."""
        from scipy.special import jv

        return np.asarray(jv(orders, self.eta) ** 2)


def available_heading_rate(
    *,
    nu: float,
    speed: float,
    heading_rate_max: float,
    reserve: float,
    vessel_heading_rate: float,
    roll_rate_max: float,
) -> float:
    """Return the heading rate available to the oscillation, the numerator of equation (8) [rad/s].

    Parameters
    ----------
    nu : speed ratio [-]
    speed : V_r [m/s]
    heading_rate_max : omega_max [rad/s]
    reserve : fraction of omega_max that is left to the feedback; 0 in the paper [-]
    vessel_heading_rate : omega_V [rad/s]
    roll_rate_max : largest roll rate of the vehicle [rad/s]

    Raises
    ------
    InfeasibleError : nu is not within 0 and 1, a limit is not above 0, or nothing of omega_max is
        left
    """
    for name, value, unit in (
        ("speed", speed, "m/s"),
        ("heading_rate_max", heading_rate_max, "rad/s"),
        ("roll_rate_max", roll_rate_max, "rad/s"),
    ):
        if not value > 0.0:
            raise InfeasibleError(
                f"{name} is {value:g} {unit}; it must be above 0: give what the vehicle can fly"
            )
    if not 0.0 <= reserve < 1.0:
        raise InfeasibleError(
            f"reserve is {reserve:g} of omega_max; it must be at least 0 and below 1: a tenth is"
            " enough"
        )
    if nu >= 1.0:
        raise InfeasibleError(
            f"speed ratio nu is {nu:g}; it must be below 1: at 1 the reference flies straight and"
            " never crosses the plume, above 1 the vessel outruns the UAV; fly faster"
        )
    if not nu >= 0.0:
        raise InfeasibleError(
            f"speed ratio nu is {nu:g}; it must lie within 0 and 1: give the vessel a speed up to"
            " the speed of the UAV"
        )
    available = (1.0 - reserve) * heading_rate_max - abs(vessel_heading_rate)
    if not available > 0.0:
        raise InfeasibleError(
            f"vessel heading rate is {vessel_heading_rate:g} rad/s; with a reserve of {reserve:g}"
            f" it must stay below {(1.0 - reserve) * heading_rate_max:g} rad/s: raise omega_max or"
            " lower the reserve"
        )
    return available


def design_oscillation(
    *,
    nu: float,
    speed: float,
    heading_rate_max: float,
    reserve: float = 0.0,
    vessel_heading_rate: float = 0.0,
    roll_rate_max: float = math.inf,
) -> Oscillation:
    """Return the fastest oscillation that the vehicle can follow, by equation (8).

    As nu approaches 1, equation (8) allows any frequency, so omega_0 is also limited by the roll
    rate. Near level flight the heading acceleration, whose amplitude is eta omega_0^2, is g/V times
    the roll rate. Parameters and errors are as in ``available_heading_rate``.
    """
    available = available_heading_rate(
        nu=nu,
        speed=speed,
        heading_rate_max=heading_rate_max,
        reserve=reserve,
        vessel_heading_rate=vessel_heading_rate,
        roll_rate_max=roll_rate_max,
    )
    eta = eta_for_speed_ratio(nu)
    by_heading_rate = available / eta  # (8)
    by_roll_rate = math.sqrt(STANDARD_GRAVITY * roll_rate_max / (speed * eta))
    limit = "heading rate" if by_heading_rate <= by_roll_rate else "roll rate"
    return Oscillation(
        nu=nu, speed=speed, eta=eta, omega_0=min(by_heading_rate, by_roll_rate), limit=limit
    )


# --- III.D Positioning of the centre of oscillation

_TERMS = np.arange(1, 25)
_ODD = 2 * _TERMS - 1
_ORBIT_POINTS = 7201


@functools.lru_cache(maxsize=8)
def _series(eta: float, omega_0: float) -> tuple[Array, Array]:
    """Return the Jacobi-Anger coefficients of F_x and F_y [s]; a dozen terms are enough."""
    from scipy.special import jv

    along = (-1.0) ** _TERMS * jv(2 * _TERMS, eta) / (_TERMS * omega_0)
    across = 2.0 * (-1.0) ** (_TERMS - 1) * jv(_ODD, eta) / (_ODD * omega_0)
    return along, across


def f_x(oscillation: Orbit, time: npt.ArrayLike) -> Array:
    """Return F_x of (12), the integral of cos[eta cos(omega_0 t)] from 0 to ``time`` [s]."""
    t = np.asarray(time, dtype=np.float64)[..., None]
    series, _ = _series(oscillation.eta, oscillation.omega_0)
    return np.asarray(
        oscillation.nu * t[..., 0]
        + np.sum(series * np.sin(2 * _TERMS * oscillation.omega_0 * t), axis=-1)
    )


def f_y(oscillation: Orbit, time: npt.ArrayLike) -> Array:
    """Return F_y of (12), the integral of sin[eta cos(omega_0 t)] from 0 to ``time`` [s]."""
    t = np.asarray(time, dtype=np.float64)[..., None]
    _, series = _series(oscillation.eta, oscillation.omega_0)
    return np.asarray(np.sum(series * np.sin(_ODD * oscillation.omega_0 * t), axis=-1))


def offset(oscillation: Orbit, time: npt.ArrayLike) -> tuple[Array, Array]:
    """Return d_x and d_y, the reference's offset from the CO for phi_0 = 0 [m].

    d_x is along the vessel's course and d_y to its right, each in the shape of ``time`` [s].
    """
    t = np.asarray(time, dtype=np.float64)
    along = oscillation.speed * (f_x(oscillation, t) - oscillation.nu * t)
    across = oscillation.speed * f_y(oscillation, t)
    return along, across


def half_widths(oscillation: Orbit) -> tuple[float, float]:
    """Return |d_x|max and |d_y|max, the half-widths along and across the vessel's course [m]."""
    t_x = math.acos(min(1.0, math.acos(oscillation.nu) / oscillation.eta)) / oscillation.omega_0
    t_y = 0.5 * math.pi / oscillation.omega_0
    along, _ = offset(oscillation, t_x)
    _, across = offset(oscillation, t_y)
    return abs(float(along)), abs(float(across))  # (12)


@dataclass(frozen=True, slots=True, kw_only=True)
class PlumeAxis:
    """Direction of the plume as seen from the vessel.

    Attributes
    ----------
    heading : chi_P, clockwise from the vessel's bow [rad]; pi is straight astern
    elevation : alpha_P, angle above the horizon [rad]
    """

    heading: float
    elevation: float = 0.0


def centre_of_oscillation(distance: float, axis: PlumeAxis) -> tuple[float, float, float]:
    """Return the position of the CO ahead, right and above the plume's origin, (9) [m].

    Parameters
    ----------
    distance : r_CO, along the axis [m]
    axis : axis of the plume
    """
    horizontal = distance * math.cos(axis.elevation)
    return (
        horizontal * math.cos(axis.heading),
        horizontal * math.sin(axis.heading),
        distance * math.sin(axis.elevation),
    )  # (9)


def distance_by_paper(orbit: Orbit, axis: PlumeAxis, distance_min: float) -> float:
    """Return r_CO by the paper's rule, equation (10) [m].

    Parameters
    ----------
    orbit : orbit of the reference
    axis : axis of the plume
    distance_min : r_min, radius of the keep-out sphere [m]

    Raises
    ------
    InfeasibleError : ``distance_min`` or the axis is out of range
    """
    _check(axis, distance_min)
    return distance_min + reach(orbit, axis) * math.cos(axis.elevation)  # (10)


def reach(orbit: Orbit, axis: PlumeAxis) -> float:
    """Return d_max, the paper's estimate of the orbit's extent towards the vessel, (11) [m].

    For a figure of eight, which has equal halves and is wider than long, d_max is not below the
    true extent. Other orbits may extend farther.
    """
    along, across = orbit.half_widths()
    return along + (across - along) * abs(math.sin(axis.heading))  # (11)


def distance_exact(orbit: Orbit, axis: PlumeAxis, distance_min: float) -> float:
    """Return the smallest r_CO at which the whole orbit keeps r_min from the plume's origin [m].

    For every point o of the orbit, |r_CO u + o| >= r_min gives a lower bound of r_CO, the larger
    root of a quadratic; the result is the largest bound. Differs from equation (10) because (11)
    overestimates the orbit's extent except for a plume abeam: by up to 10 m for a level plume and
    r_min = 200 m.

    Raises
    ------
    InfeasibleError : ``distance_min`` or the axis is out of range
    """
    from scipy.optimize import minimize_scalar

    _check(axis, distance_min)

    def needed(time: npt.ArrayLike) -> Array:
        along, across = orbit.offset(time)
        towards = math.cos(axis.elevation) * (
            along * math.cos(axis.heading) + across * math.sin(axis.heading)
        )
        inside = towards**2 - along**2 - across**2 + distance_min**2
        # If the root is imaginary, the line through the point never enters the sphere.
        return np.where(inside >= 0.0, -towards + np.sqrt(np.maximum(inside, 0.0)), 0.0)

    times = np.linspace(0.0, orbit.period, _ORBIT_POINTS)
    step = float(times[1])
    coarse = float(times[np.argmax(needed(times))])
    fine = minimize_scalar(
        lambda t: -float(needed(t)), bounds=(coarse - step, coarse + step), method="bounded"
    )
    return max(-float(fine.fun), 0.0)


def _check(axis: PlumeAxis, distance_min: float) -> None:
    if not (math.isfinite(distance_min) and distance_min >= 0.0):
        raise InfeasibleError(
            f"keep-out radius is {distance_min:g} m; it must be finite and at least 0"
        )
    if not math.isfinite(axis.heading):
        raise InfeasibleError(f"plume heading is {axis.heading:g} rad; it must be finite")
    if not abs(axis.elevation) < 0.5 * math.pi:
        raise InfeasibleError(
            f"plume elevation is {axis.elevation:g} rad; it must lie within -pi/2 and pi/2: a"
            " vertical plume cannot be crossed"
        )


# --- IV.B The error formulation


class LookAhead(NamedTuple):
    """Parameters of the look-ahead, delta = epsilon d^2 + R: equation (15).

    Attributes
    ----------
    epsilon : [1/m]
    radius : R [m], above 1/(4 epsilon)
    """

    epsilon: float
    radius: float


class RelativeState(NamedTuple):
    """The four states of equation (19).

    Attributes
    ----------
    delta : length of the look-ahead vector [m]
    rho : length of z, from the vehicle to the end of the look-ahead vector [m]
    phi_r : reference's course relative to the course of z [rad]
    phi : vehicle's course relative to the course of z [rad]
    """

    delta: float
    rho: float
    phi_r: float
    phi: float


def look_ahead(epsilon: float, radius: float) -> LookAhead:
    """Return the parameters of the look-ahead after a check.

    Raises
    ------
    InfeasibleError : R <= 1/(4 epsilon), so that delta may be shorter than d, and z may vanish
    """
    if not (math.isfinite(epsilon) and epsilon > 0.0):
        raise InfeasibleError(
            f"look-ahead epsilon is {epsilon:g} 1/m; it must be finite and above 0"
        )
    if not (math.isfinite(radius) and radius > 1.0 / (4.0 * epsilon)):
        raise InfeasibleError(
            f"look-ahead R is {radius:g} m; it must exceed 1/(4 epsilon) ="
            f" {1.0 / (4.0 * epsilon):g} m: raise R or epsilon"
        )
    return LookAhead(epsilon, radius)


def delta_length(parameters: LookAhead, distance_squared: float) -> float:
    """Return delta [m] for a squared distance d^2 [m^2], equation (15)."""
    return parameters.epsilon * distance_squared + parameters.radius  # (15)


def relative_state(
    parameters: LookAhead,
    to_reference_north: float,
    to_reference_east: float,
    reference_course: float,
    course: float,
) -> RelativeState:
    """Return the relative state: equations (14), (16) and (19).

    Parameters
    ----------
    parameters : parameters of the look-ahead
    to_reference_north, to_reference_east : d, from the vehicle to the reference [m]
    reference_course, course : chi_r and chi [rad]
    """
    delta = delta_length(
        parameters, to_reference_north * to_reference_north + to_reference_east * to_reference_east
    )
    z_north = to_reference_north + delta * math.cos(reference_course)  # (14)
    z_east = to_reference_east + delta * math.sin(reference_course)  # (14)
    rho, z_course = math.hypot(z_north, z_east), math.atan2(z_east, z_north)  # (16)
    phi_r, phi = wrap(reference_course - z_course), wrap(course - z_course)
    return RelativeState(delta, rho, phi_r, phi)  # (19)


def distance_squared(state: RelativeState) -> float:
    """Return d^2 [m^2] from the relative state, by the law of cosines."""
    return state.rho**2 + state.delta**2 - 2.0 * state.rho * state.delta * math.cos(state.phi_r)


def distance_squared_rate(state: RelativeState, reference_speed: float, speed: float) -> float:
    """Return the rate of d^2, which is equation (20) if both speeds are V_r [m^2/s].

    Differs from the paper because a real aircraft's speed is V_r only on average: d . d-dot = d .
    (v_r - v), resolved along and across z.
    """
    delta, rho, phi_r, phi = state
    cos_r, sin_r = math.cos(phi_r), math.sin(phi_r)
    along = reference_speed * cos_r - speed * math.cos(phi)
    across = reference_speed * sin_r - speed * math.sin(phi)
    return 2.0 * ((rho - delta * cos_r) * along - delta * sin_r * across)  # (20)


def relative_velocity(
    parameters: LookAhead,
    state: RelativeState,
    reference_speed: float,
    speed: float,
    reference_heading_rate: float,
) -> tuple[float, float]:
    """Return the rates of rho [m/s] and of the course of z, omega_rho [rad/s]: equation (18).

    (17) is the rate of z in the inertial frame; (18) has its components along and across z.

    Parameters
    ----------
    parameters, state : look-ahead and relative state
    reference_speed, speed : speeds of reference and vehicle; both V_r in the paper [m/s]
    reference_heading_rate : omega_r [rad/s]
    """
    delta, rho, phi_r, phi = state
    cos_r, sin_r = math.cos(phi_r), math.sin(phi_r)
    along = reference_speed * cos_r - speed * math.cos(phi)
    across = reference_speed * sin_r - speed * math.sin(phi)
    # This repeats epsilon times (20): the function runs at each step of the guidance, and a call
    # would compute each sine and cosine twice.
    delta_rate = parameters.epsilon * (
        2.0 * ((rho - delta * cos_r) * along - delta * sin_r * across)
    )
    delta_turn_speed = delta * reference_heading_rate
    rho_rate = along - delta_turn_speed * sin_r + delta_rate * cos_r  # (17)  # (18)
    omega_rho = (across + delta_turn_speed * cos_r + delta_rate * sin_r) / rho  # (18)
    return rho_rate, omega_rho


def state_rates(
    parameters: LookAhead,
    state: RelativeState,
    speed: float,
    reference_heading_rate: float,
    heading_rate: float,
) -> RelativeState:
    """Return the rates of the four states, the nominal system (21).

    Parameters
    ----------
    parameters, state : look-ahead and relative state
    speed : V_r [m/s]
    reference_heading_rate, heading_rate : omega_r and omega [rad/s]
    """
    rho_rate, omega_rho = relative_velocity(parameters, state, speed, speed, reference_heading_rate)
    delta_rate = parameters.epsilon * distance_squared_rate(state, speed, speed)
    return RelativeState(
        delta_rate, rho_rate, reference_heading_rate - omega_rho, heading_rate - omega_rho
    )  # (21)


# --- IV.C Lyapunov-based controller


def equilibrium(parameters: LookAhead) -> RelativeState:
    """Return the equilibrium on the reference, x_d = [R, R, 0, 0]."""
    return RelativeState(parameters.radius, parameters.radius, 0.0, 0.0)


def v_1(state: RelativeState) -> float:
    """Return V_1 = d^2/2, equation (22) [m^2].

    V_1 is positive definite about the equilibrium, not about 0, among states that satisfy (15).
    """
    return 0.5 * distance_squared(state)  # (22)


def v_1_rate(state: RelativeState, speed: float) -> float:
    """Return the rate of V_1 along (21), for any control, equation (23) [m^2/s]."""
    delta, rho, phi_r, phi = state
    return speed * (
        -rho * (1.0 - math.cos(phi_r))
        - delta * (1.0 - math.cos(phi_r - phi))
        + rho * (1.0 - math.cos(phi))
    )  # (23)


def lyapunov_law(state: RelativeState, speed: float, omega_rho: float, k_1: float) -> float:
    """Return omega by the Lyapunov-based law, equation (24), which is singular at phi = pi [rad/s].

    The paper has sin(phi)/(1 + cos(phi)), which equals tan(phi/2).

    Parameters
    ----------
    state : relative state
    speed : V_r [m/s]
    omega_rho : rate of the course of z [rad/s]
    k_1 : gain [1/m^2]
    """
    return -k_1 * state.rho * speed * math.tan(0.5 * state.phi) + omega_rho  # (24)


def v_2(state: RelativeState, k_2: float) -> float:
    """Return V_2 = V_1 + k_2 (1 - cos phi), equation (25) [m^2]."""
    return v_1(state) + k_2 * (1.0 - math.cos(state.phi))  # (25)


def v_2_rate(state: RelativeState, speed: float) -> float:
    """Return the rate of V_2 under law (24) with k_1 k_2 = 1, equation (26) [m^2/s].

    The rate is never positive. Other gains add (1 - k_1 k_2) rho V_r (1 - cos phi), so V_2 does not
    rise for k_1 k_2 > 1 either.
    """
    delta, rho, phi_r, phi = state
    return -speed * (rho * (1.0 - math.cos(phi_r)) + delta * (1.0 - math.cos(phi_r - phi)))  # (26)


def v_2_second_rate(state: RelativeState, rates: RelativeState, speed: float) -> float:
    """Return the second rate of V_2 under law (24), equation (27) [m^2/s^2].

    This rate is bounded, so the first rate goes to zero. The two limits below follow; tests verify
    them by convergence.
    """
    delta, rho, phi_r, phi = state
    return -speed * (
        rates.rho * (1.0 - math.cos(phi_r))
        + rho * rates.phi_r * math.sin(phi_r)
        + (rates.phi_r - rates.phi) * delta * math.sin(phi_r - phi)
        + rates.delta * (1.0 - math.cos(phi_r - phi))
    )  # (27)
    # (28): the rate (26) goes to zero, and is zero only at phi_r = phi = 0: both go to zero.
    # (29): the rate of phi_r goes to zero, too (Barbalat), if omega_r and its rate are bounded.


# --- IV.D Nonlinear cascade system approach


def h(phi: float, gain: float, rate_max: float) -> float:
    """Return h(phi) of equation (30): gain times phi, limited to ``rate_max`` [rad/s].

    h is 0 at 0 and has the sign of phi elsewhere, as (30) requires.
    """
    return limited(gain * phi, rate_max)


def cascade_law(phi: float, omega_rho: float, gain: float, rate_max: float) -> float:
    """Return omega by the cascade law, equation (30) [rad/s]; parameters are as in ``h``."""
    return -h(phi, gain, rate_max) + omega_rho  # (30)


class DrivenState(NamedTuple):
    """The driven state x_1 of (22) and (31a): the relative state (19) without phi.

    Attributes
    ----------
    delta, rho, phi_r : same as in ``RelativeState``
    """

    delta: float
    rho: float
    phi_r: float


def driven_rates(
    parameters: LookAhead,
    driven: DrivenState,
    phi: float,
    speed: float,
    reference_heading_rate: float,
) -> DrivenState:
    """Return the rates of the driven subsystem with the input phi, equation (31a).

    They are the first three lines of (21).
    """
    rates = state_rates(parameters, RelativeState(*driven, phi), speed, reference_heading_rate, 0.0)
    return DrivenState(rates.delta, rates.rho, rates.phi_r)  # (31)  # (31a)


def driving_rate(phi: float, gain: float, rate_max: float) -> float:
    """Return the rate of phi, the driving subsystem (31b): (21) under law (30) [rad/s]."""
    return -h(phi, gain, rate_max)  # (31)  # (31b)


def unforced_rates(
    parameters: LookAhead, driven: DrivenState, speed: float, reference_heading_rate: float
) -> DrivenState:
    """Return the rates of the driven subsystem at phi = 0, equation (32).

    Differs from the paper because the paper's first line lacks the factor V_r of (21), without
    which it is not a speed.
    """
    delta, rho, phi_r = driven
    cos_r, sin_r = math.cos(phi_r), math.sin(phi_r)
    delta_turn_speed = delta * reference_heading_rate
    shrinking = 2.0 * parameters.epsilon * speed * (rho + delta) * (1.0 - cos_r)
    return DrivenState(
        -shrinking,
        -speed * (1.0 - cos_r) - delta_turn_speed * sin_r - cos_r * shrinking,
        reference_heading_rate
        - (speed * sin_r + delta_turn_speed * cos_r - sin_r * shrinking) / rho,
    )  # (32)


def v_1_unforced_rate(driven: DrivenState, speed: float) -> float:
    """Return the rate of V_1 along the unforced system, (33), which is never positive [m^2/s]."""
    return -speed * (driven.rho + driven.delta) * (1.0 - math.cos(driven.phi_r))  # (33)


def v_1_unforced_second_rate(driven: DrivenState, rates: DrivenState, speed: float) -> float:
    """Return the second rate of V_1 along (32), equation (34) [m^2/s^2].

    This rate is bounded, so the rate of V_1 goes to zero.
    """
    delta, rho, phi_r = driven
    return -speed * (
        (rates.rho + rates.delta) * (1.0 - math.cos(phi_r))
        + (rho + delta) * rates.phi_r * math.sin(phi_r)
    )  # (34)


def v_1_rate_split(state: RelativeState, speed: float) -> float:
    """Return the rate of V_1 along (21) in the form of equation (35) [m^2/s].

    This is (23) rearranged, so that no term is positive for |phi| <= |phi_r|.
    """
    delta, rho, phi_r, phi = state
    return -speed * (
        rho * (math.cos(phi) - math.cos(phi_r)) + delta * (1.0 - math.cos(phi - phi_r))
    )  # (35)


# --- Why trajectories are bounded: EQUATIONS.md, from (35)


def excursion_time(phi: float, gain: float, rate_max: float) -> float:
    """Return the integral of 1 - cos(phi) over time along (31b), from ``phi`` to rest [s].

    Parameters are as in ``h``. With dt = -dphi/h, the part with h = gain phi gives the entire
    cosine integral at the angle where h begins to saturate, and the part with h = rate_max an
    elementary integral.
    """
    size = abs(phi)
    free = min(size, rate_max / gain)
    # Up to pi, fourteen terms are exact except for rounding.
    entire_cosine = sum(
        (-1.0) ** (k + 1) * free ** (2 * k) / (2 * k * math.factorial(2 * k)) for k in range(1, 15)
    )
    return entire_cosine / gain + (size - free - math.sin(size) + math.sin(free)) / rate_max


def delta_bound(
    parameters: LookAhead, state: RelativeState, speed: float, gain: float, rate_max: float
) -> float:
    """Return a bound that delta never exceeds under law (30), for any reference [m].

    By (15) it is also a bound of d. Differs from the paper's argument after equation (35), that d
    no longer rises after some time, which does not hold.
    """
    rho_to_delta = 1.0 + 0.5 / math.sqrt(parameters.epsilon * parameters.radius)
    exponent = (
        2.0 * parameters.epsilon * speed * rho_to_delta * excursion_time(state.phi, gain, rate_max)
    )
    return state.delta * math.exp(exponent)
