"""Reports of an AIS receiver in NMEA sentences, and a flight that is flown by them alone."""

import math
import socket
from contextlib import closing

import pandas as pd
import pytest

from common.physics import METRES_PER_SECOND_PER_KNOT
from extensions.companion.ais_line import AisReceiver
from extensions.companion.ports import opened, opened_input
from scenarios.world.ais.size import ShipSize
from tests.extensions.companion.served import companion, free_port, served

pytestmark = pytest.mark.slow

encode = pytest.importorskip("pyais.encode", reason="pyais is an extra")

NOW = 1780308000.0

REPORT = {
    "msg_type": 1,
    "mmsi": 219999001,
    "lat": 57.5,
    "lon": 11.25,
    "speed": 12.0,
    "course": 90.0,
    "heading": 95,
}

EVER_DIADEM = (
    "!AIVDM,2,1,1,A,55?MbV02;H;s<HtKR20EHE:0@T4@Dn2222222216L961O5Gf0NSQEp6ClRp8,0*1C",
    "!AIVDM,2,2,1,A,88888888880,2*25",
)
"""Static report of a ship as received, whose antenna is 225 m from the bow, 70 m from the stern, 1 m
from port and 31 m from starboard (E. S. Raymond, AIVDM/AIVDO protocol decoding, example of type
5)."""


def sentence(**changed):
    return encode.encode_dict(REPORT | changed, talker_id="AI")[0]


@pytest.fixture
def receiver():
    """Return a receiver on a UDP port, and what sends it lines and returns its reports."""
    address = f"udp://127.0.0.1:{free_port(socket.SOCK_DGRAM)}"
    with (
        closing(opened_input("--ais", address)) as line,
        closing(opened("--ais", address, listening=False)) as sender,
    ):
        found = AisReceiver(line, clock=lambda: NOW)
        (peer,) = sender.connected()

        def said(*lines):
            for text in lines:
                sender.send(text.encode() + b"\r\n", peer)
            return found.receive()

        yield found, said


def test_a_report_is_true_when_it_comes_or_when_its_tag_block_says(receiver):
    _, said = receiver
    now, before, milliseconds = said(
        sentence(), f"\\s:r1,c:{NOW - 7:.0f}*00\\{sentence()}", f"\\c:{1e3 * NOW - 2500:.0f}*00\\{sentence()}"
    )  # fmt: skip
    assert [now.age, before.age, milliseconds.age] == pytest.approx([0.0, 7.0, 2.5])
    # A sentence has places in 1/10,000 minutes and speeds in tenths of knots.
    assert math.degrees(now.latitude) == pytest.approx(57.5, abs=1e-6)
    assert math.degrees(now.longitude) == pytest.approx(11.25, abs=1e-6)
    assert now.velocity_east == pytest.approx(12.0 * METRES_PER_SECOND_PER_KNOT)
    assert now.velocity_north == pytest.approx(0.0, abs=1e-9)
    assert math.degrees(now.bow) == pytest.approx(95.0)
    assert (now.mmsi, now.size) == (219999001, None)


def test_a_report_from_the_future_is_refused_and_counted(receiver):
    found, said = receiver
    assert said(f"\\c:{NOW + 30:.0f}*00\\{sentence()}") == []
    assert found.from_future == 1
    # Times have whole seconds: one of this second is none from the future.
    assert len(said(f"\\c:{NOW + 1:.0f}*00\\{sentence()}")) == 1
    assert found.lines() == ["reports of AIS from the future: 1"]


def test_damaged_lines_are_left_out_and_counted(receiver):
    found, said = receiver
    good = sentence()
    digit = "1" if good[20] != "1" else "2"
    damaged = (
        good[:20] + digit + good[21:],
        "!AIVDM,1,1,,A,garbage,0*00",
        good[:25],
        "rubbish",
        "\xff\xfe",
    )
    assert said(*damaged) == []
    assert found.unreadable == len(damaged)
    # Other instruments on the line are not damaged, and an empty line is nothing.
    assert said("$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47", "") == []
    assert found.unreadable == len(damaged)
    assert len(said(good)) == 1


