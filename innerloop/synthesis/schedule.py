"""The autopilot's tables over airspeed and bank: equilibria (turn compensation), linear models, and
gains.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from aircraft.envelope import TABLE_REACH
from aircraft.linearise import LinearModel
from aircraft.spec import AircraftSpec, Envelope
from aircraft.trim import Trim
from common.physics.units import STANDARD_GRAVITY
from innerloop.synthesis.gains import Gains
from innerloop.synthesis.rate import loop_delay
from innerloop.synthesis.weights import DesignWeights

TRIM_BANKS = (-1.0, -0.82, -0.64, -0.4, 0.0, 0.4, 0.64, 0.82, 1.0)
"""Banks of the equilibria, over the largest of the tables [-]."""

GAIN_BANKS = (-0.82, -0.4, 0.0, 0.4, 0.82)
"""Those of them at which there are linear models and gains [-]."""

LEVEL = TRIM_BANKS.index(0.0)
LEVEL_GAINS = GAIN_BANKS.index(0.0)

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Schedule:
    """The tables of an autopilot, and what they were made from.

    Attributes
    ----------
    spec : the aircraft
    envelope : in which it may fly
    weights : of the design
    altitude : at which it was designed [m]
    airspeeds : shape (n,) [m/s], ascending
    trims : equilibria by airspeed, then by bank in the order of ``TRIM_BANKS``
    models : linear models by airspeed, then by bank in the order of ``GAIN_BANKS``
    edges : linear models by airspeed, at the least and the largest bank of ``TRIM_BANKS``, for
        which no gains are designed
    gains : as ``models``
    period : time steps from one computation of the autopilot to the next
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
        """Return the equilibrium of the model at airspeed ``index`` and gain bank ``bank_index``."""
        return self.trims[index][TRIM_BANKS.index(GAIN_BANKS[bank_index])]

    def over_bank(self, quantity: str) -> Array:
        """Return a trim quantity over bank and airspeed, shape (banks, airspeeds).

        ``quantity`` is ``pitch``, ``yaw_rate``, ``p``, ``q``, ``r`` [rad, rad/s] or the name of a
        control input [-].
        """
        return np.array([[trim_quantity(t, quantity) for t in row] for row in self.trims]).T

    def gain_over_bank(self, values: Sequence[Sequence[float]]) -> Array:
        """Return a gain given by airspeed and gain bank over gain bank and airspeed, as
        ``over_bank`` does.
        """
        return np.array(values, dtype=np.float64).T

    def bank_for_turn(self, turns: Array) -> Array:
        """Return the bank [rad] that gives the dimensionless turn V omega/g = ``turns``, shape
        (turns, airspeeds).

        In a coordinated turn this is atan(turns). An aircraft without rudder slips, and needs more.
        """
        columns = []
        for airspeed, row in zip(self.airspeeds, self.trims, strict=True):
            turn = [airspeed * t.yaw_rate / STANDARD_GRAVITY for t in row]
            columns.append(
                np.tan(_interpolate(turns, np.array(turn), np.array([t.roll for t in row])))
            )
        return np.arctan(np.array(columns).T)

    def turns(self) -> Array:
        """Return the dimensionless turns of the table of ``bank_for_turn``: up to the largest
        bank's, and beyond.
        """
        largest = 1.05 * math.tan(self.banks[-1])
        return np.linspace(-largest, largest, 29)


def table_banks(envelope: Envelope, fractions: Sequence[float]) -> tuple[float, ...]:
    """Return fractions of the tables' largest bank [rad]."""
    return tuple(fraction * TABLE_REACH * envelope.bank_max for fraction in fractions)


def _interpolate(x: Array, at: Array, angles: Array) -> Array:
    """Interpolate angles linearly in their tangent over its nearly proportional argument, extended
    past the ends.
    """
    tangents = np.tan(angles)
    inside = np.interp(x, at, tangents)
    inside = np.where(x > at[-1], tangents[-1] * x / at[-1], inside)
    return np.arctan(np.where(x < at[0], tangents[0] * x / at[0], inside))


def trim_quantity(t: Trim, quantity: str) -> float:
    """Return a body rate, a control input or an attribute of an equilibrium by its name."""
    if quantity in ("p", "q", "r"):
        return t.rates_body["pqr".index(quantity)]
    if quantity in t.inputs:
        return t.inputs[quantity]
    return float(getattr(t, quantity))
