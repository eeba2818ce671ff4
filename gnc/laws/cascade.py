"""The cascade law, equation (30)."""

from dataclasses import dataclass
from typing import ClassVar

from gnc.laws.delta import bare_state, relative_velocity
from gnc.laws.delta_law import DeltaLaw
from gnc.laws.steering_law import steering_law
from gnc.numeric import limited
from gnc.reference.reference import Reference


def h(phi: float, gain: float, rate_max: float) -> float:
    """Return h(phi) [rad/s] of equation (30): gain phi, kept within ``rate_max``. It is 0 at 0 and has the sign of phi elsewhere.

    Parameters
    ----------
    phi : vehicle course against that of z [rad], within -pi and pi
    gain : [1/s], above 0
    rate_max : largest |h| [rad/s], above 0
    """
    return limited(gain * phi, rate_max)


def cascade_law(phi: float, omega_rho: float, gain: float, rate_max: float) -> float:
    """Return omega [rad/s] by the cascade law, equation (30), with h = gain phi within ``rate_max``.

    Parameters
    ----------
    phi : vehicle course against that of z [rad], within -pi and pi
    omega_rho : rate of the course of z [rad/s]
    gain : [1/s], above 0
    rate_max : largest |h| [rad/s], above 0: what h may take of omega_max
    """
    return -h(phi, gain, rate_max) + omega_rho


@steering_law("cascade")
@dataclass(frozen=True, slots=True, kw_only=True)
class CascadeLaw(DeltaLaw):
    """The cascade law on the relative state of the delta formulation: course error and geometry one after the other.

    Attributes
    ----------
    epsilon_per_m, look_ahead_m : as of ``DeltaLaw``
    gain_per_s : slope of h(phi) at 0 [1/s]
    steering_max_rad_s : largest |h(phi)| [rad/s]

    Raises
    ------
    ValueError : as of ``DeltaLaw``
    """

    given: ClassVar[str] = "the reference itself, and its turn rate"
    gain_per_s: float = 1.5
    steering_max_rad_s: float = 0.4

    def heading_rate(self, reference: Reference, to_north: float, to_east: float, course: float, speed: float) -> float:
        """Return the demanded heading rate [rad/s]; parameters are those of ``SteeringLaw``."""
        state = bare_state(self._look_ahead, to_north, to_east, reference.course, course)
        _, omega_rho = relative_velocity(self._look_ahead, state, reference.speed, speed, reference.heading_rate)
        return cascade_law(state[3], omega_rho, self.gain_per_s, self.steering_max_rad_s)
