"""Exports for globes, maps and ground stations, each read back by somebody else's reader."""

import json
import math
import os
import socket
import struct
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from common.geodesy import LocalFrame
from reports.build import export_run, stream_run
from reports.errors import ReportError
from reports.export.geographic import recorded_flights
from reports.run.run_data import read_run
from tests.in_process import assert_refused, run_command

PLACES = {"kattegat": (57.2, 11.3), "date line": (-16.0, 179.997)}
"""Where the flight is [deg]; the second one goes over the date line."""

START = 1780308000.0
"""2026-06-01T10:00:00Z (date -u -d ... +%s)."""

TOLERANCE = 0.1
"""How far places may be off what they are [m]."""


def track():
    """Return a flight in circles about a vessel that sails north-east, as a run records it."""
    time = 0.1 * np.arange(601)
    angle = 0.1 * time
    vessel = {"vessel_north_m": 5.0 * time, "vessel_east_m": 6.0 * time}
    return pd.DataFrame({
        "time_s": time, "north_m": 300.0 * np.sin(angle) + vessel["vessel_north_m"],
        "east_m": 300.0 * (1.0 - np.cos(angle)) + 250.0 + vessel["vessel_east_m"],
        "velocity_north_mps": 30.0 * np.cos(angle) + 5.0, "velocity_east_mps": 30.0 * np.sin(angle) + 6.0,
        **vessel, "vessel_velocity_north_mps": 5.0, "vessel_velocity_east_mps": 6.0, "plume_axis_rad": math.radians(230.0),
        "altitude_m": 60.0 + np.sin(time), "altitude_command_m": 60.0, "airspeed_mps": 30.0, "climb_rate_mps": np.cos(time),
        "heading_rad": angle % math.tau, "pitch_rad": 0.05, "roll_rad": 0.5, "throttle": 0.4,
    })  # fmt: skip


@pytest.fixture(params=PLACES)
def run_path(request, tmp_path):
    latitude, longitude = PLACES[request.param]
    path = tmp_path / "run"
    (path / "flights").mkdir(parents=True)
    manifest = {"study": "flights", "name": "made", "title": "Made, <&> here", "config": {}, "flights_planned": 1}
    (path / "manifest.json").write_text(json.dumps(manifest), encoding="utf-8")
    row = {
        "flight_id": "a, <b>", "trial": "made", "place_latitude_deg": latitude, "place_longitude_deg": longitude,
        "start_utc": "2026-06-01T10:00:00Z", "keepout_radius_m": 200.0, "plume_elevation_deg": 0.0,
    }  # fmt: skip
    pd.DataFrame([row]).to_csv(path / "summary.csv", index=False)
    crossing = {"flight_id": "a, <b>", "time_s": 30.05, "distance_m": 250.0}
    pd.DataFrame([crossing]).to_csv(path / "crossings.csv", index=False)
    track().to_parquet(path / "flights" / "a, <b>.parquet")
    return path


@pytest.fixture
def truth(run_path):
    """Places of UAV and vessel on earth, shape (n, 2), latitude and longitude [deg], from the recorded metres alone."""
    row, history = pd.read_csv(run_path / "summary.csv").iloc[0], track()
    frame = LocalFrame(math.radians(row["place_latitude_deg"]), math.radians(row["place_longitude_deg"]), 60.0)
    return [
        np.degrees(np.column_stack(frame.to_geodetic(history[f"{of}north_m"], history[f"{of}east_m"]))) for of in ("", "vessel_")
    ]


def off(found, true):
    """Return the largest distance of places [deg] from where they are [m]."""
    found, true = np.asarray(found, dtype=float), np.asarray(true, dtype=float)
    metres = math.radians(1.0) * 6.4e6
    east = (found[:, 1] - true[:, 1] + 180.0) % 360.0 - 180.0
    return metres * np.hypot(found[:, 0] - true[:, 0], east * np.cos(np.radians(true[:, 0]))).max()


def exported(run_path, name):
    (path,) = export_run(run_path, name)
    assert path.parent == run_path / "export"
    return path


