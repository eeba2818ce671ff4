"""One flight has one height in all formats, each above what its specification has heights above."""

import json
import struct
import zipfile
from xml.etree import ElementTree as ET

import numpy as np
import pandas as pd
import pytest

from tests.reports.export.placed_flight import exported, track
from tests.run_tables import write_manifest

pytestmark = pytest.mark.slow

GEOID = 36.25
"""Mean sea level above the ellipsoid [m]; EGM2008 has some 36 m in the Kattegat."""

CENTIMETRE = 0.01
"""[m]"""


@pytest.fixture(params=[GEOID, None])
def geoid(request, run_path):
    """Give the run a place with a geoid height, or none, as runs have that were made without it."""
    manifest = json.loads((run_path / "manifest.json").read_text(encoding="utf-8"))
    place = {} if request.param is None else {"geoid_m": request.param}
    write_manifest(run_path, manifest | {"trials": {"made": {"place": place}}})
    return request.param or 0.0


def from_kmz(path):
    with zipfile.ZipFile(path) as archive:
        text = archive.read("doc.kml").decode()
    root = ET.fromstring(text)
    kml, gx = "{http://www.opengis.net/kml/2.2}", "{http://www.google.com/kml/ext/2.2}"
    uav = next(root.iter(f"{gx}Track"))
    assert uav.findtext(f"{kml}altitudeMode") == "absolute"
    heights = [float(at.text.split()[2]) for at in uav.iter(f"{gx}coord")]
    return heights, next(root.iter(f"{kml}Folder")).findtext(f"{kml}description")


def from_geojson(path):
    features = json.loads(path.read_text(encoding="utf-8"))["features"]
    uav = next(each for each in features if each["properties"]["what"] == "uav")
    shape = uav["geometry"]
    parts = shape["coordinates"] if shape["type"] == "MultiLineString" else [shape["coordinates"]]
    # Places on the date line are where the track is cut, and no samples.
    heights = [at[2] for part in parts for at in part if abs(at[0]) != 180.0]
    return heights, uav["properties"]["height_reference"]


def from_netcdf(path):
    xarray = pytest.importorskip("xarray", reason="of the extra export")
    with xarray.open_dataset(path, engine="h5netcdf") as data:
        # CF: altitude is above the geoid.
        assert data["alt"].attrs["standard_name"] == "altitude"
        return data["alt"].to_numpy(), data["alt"].attrs["comment"]


def from_tracks_csv(path):
    # A table has no place to say it; its documentation does.
    return pd.read_csv(path)["altitude_m"], "mean sea level"


def from_acmi(path):
    text = path.read_text(encoding="utf-8-sig")
    heights = [float(line.split("|")[2]) for line in text.splitlines() if line.startswith("a1,")]
    (said,) = (line for line in text.splitlines() if line.startswith("0,Comments="))
    return heights, said


def from_czml(path):
    uav = json.loads(path.read_text(encoding="utf-8"))[1]
    return uav["position"]["cartographicDegrees"][3::4], uav["description"]


def from_mcap(path):
    reading = pytest.importorskip("mcap.reader", reason="of the extra export")
    with path.open("rb") as file:
        reader = reading.make_reader(file)
        (said,) = (record.metadata["reference"] for record in reader.iter_metadata())
        messages = reader.iter_messages(topics=["/uav/fix"])
        return [json.loads(message.data)["altitude"] for _, _, message in messages], said


def from_tlog(path):
    data, at, heights, said = path.read_bytes(), 0, [], ""
    while at < len(data):
        size = data[at + 9]
        number, payload = data[at + 15], data[at + 18 : at + 18 + size].ljust(60, b"\0")
        if number == 33:  # GLOBAL_POSITION_INT: time, latitude, longitude, altitude [mm]
            heights.append(struct.unpack("<I3i", payload[:16])[3] / 1e3)
        if number == 253:  # STATUSTEXT: severity, text
            said = payload[1:51].rstrip(b"\0").decode()
        at += 8 + 10 + size + 2
    return heights, said


ABOVE_ELLIPSOID = {"geojson": from_geojson, "czml": from_czml, "mcap": from_mcap}
"""RFC 7946, 4; CZML's cartographicDegrees; sensor_msgs/NavSatFix."""

ABOVE_SEA = {
    "kmz": from_kmz, "netcdf": from_netcdf, "tracks_csv": from_tracks_csv, "acmi": from_acmi, "tlog": from_tlog,
}  # fmt: skip
"""KML's absolute; CF's altitude; the run itself; ACMI 2.2; MAVLink's alt."""


@pytest.mark.parametrize("name", [*ABOVE_ELLIPSOID, *ABOVE_SEA])
def test_heights_are_above_what_the_format_demands_and_the_file_says_it(run_path, geoid, name):
    read = (ABOVE_ELLIPSOID | ABOVE_SEA)[name]
    heights, said = read(exported(run_path, name))
    raised, reference = (
        (geoid, "WGS 84 ellipsoid") if name in ABOVE_ELLIPSOID else (0.0, "mean sea level")
    )
    assert np.asarray(heights) == pytest.approx(track()["altitude_m"] + raised, abs=CENTIMETRE)
    assert reference in said.split(";")[0]
    if geoid and name in ABOVE_ELLIPSOID:
        assert f"{geoid:g} m" in said
