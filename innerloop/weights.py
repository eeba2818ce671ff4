"""What the design asks for, by Bryson's rule: each weight is one over the square of the largest acceptable deviation."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class DesignWeights:
    """Acceptable deviations and the speed of the heading-rate model.

    Attributes
    ----------
    airspeed, pitch, altitude : longitudinal deviations [m/s, rad, m]
    airspeed_integral, altitude_integral : of their time integrals [m, m s]
    elevator, throttle : of the commands [-]
    roll, roll_rate : lateral deviations [rad, rad/s]
    heading_integral : of the time integral of the heading-rate error [rad]
    aileron : of the command [-]
    model_frequency, model_damping : the second-order response to a heading-rate command that the lateral loop follows [rad/s, -]
    altitude_error_max : altitude error that still makes the elevator work harder; 1 m is a climb near 2 m/s [m]
    airspeed_error_max : airspeed error that still makes the throttle work harder [m/s]
    anti_windup_rate : how fast an integrator follows its saturated command [1/s]
    """

    airspeed: float = 1.0
    pitch: float = 0.3
    altitude: float = 0.5
    airspeed_integral: float = 1.5
    altitude_integral: float = 1.0
    elevator: float = 0.15
    throttle: float = 0.15
    roll: float = 0.1
    roll_rate: float = 2.0
    heading_integral: float = 0.06
    aileron: float = 0.2
    model_frequency: float = 6.0
    model_damping: float = 0.9
    altitude_error_max: float = 1.0
    airspeed_error_max: float = 2.0
    anti_windup_rate: float = 2.0