def test_a_kmz_is_valid_by_the_schema_of_the_ogc_and_has_the_places(run_path, truth):
    from lxml import etree

    schemas = Path(pytest.importorskip("fastkml", reason="it brings the schema").__file__).parent / "schema"
    schema = etree.XMLSchema(etree.parse(schemas / "ogckml22.xsd"))
    with zipfile.ZipFile(exported(run_path, "kmz")) as archive:
        assert archive.namelist() == ["doc.kml"]
        root = etree.fromstring(archive.read("doc.kml"))
    names = {"k": "http://www.opengis.net/kml/2.2", "gx": "http://www.google.com/kml/ext/2.2"}
    # The extension has a schema of its own; what is left has to be valid without it.
    tracks = root.findall(".//gx:Track", names)
    whole = etree.XMLSchema(etree.parse(schemas / "kml22gx.xsd"))
    for place, true in zip(tracks, truth, strict=True):
        assert whole.validate(place), whole.error_log
        coordinates = np.array([[float(x) for x in coord.text.split()] for coord in place.findall("gx:coord", names)])
        assert off(coordinates[:, [1, 0]], true) < TOLERANCE
        times = [when.text for when in place.findall("k:when", names)]
        assert (times[0], times[-1], len(times)) == ("2026-06-01T10:00:00.000Z", "2026-06-01T10:01:00.000Z", 601)
    assert whole.validate(root), whole.error_log
    for place in tracks:
        place.getparent().remove(place)
    assert schema.validate(root), schema.error_log
    assert [name.text for name in root.findall(".//k:Folder/k:name", names)] == ["a, <b>"]


def test_an_acmi_file_is_read_by_another_reader(run_path, truth):
    pyacmi = pytest.importorskip("pyacmi", reason="pyacmi is a reader for developers")
    path = exported(run_path, "acmi")
    reader = pyacmi.Acmi()
    reader.load_acmi(str(path))
    assert (reader.file_type, float(reader.file_version)) == ("text/acmi/tacview", 2.2)
    times = track()["time_s"].round(3)
    for identity, true in zip(("a1", "b2"), truth, strict=True):
        body = reader.objects[identity]
        assert off([(body.latitude(time), body.longitude(time)) for time in times], true) < TOLERANCE
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
        assert (position["epoch"], position["interpolationDegree"]) == ("2026-06-01T10:00:00.000Z", 1)
        samples = np.array(position["cartographicDegrees"]).reshape(-1, 4)
        between = samples[0, 0] + np.linspace(0.0, 60.0, 1201)
        longitude, latitude = np.unwrap(samples[:, 1], period=360.0), samples[:, 2]
        found = np.column_stack([np.interp(between, samples[:, 0], values) for values in (latitude, longitude)])
        recorded = [np.interp(between, track()["time_s"], np.unwrap(true[:, k], period=360.0)) for k in (0, 1)]
        assert off(found, np.column_stack(recorded)) < TOLERANCE
    assert by_name["plume_end"]["polyline"]["positions"]["references"] == ["funnel#position", "plume_end#position"]
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
                assert message.log_time == said["timestamp"]["sec"] * 10**9 + said["timestamp"]["nsec"]
    assert off(found["/uav/fix"], truth[0]) < TOLERANCE
    assert off(found["/vessel/fix"], truth[1]) < TOLERANCE
    assert {name for name, _ in schemas} >= {"foxglove.LocationFix", "foxglove.PoseInFrame", "foxglove.GeoJSON"}
    assert {encoding for _, encoding in schemas} == {"jsonschema"}


def test_netcdf_keeps_to_the_conventions_and_has_the_places(run_path, truth, tmp_path):
    h5netcdf = pytest.importorskip("h5netcdf", reason="h5netcdf is an extra")
    pytest.importorskip("xarray", reason="xarray is an extra")
    pytest.importorskip("compliance_checker", reason="compliance-checker is for developers")
    path = exported(run_path, "netcdf")
    with h5netcdf.File(path, "r") as data:
        assert off(np.column_stack([data["lat"][:], data["lon"][:]]), truth[0]) < TOLERANCE
        assert off(np.column_stack([data["vessel_lat"][:], data["vessel_lon"][:]]), truth[1]) < TOLERANCE
        assert data["row_size"][:].tolist() == [601]
        assert data["time"][0] == START
    # In a process of its own: the checker's own packages warn as they are imported.
    checker = Path(sys.executable).with_name("compliance-checker")
    checked = subprocess.run(
        [checker, "-t", "cf:1.8", path], capture_output=True, text=True, check=False, env={**os.environ, "HOME": str(tmp_path)}
    )
    assert "All tests passed!" in checked.stdout, checked.stdout + checked.stderr


