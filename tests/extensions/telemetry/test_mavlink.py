"""Telemetry of a flight, as a log and as a stream, read by pymavlink."""

import math
import os
import socket
import struct
import time

import pytest

from reports.build import stream_run
from reports.errors import ReportError
from tests.in_process import assert_refused, run_command
from tests.reports.export.placed_flight import START, TOLERANCE, exported, off, track


def received(packets):
    """Return the messages in bytes, as pymavlink reads them."""
    os.environ["MAVLINK20"] = "1"
    common = pytest.importorskip(
        "pymavlink.dialects.v20.common", reason="pymavlink is a reader for developers"
    )
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
    # AIS_FLAGS: POSITION_ACCURACY, VALID_COG, VALID_VELOCITY, VALID_NAME; the turn rate is
    # not known.
    assert vessel.flags == 1 | 2 | 4 | 4096
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


def test_a_flight_is_streamed_in_real_time(run_path):
    track().iloc[:6].to_parquet(run_path / "flights" / "a, <b>.parquet")
    began = time.monotonic()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        receiver.bind(("127.0.0.1", 0))
        receiver.settimeout(10.0)
        port = receiver.getsockname()[1]
        name, sent, seconds = stream_run(run_path, f"udp://127.0.0.1:{port}")
        took = time.monotonic() - began
        messages = received([receiver.recv(512) for _ in range(sent)])
    assert (name, seconds) == ("a, <b>", 0.5)
    assert took >= seconds
    # What heights are above, four a second, and three for each sample.
    assert len(messages) == sent == 1 + 4 + 3 * 6
    assert {message.get_type() for message in messages} == {
        "HEARTBEAT", "SYSTEM_TIME", "AIS_VESSEL", "ADSB_VEHICLE", "ATTITUDE", "GLOBAL_POSITION_INT", "VFR_HUD",
        "STATUSTEXT",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("address", "words"),
    [
        ("127.0.0.1:14550", "known are udp://..."),
        ("udp://127.0.0.1", "give udp://HOST:PORT"),
        ("udp://127.0.0.1:99999", "give udp://HOST:PORT"),
        ("tcp://127.0.0.1:1", "known are udp://..."),
    ],
)
def test_an_address_that_is_none_is_refused(run_path, address, words):
    with pytest.raises(ReportError, match=words):
        stream_run(run_path, address)


def test_the_command_exports_and_streams_one_flight(run_path):
    track().iloc[:3].to_parquet(run_path / "flights" / "a, <b>.parquet")
    flight = ("--flight", "a, <b>")
    ways = ("--export", "tlog,geojson", "--stream", "udp://127.0.0.1:9")
    ended = run_command("reports.build", run_path, *flight, *ways)
    assert [line.split(":")[0] for line in ended.out.splitlines()] == ["export", "export", "stream"]
    ended = run_command("reports.build", run_path, *flight)
    assert_refused(ended, "--flight is of use beside --export or --stream")
