"""Exports for globes, maps and ground stations, each read back by another reader."""

import json
import math
import zipfile
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from common.geodesy import LocalFrame
from reports.export.geographic import recorded_flights
from reports.run.run_data import read_run
from tests.reports.export.placed_flight import READ, TOLERANCE, assert_read, exported, off, track


def test_a_kmz_is_valid_by_the_schema_of_the_ogc_and_has_the_places(run_path, truth):
    from lxml import etree

    schemas = (
        Path(pytest.importorskip("fastkml", reason="it brings the schema").__file__).parent
        / "schema"
    )
    schema = etree.XMLSchema(etree.parse(schemas / "ogckml22.xsd"))
    with zipfile.ZipFile(exported(run_path, "kmz")) as archive:
        assert archive.namelist() == ["doc.kml"]
        root = etree.fromstring(archive.read("doc.kml"))
    names = {"k": "http://www.opengis.net/kml/2.2", "gx": "http://www.google.com/kml/ext/2.2"}
    # The extension has another schema; what is left has to be valid without it.
    tracks = root.findall(".//gx:Track", names)
    whole = etree.XMLSchema(etree.parse(schemas / "kml22gx.xsd"))
    for place, true in zip(tracks, truth, strict=True):
        assert whole.validate(place), whole.error_log
        coordinates = np.array(
            [[float(x) for x in coord.text.split()] for coord in place.findall("gx:coord", names)]
        )
        assert off(coordinates[:, [1, 0]], true) < TOLERANCE
        times = [when.text for when in place.findall("k:when", names)]
        assert (times[0], times[-1], len(times)) == (
            "2026-06-01T10:00:00.000Z",
            "2026-06-01T10:01:00.000Z",
            601,
        )
    assert whole.validate(root), whole.error_log
    fields = {
        field.get("name"): field.find("k:displayName", names).text
        for field in root.iter(f"{{{names['gx']}}}SimpleArrayField")
    }
    assert fields == {
        "so2_reading_ppb": "SO2 reading [ppb]", "co2_reading_ppm": "CO2 reading [ppm]", "no_reading_ppb": "NO reading [ppb]",
    }  # fmt: skip
    uav, vessel = tracks
    (data,) = uav.findall(".//k:SchemaData", names)
    (described,) = root.findall(".//k:Schema", names)
    assert data.get("schemaUrl") == f"#{described.get('id')}"
    arrays = {array.get("name"): [value.text or "nan" for value in array] for array in data}
    assert set(arrays) == set(READ)
    for name, values in arrays.items():
        assert len(values) == len(uav.findall("k:when", names))
        assert_read(values, name)
    assert vessel.find("k:ExtendedData", names) is None
    for place in tracks:
        place.getparent().remove(place)
    assert schema.validate(root), schema.error_log
    assert [name.text for name in root.findall(".//k:Folder/k:name", names)] == ["a, <b>"]


def test_geojson_has_the_places_in_pieces_that_keep_to_one_side_of_the_date_line(run_path, truth):
    collection = json.loads(exported(run_path, "geojson").read_text(encoding="utf-8"))
    by_what = {feature["properties"]["what"]: feature for feature in collection["features"]}
    assert set(by_what) == {"uav", "vessel", "keepout_at_end", "crossing"}
    uav, vessel = (by_what[what]["properties"] for what in ("uav", "vessel"))
    for name in READ:
        assert len(uav[name]) == len(uav["times_s"])
        # Null where there is no reading: JSON has no number for it.
        assert uav[name][0] is None
        assert_read([math.nan if value is None else value for value in uav[name]], name)
    assert not {key for key in (*uav, *vessel) if "reading" in key} - set(READ)
    for what, true in (("uav", truth[0]), ("vessel", truth[1])):
        geometry = by_what[what]["geometry"]
        parts = (
            [geometry["coordinates"]]
            if geometry["type"] == "LineString"
            else geometry["coordinates"]
        )
        for part in parts:
            assert np.abs(np.diff([place[0] for place in part])).max() < 1.0
        places = [place for part in parts for place in part if abs(place[0]) != 180.0]
        assert off(np.array(places)[:, [1, 0]], true) < TOLERANCE
    geometry = by_what["keepout_at_end"]["geometry"]
    polygons = (
        [geometry["coordinates"]] if geometry["type"] == "Polygon" else geometry["coordinates"]
    )
    area = 0.0
    for (ring,) in polygons:
        x, y = np.array(ring).T
        assert np.abs(x).max() <= 180.0
        assert (x[0], y[0]) == (x[-1], y[-1])
        # Counter-clockwise, as RFC 7946 has it: its area by longitude and latitude is positive.
        part = 0.5 * float(
            np.sum((x[:-1] - x[0]) * (y[1:] - y[0]) - (x[1:] - x[0]) * (y[:-1] - y[0]))
        )
        assert part > 0.0
        area += part * math.radians(1.0) ** 2 * 6.4e6**2 * math.cos(math.radians(y[0]))
    # The earth's radii of curvature differ from 6.4e6 m by 1 %.
    assert area == pytest.approx(math.pi * 200.0**2, rel=0.02)
    at = 30.05
    north, east = (
        np.interp(at, track()["time_s"], track()[f"{axis}_m"]) for axis in ("north", "east")
    )
    row = pd.read_csv(run_path / "summary.csv").iloc[0]
    frame = LocalFrame(
        math.radians(row["place_latitude_deg"]), math.radians(row["place_longitude_deg"]), 60.0
    )
    crossed = by_what["crossing"]["geometry"]["coordinates"]
    assert (
        off([[crossed[1], crossed[0]]], [np.degrees(np.array(frame.to_geodetic(north, east)))])
        < TOLERANCE
    )


