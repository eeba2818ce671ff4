"""The cascade law, equation (30)."""

from dataclasses import dataclass, field

from gnc.laws.delta import LookAhead, bare_state, look_ahead, relative_velocity
from gnc.laws.steering_law import check_parameters, steering_law
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
class CascadeLaw:
    """The cascade law on the relative state of the delta formulation: course error and geometry one after the other.

    Attributes
    ----------
    epsilon_per_m : growth of the look-ahead with the squared distance [1/m]
    look_ahead_m : look-ahead on the reference, R [m], above 1/(4 epsilon)
    gain_per_s : slope of h(phi) at 0 [1/s]
    steering_max_rad_s : largest |h(phi)| [rad/s]

    Raises
    ------
    ValueError : a parameter is not finite and above 0, or R is too short
    """

    epsilon_per_m: float = 0.005
    look_ahead_m: float = 60.0
    gain_per_s: float = 1.5
    steering_max_rad_s: float = 0.4
    _look_ahead: LookAhead = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        check_parameters(self)
        object.__setattr__(self, "_look_ahead", look_ahead(self.epsilon_per_m, self.look_ahead_m))

    def heading_rate(self, reference: Reference, to_north: float, to_east: float, course: float, speed: float) -> float:
        """Return the demanded heading rate [rad/s]; parameters are those of ``SteeringLaw``."""
        state = bare_state(self._look_ahead, to_north, to_east, reference.course, course)
        _, omega_rho = relative_velocity(self._look_ahead, state, reference.speed, speed, reference.heading_rate)
        return cascade_law(state[3], omega_rho, self.gain_per_s, self.steering_max_rad_s)
