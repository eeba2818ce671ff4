"""Declared links, lines and malformed or foreign packets."""

import random
import socket
import time

import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from extensions.companion.ports import Port, opened
from extensions.companion.quality import Link, SimulatedLink
from extensions.companion.remote_vehicle import retreat
from scenarios.errors import InputError
from tests.extensions.companion.served import free_port, served

KINEMATIC = ("comparison.nu=[]", "sweep.nu=[0.5]", "fidelity=kinematic")


def test_a_link_is_declared_in_words():
    link = Link.of("latency=0.2,jitter=0.05,loss=0.05,silence=1")
    assert link == Link(latency=0.2, jitter=0.05, loss=0.05, silence=1.0)
    assert Link.of("") == Link()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("latancy=0.2", "latency"),
        ("loss=0.6", "from 0 to 0.5"),
        ("latency=-1", "from 0 to 10"),
        ("jitter=nan", "from 0 to 10"),
        ("jitter=x", "give a number"),
    ],
)
def test_a_link_that_is_none_is_refused(text, words):
    with pytest.raises(InputError, match=words):
        Link.of(text)


def test_the_dead_time_is_that_of_both_directions():
    link = Link(latency=0.2, jitter=0.06)
    # Telemetry waits for the slowest of its kind; commands arrive in the mean of theirs.
    assert link.dead_time == pytest.approx((0.2 + 0.06) + (0.2 + 0.03))
    assert link.late(0.05, 600.0) == pytest.approx(0.03)


def test_losses_in_a_row_are_as_many_as_a_flight_may_see():
    """By simulation: of 200 flights of 12,000 commands at 5 % loss, few have a longer gap."""
    time_step, duration, loss = 0.05, 600.0, 0.05
    allowed = round(Link(loss=loss).late(time_step, duration) / time_step)
    lost = np.random.default_rng(1).random((200, round(duration / time_step))) < loss
    in_a_row = np.lib.stride_tricks.sliding_window_view(lost, allowed + 1, axis=1)
    # At most one flight in a hundred; 8 of 200 are exceeded with a probability below 1e-3.
    assert np.count_nonzero(in_a_row.all(axis=2).any(axis=1)) <= 8
    assert allowed < 8


def test_messages_are_late_lost_and_overtaken_as_declared():
    link = SimulatedLink(Link(latency=0.2, jitter=0.1, loss=0.25), 7)
    sent = 4000
    for number in range(sent):
        link.put(0.01 * number, number)
    arrived, at = {}, 0.0
    while len(arrived) < sent and at < 60.0:
        at += 0.005
        for number in link.due(at):
            arrived[number] = at
    share = len(arrived) / sent
    # Four standard deviations of a binomial.
    assert share == pytest.approx(0.75, abs=4.0 * (0.25 * 0.75 / sent) ** 0.5)
    delays = [at - 0.01 * number for number, at in arrived.items()]
    assert min(delays) >= 0.2 - 1e-9
    assert max(delays) <= 0.3 + 0.005 + 1e-9
    assert list(arrived) != sorted(arrived)


@pytest.mark.parametrize(
    "address", ["127.0.0.1:5760", "http://127.0.0.1:5760", "tcp://127.0.0.1", "udp://host:99999"]
)
def test_an_address_that_is_none_is_refused(address):
    with pytest.raises(InputError, match="give udp://HOST:PORT"):
        opened("--connect", address, listening=False)


def test_a_port_that_is_taken_is_refused_in_one_line():
    port = free_port()
    with (
        socket.create_server(("127.0.0.1", port)),
        pytest.raises(InputError, match="cannot be opened"),
    ):
        opened("--listen", f"tcp://127.0.0.1:{port}", listening=True)


