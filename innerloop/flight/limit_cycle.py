"""The limit cycle of an aircraft whose servos have play: no linear model has it.

A servo that does not answer to small commands lets the aircraft drift until the command is large
enough, and the autopilot then brings it back too late. What follows is an oscillation of fixed
amplitude and period (A. Gelb, W. E. Vander Velde, Multiple-Input Describing Functions, 1968,
ch. 3).
"""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from aircraft.fdm import TIME_STEP
from aircraft.trim import Trim
from common.physics import METRES_PER_FOOT
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft

Array = npt.NDArray[np.float64]

DURATION = 120.0
"""Flight straight and level, of which the last half is measured [s]: cycles of up to 20 s show."""

ALTITUDE_MIN, BANK_MIN = 0.05, math.radians(0.1)
"""Amplitudes of altitude or bank from which on an oscillation counts [m, rad]: a sixth and a third
of those of JSBSim's c172x."""

_SUSTAINED = 0.8
"""Least ratio of the amplitude in the last quarter to that in the one before it [-]: a cycle keeps
its amplitude, a slow response decays."""

_PERIODS_MIN = 2
"""Whole periods that the measured half has at least [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitCycle:
    """Sustained oscillation in straight and level flight.

    Attributes
    ----------
    altitude, bank : amplitudes [m, rad]
    period : [s]; NaN where nothing is sustained above ``ALTITUDE_MIN`` and ``BANK_MIN``
    """

    altitude: float
    bank: float
    period: float

    @property
    def is_flown(self) -> bool:
        """Whether there is an oscillation that counts."""
        return math.isfinite(self.period)


def measure_limit_cycle(aircraft: AutopilotedAircraft, start: Trim) -> LimitCycle:
    """Return the oscillation of a flight straight and level in still air.

    Parameters
    ----------
    aircraft : with its autopilot; its flight is ended
    start : straight and level equilibrium
    """
    aircraft.release(start.state(), airspeed=start.airspeed, altitude=start.altitude)
    altitude_ft = aircraft.fdm.node("position/h-sl-ft").get_double_value
    roll = aircraft.fdm.node("attitude/phi-rad").get_double_value
    flown = np.empty((round(DURATION / TIME_STEP), 2))
    for i in range(len(flown)):
        aircraft.fdm.run()
        flown[i] = METRES_PER_FOOT * altitude_ft(), roll()
    return limit_cycle(flown[:, 0], flown[:, 1])


def limit_cycle(altitude: Array, bank: Array) -> LimitCycle:
    """Return the oscillation in the last half of a flight, from samples each ``TIME_STEP``.

    Parameters
    ----------
    altitude, bank : shape (n,) each [m, rad]
    """
    amplitudes, periods = [], []
    for values, least in ((altitude, ALTITUDE_MIN), (bank, BANK_MIN)):
        measured = _without_trend(values[len(values) // 2 :])
        middle = len(measured) // 2
        before, after = (0.5 * float(np.ptp(part)) for part in np.split(measured, [middle]))
        amplitudes.append(after)
        if after >= least and after >= _SUSTAINED * before:
            periods.append(_period(measured))
    return LimitCycle(
        altitude=amplitudes[0],
        bank=amplitudes[1],
        period=next((period for period in periods if math.isfinite(period)), math.nan),
    )


def _without_trend(values: Array) -> Array:
    """Return deviations from the straight line through the values."""
    number = np.arange(len(values), dtype=np.float64)
    line = np.polyval(np.polyfit(number, values, 1), number)
    return np.asarray(values - line, dtype=np.float64)


def _period(deviation: Array) -> float:
    """Return the mean time between upward crossings of zero [s]; NaN of too few of them."""
    before = np.flatnonzero((deviation[:-1] < 0.0) & (deviation[1:] >= 0.0))
    if len(before) <= _PERIODS_MIN:
        return math.nan
    # Between two samples the crossing is that of the line through both.
    crossing = before + deviation[before] / (deviation[before] - deviation[before + 1])
    return TIME_STEP * float(np.mean(np.diff(crossing)))
