"""FlightGear is shown the flight that is replayed."""

import socket
import struct

import pytest

from aircraft.fdm import Fdm, RigidBodyState
from aircraft.fleet.x8 import X8
from extensions.telemetry.flightgear import FlightGear
from scenarios.errors import InputError

NEAR_THE_ORIGIN = RigidBodyState(
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
        FlightGear(f"127.0.0.1:{receiver.getsockname()[1]}").show(fdm)
        fdm.place(NEAR_THE_ORIGIN)
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


@pytest.mark.parametrize("address", ["localhost", "local host:5550", "localhost:99999", "", ":5"])
def test_an_address_that_is_none_is_refused(address):
    with pytest.raises(InputError, match="give HOST:PORT, as in localhost:5550"):
        FlightGear(address)
