"""MCAP with Foxglove's well-known schemas, which Foxglove, Lichtblick and Rerun open; needs the
extra ``export``.
"""

import json
import math
from pathlib import Path
from typing import Any

from reports.export.exporter import need_packages
from reports.export.geographic import Body, GeographicFlight, recorded_flights
from reports.run.run_data import RunData

_NUMBER, _TEXT = {"type": "number"}, {"type": "string"}

_TIME = {
    "type": "object",
    "title": "time",
    "properties": {"sec": {"type": "integer"}, "nsec": {"type": "integer"}},
}

_SCHEMAS: dict[str, dict[str, Any]] = {
    "foxglove.LocationFix": {
        "timestamp": _TIME, "frame_id": _TEXT, "latitude": _NUMBER, "longitude": _NUMBER,
        "altitude": _NUMBER,
        "position_covariance": {"type": "array", "items": _NUMBER},
        "position_covariance_type": {"type": "integer"},
    },
    "foxglove.PoseInFrame": {
        "timestamp": _TIME, "frame_id": _TEXT,
        "pose": {"type": "object", "properties": {
            "position": {"type": "object", "properties": dict.fromkeys("xyz", _NUMBER)},
            "orientation": {"type": "object", "properties": dict.fromkeys("xyzw", _NUMBER)},
        }},
    },
    "foxglove.GeoJSON": {"geojson": _TEXT},
    "plume_flight_study.Motion": dict.fromkeys(
        ("airspeed_mps", "ground_speed_mps", "climb_rate_mps", "heading_deg", "pitch_deg",
        "roll_deg"), _NUMBER
    ),
}  # fmt: skip
"""Fields of each schema (https://docs.foxglove.dev/docs/visualization/message-schemas), and the
project's own for plots.
"""

_TOPICS = {
    "/uav/fix": "foxglove.LocationFix", "/vessel/fix": "foxglove.LocationFix",
    "/uav/pose": "foxglove.PoseInFrame",
    "/uav/motion": "plume_flight_study.Motion", "/plume": "foxglove.GeoJSON",
}  # fmt: skip

_DRAWN_EVERY = 1.0
"""Time between drawings of plume and keep-out area [s]."""


class Mcap:
    """Places, attitude and motion of one flight; plume and keep-out area as GeoJSON."""

    suffix = ".mcap"
    one_flight = True

    def __init__(self) -> None:
        need_packages("mcap", "mcap")

    def write(self, run: RunData, path: Path) -> None:
        """Write one flight."""
        from mcap.writer import Writer

        # The schema says "Altitude in meters" and not above what. The programs show it as they
        # show sensor_msgs/NavSatFix, whose altitude is above the WGS 84 ellipsoid.
        flight = next(recorded_flights(run)).above_ellipsoid()
        drawn = set(flight.every(_DRAWN_EVERY))
        with path.open("wb") as file:
            writer = Writer(file)
            writer.start()
            writer.add_metadata("heights", {"reference": flight.height_reference})
            channels = {
                topic: self._channel(writer, topic, schema) for topic, schema in _TOPICS.items()
            }
            for i, time in enumerate(flight.time.tolist()):
                nanoseconds = round(1e9 * (flight.start + time))
                said = _messages(flight, i, nanoseconds) | (
                    _drawings(flight, i) if i in drawn else {}
                )
                for topic, message in said.items():
                    writer.add_message(
                        channel_id=channels[topic],
                        log_time=nanoseconds,
                        publish_time=nanoseconds,
                        data=json.dumps(message).encode(),
                    )
            writer.finish()

    @staticmethod
    def _channel(writer: Any, topic: str, schema: str) -> int:
        fields = json.dumps(
            {"type": "object", "title": schema, "properties": _SCHEMAS[schema]}
        ).encode()
        identity = writer.register_schema(name=schema, encoding="jsonschema", data=fields)
        channel: int = writer.register_channel(
            topic=topic, message_encoding="json", schema_id=identity
        )
        return channel


def _messages(flight: GeographicFlight, i: int, nanoseconds: int) -> dict[str, dict[str, Any]]:
    """Return the messages of one sample, by topic."""
    stamp = {"sec": nanoseconds // 10**9, "nsec": nanoseconds % 10**9}
    motion = {
        "airspeed_mps": float(flight.airspeed[i]), "ground_speed_mps": float(flight.uav.speed[i]),
        "climb_rate_mps": float(flight.climb_rate[i]), "heading_deg": float(flight.heading[i]),
        "pitch_deg": float(flight.pitch[i]), "roll_deg": float(flight.roll[i]),
    }  # fmt: skip
    pose = {"position": {"x": 0.0, "y": 0.0, "z": 0.0}, "orientation": _quaternion(flight, i)}
    said: dict[str, dict[str, Any]] = {
        "/uav/fix": _fix(flight.uav, i, stamp, "uav"),
        "/uav/pose": {"timestamp": stamp, "frame_id": "uav_enu", "pose": pose},
        "/uav/motion": motion,
    }
    if flight.vessel is not None:
        said["/vessel/fix"] = _fix(flight.vessel, i, stamp, "vessel")
    return said


def _fix(body: Body, i: int, stamp: dict[str, int], frame: str) -> dict[str, Any]:
    return {
        "timestamp": stamp, "frame_id": frame, "latitude": float(body.latitude[i]),
        "longitude": float(body.longitude[i]),
        "altitude": float(body.altitude[i]), "position_covariance": [0.0] * 9,
        "position_covariance_type": 0,
    }  # fmt: skip


def _drawings(flight: GeographicFlight, i: int) -> dict[str, dict[str, Any]]:
    if flight.vessel is None:
        return {}
    ring = [[longitude, latitude] for longitude, latitude in flight.keepout_ring(i)]
    geometries: list[dict[str, Any]] = [{"type": "Polygon", "coordinates": [ring]}]
    if flight.plume_end is not None:
        ends = [
            [float(body.longitude[i]), float(body.latitude[i])]
            for body in (flight.vessel, flight.plume_end)
        ]
        geometries.append({"type": "LineString", "coordinates": ends})
    features = [
        {"type": "Feature", "properties": {}, "geometry": geometry} for geometry in geometries
    ]
    return {"/plume": {"geojson": json.dumps({"type": "FeatureCollection", "features": features})}}


def _quaternion(flight: GeographicFlight, i: int) -> dict[str, float]:
    """Return the rotation from axes east, north, up to the aircraft's axes forward, left, up."""
    yaw, pitch, roll = (
        0.5 * math.radians(a) for a in (90.0 - flight.heading[i], -flight.pitch[i], flight.roll[i])
    )
    cy, sy, cp, sp, cr, sr = (
        math.cos(yaw),
        math.sin(yaw),
        math.cos(pitch),
        math.sin(pitch),
        math.cos(roll),
        math.sin(roll),
    )
    return {
        "x": sr * cp * cy - cr * sp * sy,
        "y": cr * sp * cy + sr * cp * sy,
        "z": cr * cp * sy - sr * sp * cy,
        "w": cr * cp * cy + sr * sp * sy,
    }