def test_geojson_has_the_places_in_pieces_that_keep_to_one_side_of_the_date_line(run_path, truth):
    collection = json.loads(exported(run_path, "geojson").read_text(encoding="utf-8"))
    by_what = {feature["properties"]["what"]: feature for feature in collection["features"]}
    assert set(by_what) == {"uav", "vessel", "keepout_at_end", "crossing"}
    for what, true in (("uav", truth[0]), ("vessel", truth[1])):
        geometry = by_what[what]["geometry"]
        parts = [geometry["coordinates"]] if geometry["type"] == "LineString" else geometry["coordinates"]
        for part in parts:
            assert np.abs(np.diff([place[0] for place in part])).max() < 1.0
        places = [place for part in parts for place in part if abs(place[0]) != 180.0]
        assert off(np.array(places)[:, [1, 0]], true) < TOLERANCE
    ring = np.array(by_what["keepout_at_end"]["geometry"]["coordinates"][0])
    assert ring[0] == pytest.approx(ring[-1], abs=1e-7)
    # Counter-clockwise, as RFC 7946 has it: its area by longitude and latitude is positive.
    assert np.sum(ring[:-1, 0] * ring[1:, 1] - ring[1:, 0] * ring[:-1, 1]) > 0.0
    at = 30.05
    north, east = (np.interp(at, track()["time_s"], track()[f"{axis}_m"]) for axis in ("north", "east"))
    row = pd.read_csv(run_path / "summary.csv").iloc[0]
    frame = LocalFrame(math.radians(row["place_latitude_deg"]), math.radians(row["place_longitude_deg"]), 60.0)
    crossed = by_what["crossing"]["geometry"]["coordinates"]
    assert off([[crossed[1], crossed[0]]], [np.degrees(np.array(frame.to_geodetic(north, east)))]) < TOLERANCE


def received(packets):
    """Return the messages in bytes, as pymavlink reads them."""
    os.environ["MAVLINK20"] = "1"
    common = pytest.importorskip("pymavlink.dialects.v20.common", reason="pymavlink is a reader for developers")
    link = common.MAVLink(None)
    return [message for packet in packets for message in link.parse_buffer(packet) or []]


def check_messages(messages, truth):
    by_type = {}
    for message in messages:
        by_type.setdefault(message.get_type(), []).append(message)
    assert "BAD_DATA" not in by_type
    places = {name: [(m.lat / 1e7, m.lon / 1e7) for m in by_type[name]] for name in
              ("GLOBAL_POSITION_INT", "AIS_VESSEL", "ADSB_VEHICLE")}  # fmt: skip
    assert off(places["GLOBAL_POSITION_INT"], truth[0]) < TOLERANCE
    for vessel in ("AIS_VESSEL", "ADSB_VEHICLE"):
        assert off(places[vessel], truth[1][::10]) < TOLERANCE
    assert len(by_type["HEARTBEAT"]) == len(by_type["SYSTEM_TIME"]) == 61
    first, at = by_type["ATTITUDE"][100], by_type["GLOBAL_POSITION_INT"][100]
    # Frame and true north differ by less than 1e-4 rad here; angles are floats.
    assert (first.roll, first.pitch, first.yaw) == pytest.approx((0.5, 0.05, 1.0), abs=1e-3)
    assert (at.time_boot_ms, at.alt) == (10000, round(1000.0 * (60.0 + math.sin(10.0))))
    assert by_type["VFR_HUD"][0].throttle == 40
    vessel = by_type["AIS_VESSEL"][0]
    assert vessel.velocity == round(100.0 * math.hypot(5.0, 6.0))
    assert pytest.approx(math.degrees(math.atan2(6.0, 5.0)), abs=0.02) == vessel.COG / 100.0


def test_a_telemetry_log_is_read_by_pymavlink(run_path, truth):
    data, packets, at = exported(run_path, "tlog").read_bytes(), [], 0
    while at < len(data):
        (microseconds,) = struct.unpack(">Q", data[at : at + 8])
        length = 12 + data[at + 9]
        packets.append(data[at + 8 : at + 8 + length])
        at += 8 + length
    assert microseconds == round(1e6 * (START + 60.0))
    check_messages(received(packets), truth)


