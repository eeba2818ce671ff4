"""The autopilot's tables over airspeed and bank: equilibria, linear models, weights and gains.

This module does not need python-control, which is imported only to design an autopilot.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from aircraft.envelope import TABLE_REACH
from aircraft.fdm import TIME_STEP
from aircraft.linearise import LinearModel, Matrix
from aircraft.spec import AircraftSpec, Envelope
from aircraft.trim import Trim
from common.physics import STANDARD_GRAVITY

PERIODS = (1, 2, 3)
"""Possible periods of the autopilot [JSBSim time steps].

A design takes the longest period that its margins allow. Each period divides the number of steps in
which engines are started, so starting engines does not shift the autopilot's phase.
"""

TRIM_BANKS = (-1.0, -0.82, -0.64, -0.4, 0.0, 0.4, 0.64, 0.82, 1.0)
"""Banks of the equilibria over the largest bank of the tables [-]."""

GAIN_BANKS = (-0.82, -0.4, 0.0, 0.4, 0.82)
"""Banks of the linear models and gains over the largest bank; a subset of ``TRIM_BANKS`` [-]."""

LEVEL = TRIM_BANKS.index(0.0)
LEVEL_GAINS = GAIN_BANKS.index(0.0)

LONGITUDINAL = ("airspeed", "climb_rate", "q", "pitch", "altitude")
"""Measured longitudinal states.

Climb rate replaces the angle of attack, which small aircraft do not measure.
"""

LATERAL = ("p", "r", "roll", "beta")
"""Measured lateral states.

