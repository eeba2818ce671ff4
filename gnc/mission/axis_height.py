"""How high the plume's axis is, as the guidance takes it to be: from the funnel's mouth at a given slope, and by its rise."""

import math
from dataclasses import dataclass

from gnc.numeric import limited

_ENTRAINMENT = 0.6
"""Briggs' entrainment coefficient of a plume that bends over in the wind [-]."""

_SPEED_MIN = 1.0
"""Apparent wind that the rise is computed for at least [m/s]: below it a plume has no direction, and rises straight up."""

_FOLLOWING_TIME, _CLIMB_GRADIENT = 20.0, 0.05
"""Time in which the altitude follows that of the plume's axis [s], and the steepest climb on the way [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisHeight:
    """The height of the axis over the distance from the funnel.

    Attributes
    ----------
    source : height of the funnel's mouth above the sea [m]
    climb : slope of the axis [-]
    momentum_flux, buoyancy_flux : of the exhaust that the ship is taken to have; 0 for an axis that does not rise by itself
        [m^4/s^2, m^4/s^3]
    lowest, highest : that is flown [m]
    """

    source: float
    climb: float = 0.0
    momentum_flux: float = 0.0
    buoyancy_flux: float = 0.0
    lowest: float = 0.0
    highest: float = float("inf")

    def at(self, distance: float, speed: float) -> float:
        """Return the height above the sea [m] at a distance behind the funnel [m] in an apparent wind [m/s].

        The rise is that of a bent-over plume in neutral air (Briggs 1975; AERMOD, CBLPRD).
        """
        u = max(speed, _SPEED_MIN)
        momentum, buoyancy = 3.0 * self.momentum_flux * distance / u**2, 1.5 * self.buoyancy_flux * distance**2 / u**3
        rise = math.cbrt((momentum + buoyancy) / _ENTRAINMENT**2)
        return min(max(self.source + self.climb * distance + rise, self.lowest), self.highest)

    def followed(self, altitude: float, *, distance: float, speed: float, airspeed: float, interval: float) -> float:
        """Return the altitude [m] after an interval [s] of following ``at``: slowly, because that follows wind that is estimated.

        Parameters
        ----------
        altitude : now [m]
        distance, speed : as of ``at``
        airspeed : that is flown [m/s]
        interval : [s]
        """
        climb = _CLIMB_GRADIENT * airspeed
        return altitude + interval * limited((self.at(distance, speed) - altitude) / _FOLLOWING_TIME, climb)