def test_a_flight_is_streamed_in_real_time_and_received_by_a_second_process(run_path):
    receiving = "import socket, sys\ns = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)\ns.bind(('127.0.0.1', 0))\n"
    receiving += "print(s.getsockname()[1], flush=True)\ns.settimeout(10)\nn = 0\n"
    receiving += "while True:\n d = s.recv(512)\n n += 1\n if d == b'end': break\n sys.stdout.write(d.hex() + '\\n')\n"
    with subprocess.Popen([sys.executable, "-c", receiving], stdout=subprocess.PIPE, text=True) as receiver:
        port = int(receiver.stdout.readline())
        short = track().iloc[:6]
        short.to_parquet(run_path / "flights" / "a, <b>.parquet")
        name, sent, seconds = stream_run(run_path, f"udp://127.0.0.1:{port}")
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as link:
            link.sendto(b"end", ("127.0.0.1", port))
        lines = receiver.communicate(timeout=20)[0].split()
    assert (name, seconds) == ("a, <b>", 0.5)
    messages = received([bytes.fromhex(line) for line in lines])
    assert len(messages) == sent == 4 + 3 * 6
    assert {message.get_type() for message in messages} == {
        "HEARTBEAT", "SYSTEM_TIME", "AIS_VESSEL", "ADSB_VEHICLE", "ATTITUDE", "GLOBAL_POSITION_INT", "VFR_HUD",
    }  # fmt: skip


@pytest.mark.parametrize("address", ["127.0.0.1:14550", "udp://127.0.0.1", "udp://127.0.0.1:99999", "tcp://127.0.0.1:1"])
def test_an_address_that_is_none_is_refused(run_path, address):
    with pytest.raises(ReportError, match=r"give udp://HOST:PORT"):
        stream_run(run_path, address)


def test_a_flight_without_a_place_is_shown_at_the_origin(run_path):
    rows = pd.read_csv(run_path / "summary.csv").drop(columns=["place_latitude_deg", "place_longitude_deg", "start_utc"])
    rows.to_csv(run_path / "summary.csv", index=False)
    (flight,) = recorded_flights(read_run(run_path))
    assert not flight.placed
    assert flight.utc(0) == "2000-01-01T00:00:00.000Z"
    assert np.abs(flight.uav.latitude).max() < 0.01
    with zipfile.ZipFile(exported(run_path, "kmz")) as archive:
        assert b"No place is given" in archive.read("doc.kml")


def test_one_flight_can_be_chosen_and_another_name_is_refused(run_path):
    assert [path.name for path in export_run(run_path, "kmz", "a, <b>")] == ["made.a, <b>.kmz"]
    with pytest.raises(ReportError, match=r"no time history of a flight 'nu'; it has those of a, <b>"):
        export_run(run_path, "kmz", "nu")


@pytest.mark.parametrize(("name", "package"), [("mcap", "mcap"), ("netcdf", "xarray"), ("netcdf", "h5netcdf")])
def test_a_package_that_is_missing_is_one_line_with_the_extra(run_path, monkeypatch, name, package):
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(ReportError, match=r"install the extra: pip install 'plume-flight-study\[export\]'"):
        export_run(run_path, name)
    # What comes before it in a list is not written either.
    assert_refused(run_command("reports.build", run_path, "--export", f"kmz,{name}"), "install the extra")
    assert not (run_path / "export").exists()


def test_the_command_exports_several_formats_of_one_flight_and_streams_it(run_path):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        receiver.bind(("127.0.0.1", 0))
        address = f"udp://127.0.0.1:{receiver.getsockname()[1]}"
        track().iloc[:3].to_parquet(run_path / "flights" / "a, <b>.parquet")
        ended = run_command("reports.build", run_path, "--export", "tlog,geojson", "--flight", "a, <b>", "--stream", address)
    assert ended.out.splitlines() == [
        f"export: {run_path / 'export' / 'made.a, <b>.tlog'}",
        f"export: {run_path / 'export' / 'made.a, <b>.geojson'}",
        f"stream: 13 messages of a, <b>, 0 s of flight, to {address}",
    ]
    assert_refused(run_command("reports.build", run_path, "--flight", "a, <b>"), "--flight is of use beside --export or --stream")