Sideslip is measured and fed back only with a rudder; without one it is only in the Riccati
equation.
"""

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class LoopBandwidths:
    """Bandwidths of heading rate, of pitch and altitude, and of airspeed by throttle [rad/s]."""

    lateral: float
    longitudinal: float
    airspeed: float


@dataclass(frozen=True, slots=True, kw_only=True)
class DesignWeights:
    """Acceptable deviations and the response to a heading-rate command, at every airspeed.

    Attributes
    ----------
    airspeed, pitch, pitch_rate, altitude : longitudinal deviations [m/s, rad, rad/s, m]
    airspeed_integral, altitude_integral : deviations of the time integrals [m, m s]
    roll, roll_rate, sideslip : lateral deviations [rad, rad/s, rad]
    heading_integral, sideslip_integral : deviations of the time integrals of heading-rate error and
        sideslip [rad, rad s]
    model_frequency, model_damping : frequency and damping of the second-order response to a
        heading-rate command that the lateral loop follows [rad/s, -]
    altitude_error_max : altitude error at which the feedback is clipped [m]
    airspeed_error_max : airspeed error at which the feedback is clipped [m/s]
    anti_windup_rate : rate at which an integrator follows its saturated command [1/s]
    """

    airspeed: float
    pitch: float
    pitch_rate: float
    altitude: float
    airspeed_integral: float
    altitude_integral: float
    roll: float
    roll_rate: float
    sideslip: float
    heading_integral: float
    sideslip_integral: float
    model_frequency: float
    model_damping: float
    altitude_error_max: float
    airspeed_error_max: float
    anti_windup_rate: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Gains:
    """Feedback at one airspeed and bank.

    Attributes
    ----------
    longitudinal : gains from deviations of ``LONGITUDINAL`` to elevator and throttle [-], shape (2,
        5)
    longitudinal_integral : gains from the integrals of airspeed and altitude error to elevator and
        throttle [-], shape (2, 2)
    lateral : gains from deviations of ``LATERAL`` to aileron and rudder [-], shape (2, 4); the
        rudder's row is 0 without a rudder
    heading_integral : gain from the integral of heading-rate error to bank command [rad/rad]
    sideslip_integral : gain from the integral of sideslip to rudder [1/(rad s)]
    roll_rate_feedforward, roll_acceleration_feedforward : aileron and rudder for the model's roll
        rate and roll acceleration [s, s^2], shape (2,)
    """

    longitudinal: Matrix
    longitudinal_integral: Matrix
    lateral: Matrix
    heading_integral: float
    sideslip_integral: float
    roll_rate_feedforward: Matrix
    roll_acceleration_feedforward: Matrix


@dataclass(frozen=True, slots=True, kw_only=True)
class Schedule:
    """The tables of an autopilot, and the inputs of its design.

    Attributes
    ----------
    spec : the aircraft
    envelope : airspeeds and banks at which the autopilot may fly
    weights : weights of the design
    altitude : altitude of the design [m]
    airspeeds : shape (n,) [m/s], ascending
    trims : equilibria by airspeed, then by bank in the order of ``TRIM_BANKS``
    models : linear models by airspeed, then by bank in the order of ``GAIN_BANKS``
    edges : linear models by airspeed at the first and the last bank of ``TRIM_BANKS``, which have
        no gains
    gains : gains in the order of ``models``
    period : period of the autopilot, one of ``PERIODS`` [JSBSim time steps]
    """

    spec: AircraftSpec
    envelope: Envelope
    weights: DesignWeights
    altitude: float
    airspeeds: tuple[float, ...]
    trims: tuple[tuple[Trim, ...], ...]
    models: tuple[tuple[LinearModel, ...], ...]
    edges: tuple[tuple[LinearModel, LinearModel], ...]
    gains: tuple[tuple[Gains, ...], ...]
    period: int

    @property
    def banks(self) -> tuple[float, ...]:
        """Return the banks of the equilibria [rad], ascending."""
        return table_banks(self.envelope, TRIM_BANKS)

    @property
    def gain_banks(self) -> tuple[float, ...]:
        """Return the banks of models and gains [rad], ascending."""
        return table_banks(self.envelope, GAIN_BANKS)

    @property
    def middle(self) -> int:
        """Return the index of the middle design airspeed."""
        return len(self.airspeeds) // 2

    @property
    def delay(self) -> float:
        """Return the delay between measurement and servo [s]."""
        return loop_delay(self.period)

    @property
    def controls(self) -> tuple[str, ...]:
        """Return the control inputs that the autopilot moves."""
        return tuple(i.name for i in self.spec.inputs)

    def level(self, index: int) -> Trim:
        """Return the straight and level equilibrium at airspeed ``index``."""
        return self.trims[index][LEVEL]

    def gain_trim(self, index: int, bank_index: int) -> Trim:
        """Return the equilibrium at airspeed ``index`` and gain bank ``bank_index``."""
        return self.trims[index][TRIM_BANKS.index(GAIN_BANKS[bank_index])]

    def over_bank(self, quantity: str) -> Array:
        """Return a trim quantity over bank and airspeed, shape (banks, airspeeds).

        ``quantity`` is ``pitch``, ``yaw_rate``, ``p``, ``q``, ``r`` [rad, rad/s] or the name of a
        control input [-].
        """
        return np.array([[_trim_quantity(t, quantity) for t in row] for row in self.trims]).T

    def bank_for_turn(self, turns: Array) -> Array:
        """Return the bank for dimensionless turns V omega/g [rad], shape (turns, airspeeds).

        In a coordinated turn the bank is atan(turns). An aircraft without rudder slips and needs
        more.
        """
        columns = []
        for airspeed, row in zip(self.airspeeds, self.trims, strict=True):
            turn = [airspeed * t.yaw_rate / STANDARD_GRAVITY for t in row]
            columns.append(
                np.tan(_interpolate(turns, np.array(turn), np.array([t.roll for t in row])))
            )
        return np.arctan(np.array(columns).T)

    def turns(self) -> Array:
        """Return the dimensionless turns at which ``bank_for_turn`` is tabulated, shape (29,).

        They extend 5 % beyond the coordinated turn at the largest bank.
        """
        largest = 1.05 * math.tan(self.banks[-1])
        return np.linspace(-largest, largest, 29)


def loop_delay(period: int, late: int = 0) -> float:
    """Return the delay between measurement and servo [s]: one time step plus half a period.

    The time step allows for an on-board computer. In JSBSim airspeed, sideslip and heading rate are
    one step old, but body rates, attitude, altitude and climb rate are read in the step in which
    servos and forces act. Loops with the latter measurements have more margin in JSBSim.

    Parameters
    ----------
    period : period of the autopilot, one of ``PERIODS`` [JSBSim time steps]
    late : additional delay of the commands [periods]
    """
    return (1.0 + (0.5 + late) * period) * TIME_STEP


def table_banks(envelope: Envelope, fractions: Sequence[float]) -> tuple[float, ...]:
    """Return banks from fractions of the tables' largest bank [rad]."""
    return tuple(fraction * TABLE_REACH * envelope.bank_max for fraction in fractions)


def _interpolate(x: Array, at: Array, angles: Array) -> Array:
    """Interpolate the tangent of ``angles`` linearly; past the ends it is proportional to ``x``."""
    tangents = np.tan(angles)
    inside = np.interp(x, at, tangents)
    inside = np.where(x > at[-1], tangents[-1] * x / at[-1], inside)
    return np.arctan(np.where(x < at[0], tangents[0] * x / at[0], inside))


def _trim_quantity(t: Trim, quantity: str) -> float:
    if quantity in ("p", "q", "r"):
        return t.rates_body["pqr".index(quantity)]
    if quantity in t.inputs:
        return t.inputs[quantity]
    return float(getattr(t, quantity))