@pytest.mark.parametrize(
    ("longitude", "pieces"),
    [(179.999, 2), (-179.999, 2), (180.0, 2), (179.9, 1), (-179.9, 1), (0.0, 1)],
)
def test_a_keepout_area_over_the_date_line_is_two(run_path, longitude, pieces):
    path = run_path / "summary.csv"
    # The vessel ends 300 m and 360 m from where the frame has its origin.
    rows = pd.read_csv(path).assign(
        place_latitude_deg=-300.0 / 111e3, place_longitude_deg=longitude - 360.0 / 111.3e3
    )
    rows.to_csv(path, index=False)
    collection = json.loads(exported(run_path, "geojson").read_text(encoding="utf-8"))
    (area,) = (
        feature["geometry"]
        for feature in collection["features"]
        if feature["properties"]["what"] == "keepout_at_end"
    )
    assert area["type"] == {1: "Polygon", 2: "MultiPolygon"}[pieces]
    places = np.array(
        [
            place
            for polygon in area["coordinates"]
            for place in (polygon if pieces == 1 else polygon[0])
        ]
    ).reshape(-1, 2)
    assert np.abs(places[:, 0]).max() <= 180.0
    assert off(places[:, ::-1], np.tile([0.0, longitude], (len(places), 1))) < 210.0


def test_a_track_of_one_place_is_a_point(run_path):
    path = run_path / "flights" / "a, <b>.parquet"
    pd.read_parquet(path).iloc[:1].to_parquet(path)
    collection = json.loads(exported(run_path, "geojson").read_text(encoding="utf-8"))
    kinds = {
        feature["properties"]["what"]: feature["geometry"]["type"]
        for feature in collection["features"]
    }
    assert (kinds["uav"], kinds["vessel"]) == ("Point", "Point")


def test_a_ship_that_stops_keeps_its_heading(run_path):
    path = run_path / "flights" / "a, <b>.parquet"
    history = pd.read_parquet(path)
    history.loc[300:, ["vessel_velocity_north_mps", "vessel_velocity_east_mps"]] = 0.0
    history.to_parquet(path)
    (flight,) = recorded_flights(read_run(run_path))
    # At its place true north turns by a hundredth of a degree.
    assert flight.vessel_heading == pytest.approx(
        np.full(601, math.degrees(math.atan2(6.0, 5.0))), abs=0.02
    )


def test_a_flight_without_a_place_is_shown_at_the_origin(run_path):
    rows = pd.read_csv(run_path / "summary.csv").drop(
        columns=["place_latitude_deg", "place_longitude_deg", "start_utc"]
    )
    rows.to_csv(run_path / "summary.csv", index=False)
    (flight,) = recorded_flights(read_run(run_path))
    assert not flight.placed
    assert flight.utc(0) == "2000-01-01T00:00:00.000Z"
    assert np.abs(flight.uav.latitude).max() < 0.01
    with zipfile.ZipFile(exported(run_path, "kmz")) as archive:
        assert b"No place is given" in archive.read("doc.kml")
