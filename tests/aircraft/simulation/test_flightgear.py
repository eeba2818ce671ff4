"""JSBSim's own output to FlightGear, and the pace of a flight that is watched."""

import math
import socket
import struct

import pytest

from aircraft.fleet.x8 import X8
from aircraft.simulation import pace
from aircraft.simulation.fdm import Fdm
from aircraft.simulation.pace import paced
from aircraft.simulation.state import RigidBodyState

SOMEWHERE = RigidBodyState(
    latitude=0.01,
    longitude=-0.02,
    altitude=120.0,
    roll=0.3,
    pitch=0.1,
    yaw=1.2,
    velocity_body=(20.0, 0.0, 1.0),
)


def test_flightgears_packets_say_where_the_aircraft_is():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver:
        receiver.bind(("127.0.0.1", 0))
        receiver.settimeout(10.0)
        fdm = Fdm(X8)
        fdm.show("127.0.0.1", receiver.getsockname()[1])
        fdm.place(SOMEWHERE)
        fdm.step(12)
        packet = receiver.recv(2048)
    # FGNetFDM of FlightGear's net_fdm.hxx, version 24: 408 bytes, big-endian; version, padding,
    # longitude, latitude, altitude [rad, rad, m].
    assert len(packet) == 408
    assert struct.unpack(">I", packet[:4]) == (24,)
    longitude, latitude, altitude = struct.unpack(">ddd", packet[8:32])
    # A tenth of a second at 20 m/s is 3e-7 rad; altitude is that of the centre of gravity, to a
    # foot of its climb.
    assert (latitude, longitude) == pytest.approx((0.01, -0.02), abs=1e-6)
    assert altitude == pytest.approx(120.0, abs=1.0)


def test_a_flight_that_is_shown_is_the_same_to_the_last_bit():
    shown, alone = Fdm(X8), Fdm(X8)
    shown.show("127.0.0.1", 9)
    for fdm in (shown, alone):
        fdm.place(SOMEWHERE)
        fdm.step(30)
    names = (
        "position/lat-geod-rad",
        "position/long-gc-rad",
        "attitude/phi-rad",
        "velocities/vt-fps",
    )
    assert [shown.read(name) for name in names] == [alone.read(name) for name in names]


def test_a_paced_simulation_waits_for_the_clock_and_catches_up(monkeypatch):
    now, slept = [100.0], []

    class Clock:
        @staticmethod
        def monotonic():
            return now[0]

        @staticmethod
        def sleep(seconds):
            slept.append(seconds)
            now[0] += seconds

    def step():
        now[0] += took.pop(0)

    monkeypatch.setattr(pace, "time", Clock)
    took = [0.1, 2.5, 0.1, 0.1]
    run = paced(step, 1.0)
    for _ in range(4):
        run()
    # The first step is 0.9 s early; the second ends 1.5 s late, the third 0.6 s; the fourth is 0.3
    # s early again.
    assert slept == pytest.approx([0.9, 0.3])
    assert now[0] == pytest.approx(104.0)
    assert math.isclose(sum(slept), 1.2)
