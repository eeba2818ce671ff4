"""The one mapping between JSBSim's globe and local north and east metres: about latitude and
longitude 0, where all flights fly.

Where on earth a flight is meant to be (``common.physics.geodesy.LocalFrame``) changes nothing of
how it is flown: at the equator local north stays true north, and JSBSim's axes have no pole.
"""

from common.physics.geodesy import ECCENTRICITY_SQUARED, EQUATORIAL_RADIUS

_MERIDIAN_RADIUS = EQUATORIAL_RADIUS * (1.0 - ECCENTRICITY_SQUARED)
"""Radius of curvature of a meridian at the equator [m]."""

_NORTH_BY_LATITUDE = 0.5 * ECCENTRICITY_SQUARED
_NORTH_BY_LONGITUDE = 1.0 / (6.0 * (1.0 - ECCENTRICITY_SQUARED))
_EAST_BY_LATITUDE = (1.0 - ECCENTRICITY_SQUARED) / 3.0
"""By what a degree of latitude or longitude counts more, or less, per squared angle from the origin
[-].
"""


class EquatorFrame:
    """North and east metres about latitude and longitude 0, at a fixed altitude: azimuthal
    equidistant, to third order.

    With s = M phi (1 + e^2 phi^2/2) the length of the meridian and u = a lambda that of the
    equator, and K = 1/(a M) the curvature there, north is s (1 + K u^2/6) and east u (1 - K s^2/3).
    That is ``common.physics.geodesy.LocalFrame`` at the origin, to 0.1 mm within a distance of 20
    km.

    Parameters
    ----------
    altitude : [m]

    Attributes
    ----------
    north_scale, east_scale : metres per radian of latitude and of longitude at the origin
    """

    __slots__ = ("east_scale", "north_scale")

    def __init__(self, altitude: float = 0.0) -> None:
        self.north_scale = _MERIDIAN_RADIUS + altitude
        self.east_scale = EQUATORIAL_RADIUS + altitude

    def to_local(self, latitude: float, longitude: float) -> tuple[float, float]:
        """Return north and east [m] of a place [rad]."""
        squared = latitude * latitude
        return (
            self.north_scale
            * latitude
            * (1.0 + _NORTH_BY_LATITUDE * squared + _NORTH_BY_LONGITUDE * longitude * longitude),
            self.east_scale * longitude * (1.0 - _EAST_BY_LATITUDE * squared),
        )

    def to_geodetic(self, north: float, east: float) -> tuple[float, float]:
        """Return latitude and longitude [rad] of a local place [m]."""
        latitude, longitude = north / self.north_scale, east / self.east_scale
        for _ in range(3):
            # Each time the rest is smaller by the square of the angle, 1e-5 at 20 km.
            off_north, off_east = self.to_local(latitude, longitude)
            latitude += (north - off_north) / self.north_scale
            longitude += (east - off_east) / self.east_scale
        return latitude, longitude
