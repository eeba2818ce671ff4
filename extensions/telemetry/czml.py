"""Cesium: CZML of one flight, with positions over time
(https://github.com/AnalyticalGraphicsInc/czml-writer/wiki).
"""

import json
from pathlib import Path
from typing import Any

import numpy as np

from reports.export.geographic import Body, GeographicFlight, recorded_flights
from reports.run.run_data import RunData

_UAV_COLOUR, _VESSEL_COLOUR, _PLUME_COLOUR, _KEEPOUT_COLOUR = (
    [255, 165, 0, 255], [0, 120, 255, 255], [128, 128, 128, 180], [255, 0, 0, 60],
)  # fmt: skip

_LINEAR = {"interpolationAlgorithm": "LAGRANGE", "interpolationDegree": 1}


class Czml:
    """UAV, vessel, plume and keep-out area, each moving with its flight."""

    suffix = ".czml"
    one_flight = True

    def write(self, run: RunData, path: Path) -> None:
        """Write one flight."""
        flight = next(recorded_flights(run)).above_ellipsoid()
        while_flown = f"{flight.utc(0)}/{flight.utc(-1)}"
        clock = {
            "interval": while_flown,
            "currentTime": flight.epoch,
            "multiplier": 1,
            "range": "LOOP_STOP",
        }
        packets: list[dict[str, Any]] = [
            {"id": "document", "name": flight.flight_id, "version": "1.0", "clock": clock},
            _moving(flight, "uav", "UAV", flight.uav, flight.uav.altitude.tolist(), while_flown)
            | {"point": _point(_UAV_COLOUR), "path": _path(_UAV_COLOUR)}
            | _readings(flight),
        ]
        if flight.vessel is not None:
            height = [flight.source_height] * len(flight.time)
            vessel = _moving(
                flight,
                "vessel",
                "Vessel",
                flight.vessel,
                flight.vessel.altitude.tolist(),
                while_flown,
            )
            keepout = {
                "semiMajorAxis": flight.keepout_circle,
                "semiMinorAxis": flight.keepout_circle,
                "height": flight.source_height,
            }
            packets += [
                vessel | {"point": _point(_VESSEL_COLOUR), "path": _path(_VESSEL_COLOUR)},
                _moving(flight, "funnel", "Keep-out area", flight.vessel, height, while_flown)
                | {"ellipse": keepout | {"material": _solid(_KEEPOUT_COLOUR)}},
            ]
            if flight.plume_end is not None:
                line = {
                    "positions": {"references": ["funnel#position", "plume_end#position"]},
                    "width": 4,
                    "arcType": "NONE",
                }
                end = _moving(
                    flight,
                    "plume_end",
                    "Plume",
                    flight.plume_end,
                    flight.plume_end.altitude.tolist(),
                    while_flown,
                )
                packets.append(end | {"polyline": line | {"material": _solid(_PLUME_COLOUR)}})
        path.write_text(json.dumps(packets, allow_nan=False), encoding="utf-8")


def _moving(
    flight: GeographicFlight,
    identity: str,
    name: str,
    body: Body,
    heights: list[float],
    while_flown: str,
) -> dict[str, Any]:
    samples: list[float] = []
    for time, longitude, latitude, height in zip(
        flight.time, body.longitude, body.latitude, heights, strict=True
    ):
        samples += [
            round(float(time), 3),
            round(float(longitude), 8),
            round(float(latitude), 8),
            round(float(height), 3),
        ]
    position = {
        "epoch": flight.epoch,
        "cartographicDegrees": samples,
        **_LINEAR,
    }
    return {
        "id": identity,
        "name": name,
        "description": flight.height_reference,
        "availability": while_flown,
        "position": position,
    }


def _readings(flight: GeographicFlight) -> dict[str, Any]:
    """Return the sniffer's readings as properties of the UAV over time; empty without a
    sniffer.
    """
    properties = {}
    for name, values in flight.readings.items():
        known = np.isfinite(values)
        samples = np.column_stack([flight.time[known], values[known]]).round(3).ravel().tolist()
        properties[name] = {"epoch": flight.epoch, "number": samples, **_LINEAR}
    return {"properties": properties} if properties else {}


def _point(colour: list[int]) -> dict[str, Any]:
    return {"pixelSize": 8, "color": {"rgba": colour}}


def _path(colour: list[int]) -> dict[str, Any]:
    return {"width": 2, "leadTime": 0, "material": _solid(colour)}


def _solid(colour: list[int]) -> dict[str, Any]:
    return {"solidColor": {"color": {"rgba": colour}}}
