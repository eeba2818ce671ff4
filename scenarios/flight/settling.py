"""When a flight has settled, and how often it has crossed the plume since."""

import math

_CENTRE_BANDS = 3.0
"""Distance of the orbit's centre from its place that counts as there, over the settling band: the
vessel is not known exactly.
"""


class Settling:
    """Watches a flight, sample by sample.

    A flight has settled from the first moment from which the vehicle stays near its reference, and
    the orbit near its place, for a whole period. It stays settled: what turbulence or a manoeuvre
    do later belongs to the flight.

    Parameters
    ----------
    band : distance from the reference that counts as near [m]
    period : of the oscillation [s]
    crossings : to be flown; 0 for no end
    after : how long the flight goes on once it has settled, infinite for no end [s]

    Attributes
    ----------
    at : when the flight had settled, not a number as long as that does not show [s]
    crossings : flown since
    tracked : longest time for which the vehicle stayed near its reference before that, wherever the
        orbit was [s]
    centre_error, centre_band : distance of the orbit's centre from its place at the last sample,
        infinite while it is still closing in, and below what it counts as there [m]
    """

    __slots__ = (
        "_after",
        "_band",
        "_complete",
        "_demanded",
        "_near_since",
        "_open",
        "_period",
        "_side",
        "_since",
        "at",
        "centre_band",
        "centre_error",
        "crossings",
        "tracked",
    )

    def __init__(
        self, *, band: float, period: float, crossings: int, after: float = math.inf
    ) -> None:
        self._band, self.centre_band, self._period, self._demanded = (
            band,
            _CENTRE_BANDS * band,
            period,
            crossings,
        )
        self._after = after
        self._since, self._side, self._complete, self._open = math.inf, 0.0, False, True
        self._near_since = math.inf
        self.at, self.crossings, self.tracked, self.centre_error = math.nan, 0, 0.0, math.inf

    def update(
        self,
        time: float,
        tracking_error: float,
        centre_error: float,
        x: float,
        y: float,
        axis: float,
    ) -> bool:
        """Take note of a sample; return whether the flight had flown all that it is to fly by the
        last one.

        Parameters
        ----------
        time : [s]
        tracking_error : distance to the reference [m]
        centre_error : distance of the orbit's centre from its place, infinite while that is still
            closing in [m]
        x, y : north and east of the vessel [m]
        axis : course along which the plume trails [rad]
        """
        self.centre_error = centre_error
        cos_a, sin_a = math.cos(axis), math.sin(axis)
        before, self._side = self._side, cos_a * y - sin_a * x
        if self._open:
            self._near_since = (
                min(self._near_since, time) if tracking_error < self._band else math.inf
            )
            self.tracked = max(self.tracked, time - self._near_since)
        if self._open and (tracking_error >= self._band or centre_error >= self.centre_band):
            self._since, self.crossings = math.inf, 0
        elif self._since == math.inf:
            self._since = time
        elif before * self._side < 0.0 and cos_a * x + sin_a * y > 0.0:
            self.crossings += 1
        if self._open and time - self._since >= self._period:
            self.at, self._open = self._since, False
        complete, self._complete = self._complete, not self._open and self._flown(time)
        return complete

    def _flown(self, time: float) -> bool:
        """Return whether it has settled for as long, and has the crossings, that are asked for; not
        where nothing is.
        """
        crossed = 0 < self._demanded <= self.crossings
        if self._after == math.inf:
            return crossed
        return time - self.at >= self._after and self.crossings >= self._demanded