@pytest.mark.parametrize("changed", [{"lat": 91.0}, {"lon": 181.0}, {"speed": 102.3}, {"course": 360.0}])  # fmt: skip
def test_what_is_not_available_is_no_report(receiver, changed):
    found, said = receiver
    assert said(sentence(**changed)) == []
    assert (found.without_place, found.unreadable) == (1, 0)


def test_a_static_message_says_the_size_of_the_reports_after_it(receiver):
    _, said = receiver
    of_ship = sentence(mmsi=351759000)
    first, after, other = said(of_ship, *EVER_DIADEM, of_ship, sentence())
    assert (first.size, other.size) == (None, None)
    assert after.size == ShipSize(295.0, 32.0, 225.0, 1.0)


def test_a_receiver_over_tcp_is_connected_to():
    port = free_port()
    with socket.create_server(("127.0.0.1", port)) as server:
        with closing(opened_input("--ais", f"tcp://127.0.0.1:{port}")) as line:
            stream, _ = server.accept()
            found = AisReceiver(line)
            text = sentence().encode() + b"\r\n"
            with stream:
                # Pieces of a stream are no lines.
                stream.sendall(text[:20])
                assert found.receive() == []
                stream.sendall(text[20:] + text)
                reports = found.receive()
        assert [report.mmsi for report in reports] == [219999001, 219999001]
    assert found.unreadable == 0


FLIGHT = ("reports.interval_s=[10,10]", "flight.crossings=4", "fidelity=kinematic", "flights=1",
          "vessel.speed_mps=5", "wind.speed_mps=5", "wind.from_deg=20", "draws=[]",
          "guidance.rate_hz=10")  # fmt: skip


def flown_by_sentences(out, *more, options=()):
    """Fly with a vehicle that tells no AIS_VESSEL, and a receiver that hears the same reports;
    ``more`` are lines that it hears before each.
    """
    address = f"127.0.0.1:{free_port(socket.SOCK_DGRAM)}"
    with closing(opened("--ais", f"udp://{address}", listening=False)) as sender:
        (peer,) = sender.connected()

        def change(message):
            if message.get_type() != "AIS_VESSEL":
                return message
            said = sentence(
                mmsi=351759000,
                lat=1e-7 * message.lat,
                lon=1e-7 * message.lon,
                speed=0.01 * message.velocity / METRES_PER_SECOND_PER_KNOT,
                course=0.01 * message.COG,
                heading=round(0.01 * message.heading) % 360,
            )
            sender.send("\r\n".join([*more, said, ""]).encode(), peer)
            return None

        with served("sea_wind", *FLIGHT, change=change) as vehicle:
            ended = companion(vehicle, "sea_wind", out, "--lockstep", "--no-report", "--ais",
                              f"udp://{address}", *options, settings=FLIGHT)  # fmt: skip
    return ended, vehicle


def test_a_flight_is_flown_by_sentences_alone(tmp_path):
    ended, vehicle = flown_by_sentences(tmp_path / "run", "!AIVDM,1,1,,A,garbage,0*00")
    assert ended.status == 0, ended
    row = pd.read_csv(tmp_path / "run" / "summary.csv").iloc[0]
    assert row["outcome"] == "completed"
    assert vehicle.simulation.closest > 200.0
    assert "lines of AIS that were damaged, or no NMEA: " in ended.out


def test_a_ship_that_is_larger_than_what_is_kept_is_refused(tmp_path):
    # Its hull reaches hypot(225, 31) = 227 m from its antenna, and 200 m are kept.
    ended, vehicle = flown_by_sentences(tmp_path / "run", *EVER_DIADEM)
    assert ended.status == 1, ended
    message = pd.read_csv(tmp_path / "run" / "summary.csv").iloc[0]["message"]
    assert "295 m by 32 m" in message
    assert "227 m" in message
    assert vehicle.count("SET_ATTITUDE_TARGET") == 0
