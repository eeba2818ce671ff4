"""The autopilot's tables: equilibria over airspeed and bank (turn compensation), and gains over airspeed."""

import math
from dataclasses import dataclass

import control
import numpy as np
import numpy.typing as npt

from aircraft.fdm import Fdm
from aircraft.linearise import linearise
from aircraft.spec import AircraftSpec
from aircraft.trim import Trim, trim
from innerloop.gains import Gains, design_gains
from innerloop.weights import DesignWeights

BANKS_DEG = (-55.0, -45.0, -35.0, -22.0, 0.0, 22.0, 35.0, 45.0, 55.0)
"""Bank angles of the equilibria behind turn compensation [deg]."""

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Schedule:
    """Everything the flown autopilot is made of.

    Attributes
    ----------
    spec : the aircraft
    weights : what the design asked for
    altitude : at which it was designed [m]
    airspeeds : shape (n,) [m/s], ascending
    gains : one per airspeed
    models : linear model per airspeed, straight and level
    trims : equilibria by airspeed, then by bank in the order of ``BANKS_DEG``
    """

    spec: AircraftSpec
    weights: DesignWeights
    altitude: float
    airspeeds: tuple[float, ...]
    gains: tuple[Gains, ...]
    models: tuple[control.StateSpace, ...]
    trims: tuple[tuple[Trim, ...], ...]

    def level(self, index: int) -> Trim:
        """Return the straight and level equilibrium at airspeed ``index``."""
        return self.trims[index][BANKS_DEG.index(0.0)]

    def over_bank(self, quantity: str) -> Array:
        """Return a trim quantity over bank and airspeed, shape (banks, airspeeds).

        ``quantity`` is ``pitch``, ``yaw_rate``, ``p``, ``q``, ``r`` [rad, rad/s] or the name of a control input [-].
        """
        return np.array([[_quantity(t, quantity) for t in row] for row in self.trims]).T

    def bank_for_turn(self, turns: Array) -> Array:
        """Return the bank [rad] that gives the dimensionless turn V omega/g = ``turns``, shape (turns, airspeeds).

        In a coordinated turn this is atan(turns). An aircraft without rudder slips, and needs more.
        """
        columns = []
        for airspeed, row in zip(self.airspeeds, self.trims, strict=True):
            turn = [airspeed * t.yaw_rate / STANDARD_GRAVITY for t in row]
            columns.append(np.tan(_interpolate(turns, np.array(turn), np.array([t.roll for t in row]))))
        return np.arctan(np.array(columns).T)


STANDARD_GRAVITY = 9.80665
"""Standard acceleration of free fall [m/s^2]; here it only makes turns dimensionless."""


def _interpolate(x: Array, at: Array, angles: Array) -> Array:
    """Interpolate angles linearly in their tangent over its nearly proportional argument, extended past the ends."""
    tangents = np.tan(angles)
    inside = np.interp(x, at, tangents)
    inside = np.where(x > at[-1], tangents[-1] * x / at[-1], inside)
    return np.arctan(np.where(x < at[0], tangents[0] * x / at[0], inside))


def _quantity(t: Trim, quantity: str) -> float:
    if quantity in ("p", "q", "r"):
        return t.rates_body["pqr".index(quantity)]
    if quantity in t.inputs:
        return t.inputs[quantity]
    return float(getattr(t, quantity))


def design_schedule(spec: AircraftSpec, altitude: float = 100.0, weights: DesignWeights | None = None) -> Schedule:
    """Trim, linearise and design over the aircraft's airspeeds at ``altitude`` [m].

    Raises
    ------
    TrimError : the aircraft cannot fly one of the design conditions
    """
    weights = weights or DesignWeights()
    fdm = Fdm(spec)
    trims = tuple(
        tuple(trim(fdm, airspeed=airspeed, altitude=altitude, bank=math.radians(bank)) for bank in BANKS_DEG)
        for airspeed in spec.design_airspeeds
    )
    level = BANKS_DEG.index(0.0)
    models = tuple(linearise(fdm, row[level]) for row in trims)
    gains = tuple(design_gains(m, v, weights) for m, v in zip(models, spec.design_airspeeds, strict=True))
    return Schedule(
        spec=spec,
        weights=weights,
        altitude=altitude,
        airspeeds=spec.design_airspeeds,
        gains=gains,
        models=models,
        trims=trims,
    )
