"""The one mapping between JSBSim's globe and local north and east metres."""

import math

EQUATORIAL_RADIUS = 6378137.0
"""WGS 84 semi-major axis [m], which JSBSim's default planet uses."""

FLATTENING = 1.0 / 298.257223563
"""WGS 84 flattening [-]."""


class LocalFrame:
    """North and east metres about an origin, at a fixed altitude.

    A degree of latitude and of longitude count as they do at the origin. On the equator, the default, north-east
    metres then agree with the integral of ground velocity to 1e-5 of the distance within 50 km, and local north stays
    true north; at latitude L the two drift apart by about tan(L) times distance squared over the earth's radius.

    Parameters
    ----------
    latitude, longitude : geodetic, of the origin [rad]
    altitude : [m]
    """

    __slots__ = ("_latitude", "_longitude", "east_scale", "north_scale")

    def __init__(self, latitude: float = 0.0, longitude: float = 0.0, altitude: float = 0.0) -> None:
        self._latitude = latitude
        self._longitude = longitude
        eccentricity_squared = FLATTENING * (2.0 - FLATTENING)
        w = 1.0 - eccentricity_squared * math.sin(latitude) ** 2
        self.north_scale = EQUATORIAL_RADIUS * (1.0 - eccentricity_squared) / w**1.5 + altitude
        """Metres per radian of latitude: meridian radius of curvature plus altitude."""
        self.east_scale = (EQUATORIAL_RADIUS / math.sqrt(w) + altitude) * math.cos(latitude)
        """Metres per radian of longitude: radius of the parallel."""

    def to_geodetic(self, north: float, east: float) -> tuple[float, float]:
        """Return latitude and longitude [rad] of a local place [m]."""
        return self._latitude + north / self.north_scale, self._longitude + east / self.east_scale
