"""Exports for Tacview, Cesium and Foxglove, read back by programs of others where there are any."""

import json

import numpy as np
import pytest

from tests.reports.export.placed_flight import TOLERANCE, exported, off, track


def test_an_acmi_file_is_read_by_another_reader(run_path, truth):
    pyacmi = pytest.importorskip("pyacmi", reason="pyacmi is a reader for developers")
    path = exported(run_path, "acmi")
    reader = pyacmi.Acmi()
    reader.load_acmi(str(path))
    assert (reader.file_type, float(reader.file_version)) == ("text/acmi/tacview", 2.2)
    times = track()["time_s"].round(3)
    for identity, true in zip(("a1", "b2"), truth, strict=True):
        body = reader.objects[identity]
        assert (
            off([(body.latitude(time), body.longitude(time)) for time in times], true) < TOLERANCE
        )
    text = path.read_text(encoding="utf-8-sig")
    assert "0,ReferenceTime=2026-06-01T10:00:00.000Z" in text
    assert "EngagementRange=200" in text
    assert "0,Title=a\\, <b>" in text


def test_czml_positions_interpolate_to_the_places(run_path, truth):
    packets = json.loads(exported(run_path, "czml").read_text(encoding="utf-8"))
    assert packets[0]["id"] == "document"
    assert packets[0]["version"] == "1.0"
    by_name = {packet["id"]: packet for packet in packets}
    for name, true in (("uav", truth[0]), ("vessel", truth[1])):
        position = by_name[name]["position"]
        assert (position["epoch"], position["interpolationDegree"]) == (
            "2026-06-01T10:00:00.000Z",
            1,
        )
        samples = np.array(position["cartographicDegrees"]).reshape(-1, 4)
        between = samples[0, 0] + np.linspace(0.0, 60.0, 1201)
        longitude, latitude = np.unwrap(samples[:, 1], period=360.0), samples[:, 2]
        found = np.column_stack(
            [np.interp(between, samples[:, 0], values) for values in (latitude, longitude)]
        )
        recorded = [
            np.interp(between, track()["time_s"], np.unwrap(true[:, k], period=360.0))
            for k in (0, 1)
        ]
        assert off(found, np.column_stack(recorded)) < TOLERANCE
    assert by_name["plume_end"]["polyline"]["positions"]["references"] == [
        "funnel#position",
        "plume_end#position",
    ]
    assert by_name["funnel"]["ellipse"]["semiMajorAxis"] == 200.0


def test_mcap_is_read_by_its_own_reader(run_path, truth):
    reader = pytest.importorskip("mcap.reader", reason="mcap is an extra")
    with exported(run_path, "mcap").open("rb") as file:
        found = {"/uav/fix": [], "/vessel/fix": []}
        schemas = set()
        for schema, channel, message in reader.make_reader(file).iter_messages():
            schemas.add((schema.name, schema.encoding))
            said = json.loads(message.data)
            assert json.loads(schema.data)["properties"].keys() == said.keys()
            if channel.topic in found:
                found[channel.topic].append((said["latitude"], said["longitude"]))
                assert (
                    message.log_time == said["timestamp"]["sec"] * 10**9 + said["timestamp"]["nsec"]
                )
    assert off(found["/uav/fix"], truth[0]) < TOLERANCE
    assert off(found["/vessel/fix"], truth[1]) < TOLERANCE
    assert {name for name, _ in schemas} >= {
        "foxglove.LocationFix",
        "foxglove.PoseInFrame",
        "foxglove.GeoJSON",
    }
    assert {encoding for _, encoding in schemas} == {"jsonschema"}