@pytest.mark.parametrize("scheme", ["tcp", "udp"])
def test_messages_go_both_ways_and_damaged_ones_are_counted(scheme):
    kind = socket.SOCK_DGRAM if scheme == "udp" else socket.SOCK_STREAM
    address = f"{scheme}://127.0.0.1:{free_port(kind)}"
    beat = mavlink.MAVLink_heartbeat_message(1, 3, 0, 0, 4, 3)
    with (
        Port(opened("--listen", address, listening=True), system=1, component=1) as there,
        Port(opened("--connect", address, listening=False), system=1, component=191) as here,
    ):
        here.send(beat)
        (peer, found), *_ = received(there)
        assert found.get_srcComponent() == 191
        there.send(beat, peer)
        assert received(here)[0][1].get_srcComponent() == 1
        damaged = bytearray(beat.pack(mavlink.MAVLink(None, srcSystem=1, srcComponent=191)))
        damaged[12] ^= 0xFF
        here._line.send(bytes(damaged), here._line.connected()[0])
        here._line.send(b"GET / HTTP/1.1\r\n\r\n" * 20, here._line.connected()[0])
        here.send(beat)
        assert [message.get_type() for _, message in received(there)][-1] == "HEARTBEAT"
        assert there.malformed > 0


def received(port):
    until, found = time.monotonic() + 5.0, []
    while not found and time.monotonic() < until:
        found = port.receive(0.1)
    return found


def test_no_message_and_no_rubbish_ends_the_vehicle():
    """Every message of the dialect, with numbers at random, and bytes at random."""
    generator = random.Random(3)
    with served("sim3", *KINEMATIC) as vehicle:
        host, port = vehicle.url.removeprefix("tcp://").split(":")
        packer = mavlink.MAVLink(None, srcSystem=255, srcComponent=191)
        with socket.create_connection((host, int(port))) as link:
            for kind in mavlink.mavlink_map.values():
                # A clock far ahead would be flown up to.
                if kind.msgname == "SYSTEM_TIME":
                    continue
                for _ in range(3):
                    length = kind.unpacker.size
                    packet = bytes(generator.randrange(256) for _ in range(length))
                    link.sendall(packed(kind, packet, packer))
            link.sendall(bytes(generator.randrange(256) for _ in range(5000)))
            link.sendall(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3).pack(packer))
            until = time.monotonic() + 20.0
            while vehicle.count("HEARTBEAT", after=-1.0) == 0 and time.monotonic() < until:
                time.sleep(0.05)
        assert vehicle.simulation.time == 0.0
        vehicle.simulation.step()
    assert len({message.get_type() for _, message in vehicle.received}) > 100


def packed(kind, payload, packer):
    """Return a packet of a kind with a payload, and the checksum that belongs to it."""
    message = mavlink.MAVLink_message(kind.id, kind.msgname)
    message.crc_extra = kind.crc_extra
    # Its own packing writes header and checksum.
    packet = mavlink.MAVLink_message._pack(message, packer, kind.crc_extra, payload)
    packer.seq = (packer.seq + 1) % 256
    return packet


@pytest.mark.parametrize("own", [(250.0, 0.0), (0.0, 250.0), (-250.0, 30.0), (180.0, -180.0)])
@pytest.mark.parametrize("vessel", [(0.0, 0.0), (8.0, 0.0), (0.0, -5.0)])
def test_a_retreat_is_never_in_the_way_of_the_vessel(own, vessel):
    keep, speed = 360.0, 19.0
    place = retreat(own, vessel, keep=keep, speed=speed)
    seconds = np.arange(3600.0)[:, None]
    distances = np.linalg.norm(np.array(place) - np.array(vessel) * seconds, axis=1)
    assert distances.min() >= keep - 1e-6
    # The straight way there, at the vehicle's speed, in the vessel's frame: no nearer than it was,
    # but for a vehicle ahead of the vessel, which has to let it pass.
    along = np.array(place) - own
    share = np.linspace(0.0, 1.0, 101)[:, None]
    way = own + share * (along - np.array(vessel) * np.linalg.norm(along) / speed)
    assert np.linalg.norm(way, axis=1).min() > 200.0
