"""Motion of many vehicles relative to their references, under each steering law.

The variables are not stiff. Positions are d = p_r - p, from the vehicle to its reference. If the
law cancels omega_rho, the course is not a state: with chi = chi_rho + phi the rate of d depends
only on chi_r, z and phi, and phi has a closed form.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from enum import Enum
from typing import Any, NamedTuple, Self

import numpy as np
import numpy.typing as npt

from extensions.convergence.references import Array, TurningReferences
from gnc.numeric import wrapped
from gnc.paper import LookAhead


class Steering(Enum):
    """The steering law of an ensemble."""

    LYAPUNOV = "lyapunov"
    CASCADE = "cascade"
    CASCADE_CUT = "cascade_cut"


@dataclass(frozen=True, slots=True, kw_only=True)
class Vehicle:
    """The common properties of the vehicles in an ensemble.

    Attributes
    ----------
    speed : V, of vehicle and reference [m/s]
    look_ahead : of the delta formulation
    gain : of h(phi) in the cascade law [1/s]
    steering_max : largest h [rad/s]
    k_1 : gain of the Lyapunov law [1/m^2]
    heading_rate_max : omega_max, at which ``Steering.CASCADE_CUT`` cuts its command [rad/s]
    """

    speed: float
    look_ahead: LookAhead
    gain: float
    steering_max: float
    k_1: float
    heading_rate_max: float


class _Geometry(NamedTuple):
    """Unit vector along chi_r, delta [m], z [m] and its length [m], each of shape (n,)."""

    cos_r: Array
    sin_r: Array
    delta: Array
    z_north: Array
    z_east: Array
    rho: Array


class RelativeMotion(ABC):
    """Relative motion of n vehicles.

    A state is d, north and east [m], and for some laws a third component.

    Parameters
    ----------
    vehicle, references : the vehicles and the references that they track
    """

    def __init__(self, vehicle: Vehicle, references: TurningReferences) -> None:
        self._vehicle = vehicle
        self._references = references

    @abstractmethod
    def start(self, to_reference: Array, course: Array) -> Array:
        """Return the first state, shape (states, n), and remember phi.

        Parameters
        ----------
        to_reference : d, shape (2, n) [m]
        course : chi, shape (n,) [rad]
        """

    @abstractmethod
    def take(self, which: npt.NDArray[Any]) -> Self:
        """Return the motion of an index or mask ``which``."""

    @abstractmethod
    def rates(self, time: Array, state: Array) -> Array:
        """Return the rates of the states, shape (states, n), at times of shape (n,) [s]."""

    @abstractmethod
    def phi(self, time: Array, state: Array) -> Array:
        """Return phi [rad], between -pi and pi, shape (n,)."""

    @abstractmethod
    def command(self, time: Array, state: Array, rates: Array) -> Array:
        """Return the commanded heading rate [rad/s], shape (n,), of a state and its rates."""

    def offset_error(self, state: Array, error: Array) -> Array | None:  # noqa: ARG002
        """Return the offset [m] that an error of the third state causes, or None without one."""
        return None

    def _geometry(self, time: Array, state: Array) -> _Geometry:
        """Return the geometry, by equations (14) and (15)."""
        north, east = state[0], state[1]
        chi_r = self._references.course_at(time)
        cos_r, sin_r = np.cos(chi_r), np.sin(chi_r)
        epsilon, radius = self._vehicle.look_ahead
        delta = epsilon * (north * north + east * east) + radius
        z_north, z_east = north + delta * cos_r, east + delta * sin_r
        return _Geometry(
            cos_r, sin_r, delta, z_north, z_east, np.sqrt(z_north * z_north + z_east * z_east)
        )

    def _first_phi(self, to_reference: Array, course: Array) -> Array:
        """Return phi at time 0, the course relative to that of z, between -pi and pi [rad]."""
        geometry = self._geometry(np.zeros_like(course), to_reference)
        cos_v, sin_v = np.cos(course), np.sin(course)
        phi: Array = np.arctan2(
            geometry.z_north * sin_v - geometry.z_east * cos_v,
            geometry.z_north * cos_v + geometry.z_east * sin_v,
        )
        return phi

    def _position_rates(
        self, geometry: _Geometry, cos_phi: Array, sin_phi: Array, out: Array
    ) -> None:
        """Write the rates of d: velocity of the reference less V along z turned by phi."""
        speed = self._vehicle.speed
        along = speed / geometry.rho * cos_phi
        across = speed / geometry.rho * sin_phi
        out[0] = speed * geometry.cos_r - (along * geometry.z_north - across * geometry.z_east)
        out[1] = speed * geometry.sin_r - (along * geometry.z_east + across * geometry.z_north)

    def _omega_rho(
        self, geometry: _Geometry, state: Array, rates: Array, reference_heading_rate: Array
    ) -> Array:
        """Return the rate of the course of z [rad/s], (18), from z and its inertial rate (17)."""
        delta_rate = (
            2.0 * self._vehicle.look_ahead.epsilon * (state[0] * rates[0] + state[1] * rates[1])
        )
        swing = geometry.delta * reference_heading_rate
        north = rates[0] + delta_rate * geometry.cos_r - swing * geometry.sin_r
        east = rates[1] + delta_rate * geometry.sin_r + swing * geometry.cos_r
        turn: Array = (geometry.z_north * east - geometry.z_east * north) / (
            geometry.rho * geometry.rho
        )
        return turn


class CascadeMotion(RelativeMotion):
    """Law (30) with h(phi) = gain phi within a bound; the states are d.

    phi decreases at the bound until gain phi is within it, and decays exponentially from there. It
    does not depend on the reference.
    """

    def start(self, to_reference: Array, course: Array) -> Array:
        """Return the first state and remember phi."""
        self._begin(self._first_phi(to_reference, course))
        return to_reference.copy()

    def _begin(self, phi_0: Array) -> None:
        size = np.abs(phi_0)
        linear = self._vehicle.steering_max / self._vehicle.gain
        self._phi_0 = phi_0
        self._size_below_bound = np.minimum(size, linear)
        self._time_at_bound = np.maximum(size - linear, 0.0) / self._vehicle.steering_max

    def take(self, which: npt.NDArray[Any]) -> Self:
        """Return the motion of an index or mask ``which``."""
        taken = type(self)(self._vehicle, self._references.take(which))
        taken._begin(self._phi_0[which])
        return taken

    def phi(self, time: Array, state: Array) -> Array:  # noqa: ARG002
        """Return phi [rad], the integral of its rate -h(phi) under law (30)."""
        vehicle = self._vehicle
        remaining = self._time_at_bound - time
        size = self._size_below_bound * np.exp(vehicle.gain * np.minimum(remaining, 0.0))
        size += vehicle.steering_max * np.maximum(remaining, 0.0)
        phi: Array = np.copysign(size, self._phi_0)
        return phi

    def rates(self, time: Array, state: Array) -> Array:
        """Return the rates of d, shape (2, n)."""
        phi = self.phi(time, state)
        out = np.empty_like(state)
        self._position_rates(self._geometry(time, state), np.cos(phi), np.sin(phi), out)
        return out

    def command(self, time: Array, state: Array, rates: Array) -> Array:
        """Return the heading rate of equation (30) [rad/s]."""
        vehicle = self._vehicle
        omega_rho = self._omega_rho(
            self._geometry(time, state), state, rates, self._references.heading_rate_at(time)
        )
        steering = np.clip(
            vehicle.gain * self.phi(time, state), -vehicle.steering_max, vehicle.steering_max
        )
        command: Array = omega_rho - steering
        return command


class LyapunovMotion(RelativeMotion):
    """Law (24); the states are d and s, which is k_1 V/2 times the integral of rho.

    With s, sin(phi/2) = sin(phi_0/2) exp(-s), and nothing is singular at phi = pi. There the course
    leaves pi at once, by 2 sqrt(2 s) to first order, to the side of the sign of phi_0. At exactly
    pi, where the law has no value and both sides solve the equation, it turns to the right. Only
    the command is unbounded, as 1/(pi - |phi|), and so briefly that the turn is pi at most.
    """

    def start(self, to_reference: Array, course: Array) -> Array:
        """Return the first state and remember phi."""
        phi_0 = self._first_phi(to_reference, course)
        self._sine_0 = np.sin(0.5 * phi_0)
        self._cosine_0_squared = np.cos(0.5 * phi_0) ** 2
        return np.vstack([to_reference, np.zeros_like(course)])

    def take(self, which: npt.NDArray[Any]) -> Self:
        """Return the motion of an index or mask ``which``."""
        taken = type(self)(self._vehicle, self._references.take(which))
        taken._sine_0 = self._sine_0[which]
        taken._cosine_0_squared = self._cosine_0_squared[which]
        return taken

    def _half(self, state: Array) -> tuple[Array, Array]:
        """Return sine and cosine of phi/2."""
        decay = np.exp(-state[2])
        sine = self._sine_0 * decay
        # cos^2 = cos_0^2 + sin_0^2 (1 - decay^2) has no cancellation towards phi = pi.
        return sine, np.sqrt(
            self._cosine_0_squared + self._sine_0 * self._sine_0 * ((1.0 - decay) * (1.0 + decay))
        )

    def phi(self, time: Array, state: Array) -> Array:  # noqa: ARG002
        """Return phi [rad], the integral of its rate -k_1 rho V tan(phi/2) under law (24)."""
        phi: Array = 2.0 * np.arctan2(*self._half(state))
        return phi

    def rates(self, time: Array, state: Array) -> Array:
        """Return the rates of d and s, shape (3, n)."""
        sine, cosine = self._half(state)
        geometry = self._geometry(time, state)
        out = np.empty_like(state)
        self._position_rates(geometry, 1.0 - 2.0 * sine * sine, 2.0 * sine * cosine, out)
        out[2] = 0.5 * self._vehicle.k_1 * self._vehicle.speed * geometry.rho
        return out

    def command(self, time: Array, state: Array, rates: Array) -> Array:
        """Return the heading rate of equation (24) [rad/s]."""
        sine, cosine = self._half(state)
        geometry = self._geometry(time, state)
        omega_rho = self._omega_rho(geometry, state, rates, self._references.heading_rate_at(time))
        command: Array = (
            omega_rho - self._vehicle.k_1 * geometry.rho * self._vehicle.speed * sine / cosine
        )
        return command

    def offset_error(self, state: Array, error: Array) -> Array | None:
        """Return the offset [m]: error of phi, from that of s, times V and the time 2/(k_1 V R)."""
        arm = 4.0 / (self._vehicle.k_1 * self._vehicle.look_ahead.radius)
        offset: Array = np.abs(arm * self._sine_0 * np.exp(-state[2]) * error[2])
        return offset


class CascadeCutMotion(RelativeMotion):
    """Law (30) with its command cut at omega_max, as flown; the states are d and phi, not wrapped.

    The paper proves nothing about this motion. While the command is cut, phi moves at the rate that
    is left.
    """

    def start(self, to_reference: Array, course: Array) -> Array:
        """Return the first state."""
        return np.vstack([to_reference, self._first_phi(to_reference, course)])

    def take(self, which: npt.NDArray[Any]) -> Self:
        """Return the motion of an index or mask ``which``."""
        return type(self)(self._vehicle, self._references.take(which))

    def phi(self, time: Array, state: Array) -> Array:  # noqa: ARG002
        """Return phi [rad]."""
        return wrapped(state[2])

    def rates(self, time: Array, state: Array) -> Array:
        """Return the rates of d and phi, shape (3, n)."""
        geometry = self._geometry(time, state)
        out = np.empty_like(state)
        self._position_rates(geometry, np.cos(state[2]), np.sin(state[2]), out)
        command, omega_rho = self._command(geometry, time, state, out)
        out[2] = command - omega_rho
        return out

    def command(self, time: Array, state: Array, rates: Array) -> Array:
        """Return the heading rate of equation (30) [rad/s], cut at omega_max."""
        return self._command(self._geometry(time, state), time, state, rates)[0]

    def offset_error(self, state: Array, error: Array) -> Array | None:  # noqa: ARG002
        """Return the offset [m]: the error of phi times V and the time 1/gain."""
        offset: Array = np.abs(self._vehicle.speed / self._vehicle.gain * error[2])
        return offset

    def _command(
        self, geometry: _Geometry, time: Array, state: Array, rates: Array
    ) -> tuple[Array, Array]:
        """Return the command and omega_rho [rad/s]."""
        vehicle = self._vehicle
        omega_rho = self._omega_rho(geometry, state, rates, self._references.heading_rate_at(time))
        steering = np.clip(
            vehicle.gain * wrapped(state[2]), -vehicle.steering_max, vehicle.steering_max
        )
        limit = vehicle.heading_rate_max
        return np.clip(omega_rho - steering, -limit, limit), omega_rho


MOTIONS: dict[Steering, type[RelativeMotion]] = {
    Steering.LYAPUNOV: LyapunovMotion,
    Steering.CASCADE: CascadeMotion,
    Steering.CASCADE_CUT: CascadeCutMotion,
}
"""The motion under each law."""
