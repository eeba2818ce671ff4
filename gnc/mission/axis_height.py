"""How high the plume's axis is, as the guidance takes it to be: from the funnel's mouth, at a given
slope, drawn down and risen.
"""

from dataclasses import dataclass

from gnc.estimation.plume.prior import downwash, rise
from gnc.numeric import clip


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisHeight:
    """The height of the axis over the distance from the funnel.

    Attributes
    ----------
    source : height of the funnel's mouth above the sea [m]
    climb : slope of the axis [-]
    momentum_flux, buoyancy_flux : of the exhaust that the ship is taken to have; 0 for an axis that
        does not rise by itself [m^4/s^2, m^4/s^3]
    stack_diameter, exhaust_speed : of the funnel's mouth, whose wake draws the plume down; 0
        without exhaust [m, m/s]
    lowest, highest : that is flown [m]
    """

    source: float
    climb: float = 0.0
    momentum_flux: float = 0.0
    buoyancy_flux: float = 0.0
    stack_diameter: float = 0.0
    exhaust_speed: float = 0.0
    lowest: float = 0.0
    highest: float = float("inf")

    def at(self, distance: float, speed: float) -> float:
        """Return the height above the sea [m] at a distance behind the funnel [m] in an apparent
        wind [m/s].
        """
        mouth = max(0.0, self.source - downwash(self.stack_diameter, self.exhaust_speed, speed))
        climbed = rise(self.momentum_flux, self.buoyancy_flux, distance, speed)
        return clip(mouth + self.climb * distance + climbed, self.lowest, self.highest)
