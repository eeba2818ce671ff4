"""Google Earth: KML 2.2 with gx:Track, zipped, written with the standard library."""

import math
import zipfile
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree as ET

from reports.export.exporter import EXPORTERS
from reports.export.geographic import READINGS, Body, GeographicFlight, recorded_flights
from reports.run.run_data import RunData

_KML, _GX = "http://www.opengis.net/kml/2.2", "http://www.google.com/kml/ext/2.2"

_READINGS = "readings"
"""Name of the schema of what sniffers read."""

_SHOWN = 200
"""How many times plume and keep-out area are drawn in a flight at most, each for a while."""

_SHOWN_EVERY = 5.0
"""Least time between them [s]."""

_EPOCH = (1980, 1, 1, 0, 0, 0)
"""Time of the files in the archive: the same run gives the same bytes."""


@EXPORTERS.register("kmz")
class Kmz:
    """A folder for each flight: tracks of UAV and vessel, the plume's axis and the keep-out area
    over time.
    """

    suffix = ".kmz"

    def write(self, run: RunData, path: Path) -> None:
        """Write all flights that have a time history; the first one is shown at once."""
        ET.register_namespace("", _KML)
        ET.register_namespace("gx", _GX)
        root = ET.Element(_kml("kml"))
        document = ET.SubElement(root, _kml("Document"))
        _text(document, "name", str(run.manifest.get("name", "run")))
        _style(document, "uav", line="ff00a5ff", width="2")
        _style(document, "vessel", line="ffff7800", width="3")
        _style(document, "plume", line="b4808080", width="4")
        _style(document, "keepout", line="ff0000ff", width="2", fill="400000ff")
        begin, read = len(document), set[str]()
        for number, flight in enumerate(recorded_flights(run)):
            document.append(_folder(flight, shown=number == 0))
            read.update(flight.readings)
        if read:
            document.insert(begin, _schema(read))
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            entry = zipfile.ZipInfo("doc.kml", _EPOCH)
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, ET.tostring(root, encoding="UTF-8", xml_declaration=True))


def _folder(flight: GeographicFlight, *, shown: bool) -> ET.Element:
    folder = ET.Element(_kml("Folder"))
    _text(folder, "name", flight.flight_id)
    _text(folder, "visibility", "1" if shown else "0")
    about = [flight.height_reference]
    if not flight.placed:
        about.append("No place is given for this flight: it is shown at latitude and longitude 0.")
    _text(folder, "description", " ".join(about))
    angles = [
        f"{h:.2f} {p:.2f} {r:.2f}"
        for h, p, r in zip(flight.heading, flight.pitch, flight.roll, strict=True)
    ]
    uav = _track(flight, "UAV", "uav", flight.uav, angles)
    if flight.readings:
        _append_readings(uav, flight)
    folder.append(uav)
    if flight.vessel is not None:
        # A ship is flat on the sea.
        folder.append(
            _track(
                flight,
                "Vessel",
                "vessel",
                flight.vessel,
                [f"{bow:.2f} 0 0" for bow in flight.vessel_heading],
            )
        )
        for i, until in _whiles(flight):
            folder.append(_plume(flight, i, until))
            folder.append(_keepout(flight, i, until))
    return folder


def _track(
    flight: GeographicFlight, name: str, style: str, body: Body, angles: list[str]
) -> ET.Element:
    placemark = _placemark(name, style)
    track = ET.SubElement(placemark, _gx("Track"))
    _text(track, "altitudeMode", "absolute")
    for i in range(len(flight.time)):
        _text(track, "when", flight.utc(i))
    for longitude, latitude, altitude in zip(
        body.longitude, body.latitude, body.altitude, strict=True
    ):
        ET.SubElement(track, _gx("coord")).text = f"{longitude:.8f} {latitude:.8f} {altitude:.3f}"
    for angle in angles:
        ET.SubElement(track, _gx("angles")).text = angle
    return placemark


