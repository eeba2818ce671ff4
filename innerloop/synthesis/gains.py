"""The feedback of the autopilot at one airspeed and bank, and the measured states that it acts on."""

from dataclasses import dataclass

from aircraft.linearise import Matrix

LONGITUDINAL = ("airspeed", "climb_rate", "q", "pitch", "altitude")
"""Measured longitudinal states. Climb rate stands for angle of attack, which small aircraft do not
measure.
"""

LATERAL = ("p", "r", "roll", "beta")
"""Measured lateral states. Sideslip is fed back where there is a rudder to act on it; without one,
it is not measured, and stays in the Riccati equation only."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Gains:
    """Feedback at one airspeed and bank.

    Attributes
    ----------
    airspeed, bank : [m/s, rad]
    longitudinal : shape (2, 5), from deviations of ``LONGITUDINAL`` to elevator and throttle [-]
    longitudinal_integral : shape (2, 2), from the integrals of airspeed and altitude error to
        elevator and throttle [-]
    lateral : shape (2, 4), from deviations of ``LATERAL`` to aileron and rudder [-]; zero without a
        rudder
    heading_integral : from the integral of heading-rate error to bank command [rad/rad]
    sideslip_integral : from the integral of sideslip to rudder [1/(rad s)]
    roll_rate_feedforward, roll_acceleration_feedforward : shape (2,), aileron and rudder for the
        model's roll rate and acceleration [s, s^2]
    """

    airspeed: float
    bank: float
    longitudinal: Matrix
    longitudinal_integral: Matrix
    lateral: Matrix
    heading_integral: float
    sideslip_integral: float
    roll_rate_feedforward: Matrix
    roll_acceleration_feedforward: Matrix
