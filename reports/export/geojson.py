"""GeoJSON of RFC 7946: tracks of UAV and vessel, crossings, and the keep-out area at the end, of
all flights.
"""

import itertools
import json
import math
from pathlib import Path
from typing import Any

import numpy as np

from reports.export.exporter import EXPORTERS
from reports.export.geographic import Body, GeographicFlight, recorded_flights
from reports.run.run_data import RunData

Position = list[float]

_CORNERS = 3
"""Fewest places of a closed ring that has an area, less one [-]."""


@EXPORTERS.register("geojson")
class GeoJson:
    """A collection of features; what goes over the date line is cut there, and heights are above
    the ellipsoid, as the standard asks for.
    """

    suffix = ".geojson"

    def write(self, run: RunData, path: Path) -> None:
        """Write all flights that have a time history."""
        features = [
            feature
            for flight in recorded_flights(run)
            for feature in _features(flight.above_ellipsoid())
        ]
        path.write_text(
            json.dumps({"type": "FeatureCollection", "features": features}, allow_nan=False),
            encoding="utf-8",
        )


def _features(flight: GeographicFlight) -> list[dict[str, Any]]:
    about = {
        "flight_id": flight.flight_id,
        "start_utc": flight.utc(0),
        "end_utc": flight.utc(len(flight.time) - 1),
        "height_reference": flight.height_reference,
    }
    times = {"times_s": np.round(flight.time, 3).tolist()}
    features = [_feature(_track(flight.uav), about | {"what": "uav"} | times | _readings(flight))]
    if flight.vessel is not None:
        features.append(_feature(_track(flight.vessel), about | {"what": "vessel"} | times))
        ring = [
            [longitude, latitude]
            for longitude, latitude in flight.keepout_ring(len(flight.time) - 1)
        ]
        keepout = {"what": "keepout_at_end", "radius_m": flight.keepout_radius}
        features.append(_feature(_area(ring), about | keepout))
    for crossing in flight.crossings.to_dict("records"):
        at = float(crossing["time_s"])
        if flight.time[0] <= at <= flight.time[-1]:
            point = {"type": "Point", "coordinates": _at(flight, at)}
            distance = {
                "distance_m": round(float(crossing["distance_m"]), 2),
                "time_s": round(at, 3),
            }
            features.append(_feature(point, about | {"what": "crossing"} | distance))
    return features


def _readings(flight: GeographicFlight) -> dict[str, list[float | None]]:
    """Return what the sniffer read at each of the times, by the name of the gas and its unit."""
    return {
        name: [round(x, 3) if np.isfinite(x) else None for x in of.tolist()]
        for name, of in flight.readings.items()
    }


def _feature(geometry: dict[str, Any], properties: dict[str, Any]) -> dict[str, Any]:
    return {"type": "Feature", "geometry": geometry, "properties": properties}


def _at(flight: GeographicFlight, time: float) -> Position:
    """Return the UAV's place at a time [s], between samples."""
    unwrapped = np.unwrap(flight.uav.longitude, period=360.0)
    longitude, latitude, altitude = (
        float(np.interp(time, flight.time, values))
        for values in (unwrapped, flight.uav.latitude, flight.uav.altitude)
    )
    return _rounded([[(longitude + 180.0) % 360.0 - 180.0, latitude, altitude]])[0]


def _track(body: Body) -> dict[str, Any]:
    """Return a line, several where it goes over the date line, or a point where there is one place
    alone.
    """
    parts: list[list[Position]] = [[]]
    before: Position | None = None
    for longitude, latitude, altitude in zip(
        body.longitude, body.latitude, body.altitude, strict=True
    ):
        here = [float(longitude), float(latitude), float(altitude)]
        if before is not None and abs(here[0] - before[0]) > 180.0:
            edge = 180.0 if before[0] > 0.0 else -180.0
            beyond = here[0] + 2.0 * edge
            share = (edge - before[0]) / (beyond - before[0]) if beyond != before[0] else 0.0
            between = [a + share * (b - a) for a, b in zip(before[1:], here[1:], strict=True)]
            parts[-1].append([edge, *between])
            parts.append([[-edge, *between]])
        parts[-1].append(here)
        before = here
    lines = [_rounded(part) for part in parts]
    if len(body.longitude) == 1:
        return {"type": "Point", "coordinates": lines[0][0]}
    if len(lines) == 1:
        return {"type": "LineString", "coordinates": lines[0]}
    return {"type": "MultiLineString", "coordinates": lines}


def _area(ring: list[Position]) -> dict[str, Any]:
    """Return a convex polygon, or the two parts of one that lies over the date line; the ring is in
    one piece, and closed.
    """
    edge = math.copysign(180.0, ring[0][0])
    beyond = [[x - 2.0 * edge, y] for x, y in _part(ring, edge, -math.copysign(1.0, edge))]
    parts = (_part(ring, edge, math.copysign(1.0, edge)), beyond)
    coordinates = [[_rounded(part)] for part in parts if len(part) > _CORNERS]
    if len(coordinates) == 1:
        return {"type": "Polygon", "coordinates": coordinates[0]}
    return {"type": "MultiPolygon", "coordinates": coordinates}


def _part(ring: list[Position], edge: float, side: float) -> list[Position]:
    """Return the part of a convex ring to one side of a meridian: 1 for the west, -1 for the east
    of it; closed, or empty.
    """
    part: list[Position] = []
    for (x, y), (x_next, y_next) in itertools.pairwise(ring):
        inside, next_inside = side * (edge - x) >= 0.0, side * (edge - x_next) >= 0.0
        if inside:
            part.append([x, y])
        if inside != next_inside:
            part.append([edge, y + (edge - x) / (x_next - x) * (y_next - y)])
    return [*part, part[0]] if part else part


def _rounded(places: list[Position]) -> list[Position]:
    """Return places to a millimetre and 1e-8 deg."""
    return [[round(x, 3 if i == 2 else 8) for i, x in enumerate(place)] for place in places]