def _schema(read: set[str]) -> ET.Element:
    """Return the declaration of what sniffers read, with names and units for Google Earth's
    elevation profile.
    """
    schema = ET.Element(_kml("Schema"), id=_READINGS, name=_READINGS)
    for name, label in READINGS.items():
        if name in read:
            _text(
                ET.SubElement(schema, _gx("SimpleArrayField"), name=name, type="float"),
                "displayName",
                label,
            )
    return schema


def _append_readings(placemark: ET.Element, flight: GeographicFlight) -> None:
    """Append what the sniffer read to the track of a placemark, a value for each of its times; an
    empty one where there is none.
    """
    track = placemark.find(_gx("Track"))
    if track is None:
        return
    data = ET.SubElement(
        ET.SubElement(track, _kml("ExtendedData")), _kml("SchemaData"), schemaUrl=f"#{_READINGS}"
    )
    for name, values in flight.readings.items():
        array = ET.SubElement(data, _gx("SimpleArrayData"), name=name)
        for value in values.tolist():
            ET.SubElement(array, _gx("value")).text = f"{value:.6g}" if math.isfinite(value) else ""


def _plume(flight: GeographicFlight, i: int, until: int) -> ET.Element:
    placemark = _placemark("Plume", "plume", flight, i, until)
    line = ET.SubElement(placemark, _kml("LineString"))
    _text(line, "altitudeMode", "absolute")
    ends = [(flight.vessel, flight.source_height), (flight.plume_end, None)]
    places = [
        (body.longitude[i], body.latitude[i], body.altitude[i] if height is None else height)
        for body, height in ends
        if body is not None
    ]
    words = (f"{east:.8f},{north:.8f},{height:.3f}" for east, north, height in places)
    _text(line, "coordinates", " ".join(words))
    return placemark


def _keepout(flight: GeographicFlight, i: int, until: int) -> ET.Element:
    placemark = _placemark("Keep-out area", "keepout", flight, i, until)
    polygon = ET.SubElement(placemark, _kml("Polygon"))
    _text(polygon, "altitudeMode", "absolute")
    ring = ET.SubElement(ET.SubElement(polygon, _kml("outerBoundaryIs")), _kml("LinearRing"))
    corners = [
        f"{longitude:.8f},{latitude:.8f},{flight.source_height:.3f}"
        for longitude, latitude in flight.keepout_ring(i)
    ]
    _text(ring, "coordinates", " ".join(corners))
    return placemark


def _whiles(flight: GeographicFlight) -> Iterator[tuple[int, int]]:
    """Yield from and until which samples plume and keep-out area are drawn as they were."""
    seconds = max(_SHOWN_EVERY, float(flight.time[-1] - flight.time[0]) / _SHOWN)
    shown = flight.every(seconds)
    yield from pairwise(shown)


def _placemark(
    name: str, style: str, flight: GeographicFlight | None = None, i: int = 0, until: int = 0
) -> ET.Element:
    placemark = ET.Element(_kml("Placemark"))
    _text(placemark, "name", name)
    if flight is not None:
        span = ET.SubElement(placemark, _kml("TimeSpan"))
        _text(span, "begin", flight.utc(i))
        _text(span, "end", flight.utc(until))
    _text(placemark, "styleUrl", f"#{style}")
    return placemark


def _style(
    document: ET.Element, name: str, *, line: str, width: str, fill: str | None = None
) -> None:
    style = ET.SubElement(document, _kml("Style"), id=name)
    drawn = ET.SubElement(style, _kml("LineStyle"))
    _text(drawn, "color", line)
    _text(drawn, "width", width)
    if fill:
        _text(ET.SubElement(style, _kml("PolyStyle")), "color", fill)


def _text(parent: ET.Element, name: str, text: str) -> None:
    ET.SubElement(parent, _kml(name)).text = text


def _kml(name: str) -> str:
    return f"{{{_KML}}}{name}"


def _gx(name: str) -> str:
    return f"{{{_GX}}}{name}"
