"""How high the plume's axis is, as the guidance takes it to be: from the funnel's mouth at a given slope, and by its rise."""

from dataclasses import dataclass

from gnc.estimation.plume.prior import rise


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
        """Return the height above the sea [m] at a distance behind the funnel [m] in an apparent wind [m/s]."""
        climbed = rise(self.momentum_flux, self.buoyancy_flux, distance, speed)
        return min(max(self.source + self.climb * distance + climbed, self.lowest), self.highest)
