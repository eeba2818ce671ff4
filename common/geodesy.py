"""Convert positions on the WGS 84 ellipsoid to metres north and east of an origin."""

import math

import numpy as np
import numpy.typing as npt

EQUATORIAL_RADIUS = 6378137.0
"""Semi-major axis of WGS 84 [m]."""

FLATTENING = 1.0 / 298.257223563
"""Flattening of WGS 84 [-]."""

ECCENTRICITY_SQUARED = FLATTENING * (2.0 - FLATTENING)
"""First eccentricity of WGS 84, squared [-]."""

Array = npt.NDArray[np.float64]


class LocalFrame:
    """Azimuthal equidistant projection: metres north and east of an origin.

    A point at a distance d on the ellipsoid and an azimuth A from true north at the origin has the
    coordinates d cos A north and d sin A east. The line to the point is taken as an arc with the
    ellipsoid's radius of curvature at the origin in that direction. The origin may be anywhere,
    also at a pole or the date line.

    Positions are accurate to 0.2 mm within 20 km of the origin, and to 2 cm within 100 km (against
    GeographicLib, C. F. F. Karney, Algorithms for geodesics, J. Geodesy 87:43, 2013). Distances
    between two points at a distance d from the origin are too long by up to d^2/(6 R^2): 2e-6 at 20
    km.

    Parameters
    ----------
    latitude, longitude : geodetic coordinates of the origin [rad]
    altitude : altitude above the ellipsoid at which distances are measured [m]
    """

    def __init__(self, latitude: float, longitude: float, altitude: float = 0.0) -> None:
        self._up, self._north, self._east = (
            np.array([float(x) for x in axis]) for axis in _axes(latitude, longitude)
        )
        self._origin = cartesian(np.float64(latitude), np.float64(longitude))
        w = 1.0 - ECCENTRICITY_SQUARED * math.sin(latitude) ** 2
        self._meridian_radius = EQUATORIAL_RADIUS * (1.0 - ECCENTRICITY_SQUARED) / w**1.5
        self._transverse_radius = EQUATORIAL_RADIUS / math.sqrt(w)
        self._north_longer = 1.0 + altitude / self._meridian_radius
        self._east_longer = 1.0 + altitude / self._transverse_radius

    def to_local(self, latitude: npt.ArrayLike, longitude: npt.ArrayLike) -> tuple[Array, Array]:
        """Return north and east [m] of latitudes and longitudes [rad], in their shape."""
        chord = (
            cartesian(
                np.asarray(latitude, dtype=np.float64), np.asarray(longitude, dtype=np.float64)
            )
            - self._origin
        )
        north, east = chord @ self._north, chord @ self._east
        level = np.hypot(north, east)
        radius = self._radius(north, level)
        arc = radius * np.arcsin(np.minimum(1.0, level / radius))
        longer = np.where(level > 0.0, arc / np.where(level > 0.0, level, 1.0), 1.0)
        return north * longer * self._north_longer, east * longer * self._east_longer

    def to_geodetic(self, north: npt.ArrayLike, east: npt.ArrayLike) -> tuple[Array, Array]:
        """Return latitude and longitude (-pi to pi) [rad] of positions north and east [m]."""
        to_north = np.asarray(north, dtype=np.float64) / self._north_longer
        to_east = np.asarray(east, dtype=np.float64) / self._east_longer
        distance = np.hypot(to_north, to_east)
        radius = self._radius(to_north, distance)
        angle = distance / radius
        shorter = np.sinc(angle / math.pi)
        down = 2.0 * radius * np.sin(0.5 * angle) ** 2
        level_north = (to_north * shorter)[..., None] * self._north
        level_east = (to_east * shorter)[..., None] * self._east
        level = level_north + level_east
        return _geodetic(self._origin + level - down[..., None] * self._up)

    def true_north(self, latitude: npt.ArrayLike, longitude: npt.ArrayLike) -> Array:
        """Return the angle of true north at positions, clockwise from the frame's north [rad].

        Meridians converge: a course in this frame is the true course plus this angle.
        """
        _, north, _ = _axes(
            np.asarray(latitude, dtype=np.float64), np.asarray(longitude, dtype=np.float64)
        )
        pointing = np.stack(np.broadcast_arrays(*north), axis=-1)
        angle: Array = np.arctan2(pointing @ self._east, pointing @ self._north)
        return angle

    def _radius(self, north: Array, distance: Array) -> Array:
        """Return the radius of curvature at the origin in the direction of points [m] (Euler)."""
        share = np.where(distance > 0.0, north / np.where(distance > 0.0, distance, 1.0), 1.0) ** 2
        radius: Array = 1.0 / (
            share / self._meridian_radius + (1.0 - share) / self._transverse_radius
        )
        return radius


def _axes(latitude: npt.ArrayLike, longitude: npt.ArrayLike) -> tuple[tuple[Array, ...], ...]:
    """Return unit vectors up, north and east at positions [rad], in Earth-fixed axes."""
    sin_lat = np.sin(latitude)
    cos_lat = np.cos(latitude)
    sin_lon = np.sin(longitude)
    cos_lon = np.cos(longitude)
    return (
        (cos_lat * cos_lon, cos_lat * sin_lon, sin_lat),
        (-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat),
        (-sin_lon, cos_lon, np.zeros_like(sin_lon)),
    )


def cartesian(latitude: Array | np.float64, longitude: Array | np.float64) -> Array:
    """Return points of the ellipsoid [rad] in Earth-fixed axes [m], shape (..., 3)."""
    radius = EQUATORIAL_RADIUS / np.sqrt(1.0 - ECCENTRICITY_SQUARED * np.sin(latitude) ** 2)
    level = radius * np.cos(latitude)
    z = (1.0 - ECCENTRICITY_SQUARED) * radius * np.sin(latitude)
    return np.stack(
        np.broadcast_arrays(level * np.cos(longitude), level * np.sin(longitude), z), axis=-1
    )


def _geodetic(place: Array) -> tuple[Array, Array]:
    """Return latitude and longitude [rad] of points near the ellipsoid.

    Source: B. R. Bowring, Survey Review 23:323 (1976).
    """
    x, y, z = place[..., 0], place[..., 1], place[..., 2]
    polar_radius = EQUATORIAL_RADIUS * (1.0 - FLATTENING)
    level = np.hypot(x, y)
    reduced = np.arctan2(z * EQUATORIAL_RADIUS, level * polar_radius)
    second = ECCENTRICITY_SQUARED / (1.0 - ECCENTRICITY_SQUARED)
    latitude = np.arctan2(
        z + second * polar_radius * np.sin(reduced) ** 3,
        level - ECCENTRICITY_SQUARED * EQUATORIAL_RADIUS * np.cos(reduced) ** 3,
    )
    return latitude, np.arctan2(y, x)
