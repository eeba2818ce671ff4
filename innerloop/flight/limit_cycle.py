"""Measure the limit cycle of an aircraft whose servos have play.

A servo with play does not follow small commands. The aircraft drifts until the command is large
enough, and the autopilot brings it back too late. The result is an oscillation of fixed amplitude
and period, which no linear model shows (A. Gelb, W. E. Vander Velde, Multiple-Input Describing
Functions, 1968, ch. 3).
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
"""Duration of the straight and level flight [s]; its second half shows periods up to 20 s."""

ALTITUDE_MIN, BANK_MIN = 0.05, math.radians(0.1)
"""Least amplitudes of altitude and bank in a limit cycle [m, rad].

They are a sixth and a third of the amplitudes of JSBSim's c172x.
"""

_SUSTAINED = 0.8
"""Least ratio of the amplitudes in the last quarter and the quarter before it [-].

A limit cycle keeps its amplitude, and a slow response decays.
"""

_PERIODS_MIN = 2
"""Least number of whole periods in the measured half [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitCycle:
    """Sustained oscillation in straight and level flight.

    Attributes
    ----------
    altitude, bank : amplitudes [m, rad]
    period : [s]; NaN if no oscillation above ``ALTITUDE_MIN`` or ``BANK_MIN`` is sustained
    """

    altitude: float
    bank: float
    period: float

    @property
    def is_flown(self) -> bool:
        """Whether the aircraft flies a limit cycle."""
        return math.isfinite(self.period)


def measure_limit_cycle(aircraft: AutopilotedAircraft, start: Trim) -> LimitCycle:
    """Return the limit cycle in straight and level flight in still air.

    Parameters
    ----------
    aircraft : aircraft with its autopilot; its flight is ended
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
    """Return the limit cycle in the second half of a flight, sampled at each ``TIME_STEP``.

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
    """Return the deviations of values from their regression line."""
    number = np.arange(len(values), dtype=np.float64)
    line = np.polyval(np.polyfit(number, values, 1), number)
    return np.asarray(values - line, dtype=np.float64)


def _period(deviation: Array) -> float:
    """Return the mean time between upward zero crossings [s]; NaN if there are too few."""
    before = np.flatnonzero((deviation[:-1] < 0.0) & (deviation[1:] >= 0.0))
    if len(before) <= _PERIODS_MIN:
        return math.nan
    # The time of a crossing is interpolated between two samples.
    crossing = before + deviation[before] / (deviation[before] - deviation[before + 1])
    return TIME_STEP * float(np.mean(np.diff(crossing)))
