"""When a flight over a real sea has settled, and how often it has crossed the plume since."""

import math

_CENTRE_BANDS = 3.0
"""Distance of the orbit's centre from its place that counts as there, over the settling band: the vessel is not seen exactly."""


class Settling:
    """Watches a flight, sample by sample.

    Settled once the vehicle has been near its reference, and the orbit in its place, for a whole period. It stays settled: what
    turbulence or a manoeuvre do later belongs to the flight.

    Parameters
    ----------
    band : distance from the reference that counts as near [m]
    period : of the oscillation [s]
    crossings : to be flown after settling; 0 for no end

    Attributes
    ----------
    at : when it had settled, not a number before [s]
    crossings : flown since
    """

    __slots__ = ("_band", "_complete", "_period", "_side", "_since", "_wanted", "at", "crossings")

    def __init__(self, *, band: float, period: float, crossings: int) -> None:
        self._band, self._period, self._wanted = band, period, crossings
        self._since = math.inf
        self._side = 0.0
        self._complete = False
        self.at = math.nan
        self.crossings = 0

    def update(self, time: float, *, tracking_error: float, centre_error: float, x: float, y: float, axis: float) -> bool:
        """Take note of a sample; return whether the flight had all it wants by the last one.

        Parameters
        ----------
        time : [s]
        tracking_error : distance to the reference [m]
        centre_error : distance of the orbit's centre from its place, infinite while that is still closing in [m]
        x, y : north and east of the vessel [m]
        axis : course along which the plume trails [rad]
        """
        cos_a, sin_a = math.cos(axis), math.sin(axis)
        before, self._side = self._side, cos_a * y - sin_a * x
        if math.isnan(self.at):
            if tracking_error >= self._band or centre_error >= _CENTRE_BANDS * self._band:
                self._since = math.inf
            elif self._since == math.inf:
                self._since = time
            if time - self._since >= self._period:
                self.at = time
        elif before * self._side < 0.0 and cos_a * x + sin_a * y > 0.0:
            self.crossings += 1
        complete, self._complete = self._complete, 0 < self._wanted <= self.crossings
        return complete
