"""MAVLink 2 messages of a flight, packed as the protocol has them
(https://mavlink.io/en/guide/serialization.html): as the telemetry log that Mission Planner and
QGroundControl record, and as a stream to a ground station.
"""

import math
import socket
import struct
from collections.abc import Iterator
from pathlib import Path
from time import monotonic, sleep

from common.text import host_and_port
from reports.errors import ReportError
from reports.export.geographic import Body, GeographicFlight, recorded_flights
from reports.run.run_data import RunData

_MAGIC, _SYSTEM, _COMPONENT = 0xFD, 1, 1

_FIXED_WING, _NO_AUTOPILOT, _ACTIVE, _ARMED, _VERSION = 1, 8, 4, 128, 3
"""Values in a HEARTBEAT: MAV_TYPE, MAV_AUTOPILOT_INVALID, MAV_STATE, MAV_MODE_FLAG_SAFETY_ARMED and
the version of the protocol.
"""

_GEOMETRIC, _SURFACE_VEHICLE, _ADSB_VALID = 1, 18, 1 | 2 | 4 | 8
"""Values in an ADSB_VEHICLE: altitude by satellites; emitter type, a service vehicle on the
surface; flags of the valid fields, which are place, altitude, heading and velocity."""

_CARGO, _AIS_VALID, _VALID_COG = 70, 1 | 4 | 4096, 2
"""Values in an AIS_VESSEL: its type; the AIS_FLAGS POSITION_ACCURACY, VALID_VELOCITY and
VALID_NAME; and VALID_COG, for a vessel that moves. The rate of turn is not known."""

_AT_REST = 0.05
"""Speed below which a vessel has no course over the ground [m/s]; AIS gives speeds in steps of
0.05.
"""

_MMSI = 999_999_999
"""MMSI of a vessel for which the run has recorded none."""

_INFO = 6
"""MAV_SEVERITY of a STATUSTEXT."""

_SLOW = 1.0
"""Time between heartbeats, and between reports of the vessel [s]."""

_MESSAGES: dict[str, tuple[int, int, str]] = {
    "HEARTBEAT": (0, 50, "<IBBBBB"),
    "SYSTEM_TIME": (2, 137, "<QI"),
    "ATTITUDE": (30, 39, "<Iffffff"),
    "GLOBAL_POSITION_INT": (33, 104, "<IiiiihhhH"),
    "VFR_HUD": (74, 20, "<ffffhH"),
    "ADSB_VEHICLE": (246, 184, "<IiiiHHhHHB9sBB"),
    "STATUSTEXT": (253, 83, "<B50sHB"),
    "AIS_VESSEL": (301, 243, "<IiiHHHHHHHbBBBB7s20s"),
}
"""Messages of the common set by name: number, seed of the checksum, and format of the fields in the
order in which MAVLink sends them.
"""


_SCHEME = "udp://"


class Tlog:
    """Messages of one flight, each after its time in microseconds since 1970."""

    suffix = ".tlog"
    one_flight = True

    def write(self, run: RunData, path: Path) -> None:
        """Write one flight."""
        flight = next(recorded_flights(run))
        with path.open("wb") as file:
            for at, message in messages(flight):
                file.write(struct.pack(">Q", round(1e6 * (flight.start + at))) + message)


class UdpStream:
    """A recorded flight, sent to a ground station over UDP.

    Parameters
    ----------
    address : ``udp://HOST:PORT``

    Raises
    ------
    ReportError : it is not of that form
    """

    def __init__(self, address: str) -> None:
        host = host_and_port(address.removeprefix(_SCHEME))
        if host is None or not address.startswith(_SCHEME):
            raise ReportError(
                f"--stream is '{address}'; give udp://HOST:PORT, as in udp://127.0.0.1:14550"
            )
        self._host = host

    def send(self, flight: GeographicFlight) -> int:
        """Send a flight in real time; return the number of messages.

        Raises
        ------
        ReportError : nothing can be sent to the address
        """
        sent = 0
        began = monotonic()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as link:
            for at, message in messages(flight):
                ahead = (at - float(flight.time[0])) - (monotonic() - began)
                if ahead > 0.0:
                    sleep(ahead)
                try:
                    link.sendto(message, self._host)
                except ConnectionRefusedError:
                    # No program listens there yet; a ground station may start later.
                    continue
                except OSError as error:
                    host, port = self._host
                    raise ReportError(
                        f"--stream: cannot send to {host}:{port}: {error.strerror}; check the"
                        " address"
                    ) from None
                sent += 1
        return sent


class Packer:
    """Packs messages one after the other, and numbers them."""

    def __init__(self) -> None:
        self._sequence = 0

    def pack(self, name: str, *values: float | bytes) -> bytes:
        """Return a message with its values in the order of ``_MESSAGES``."""
        number, seed, fields = _MESSAGES[name]
        # MAVLink 2 leaves out zeros at the end, but never the first byte.
        payload = struct.pack(fields, *values)
        payload = payload[:1] + payload[1:].rstrip(b"\0")
        head = struct.pack(
            "<BBBBBB", len(payload), 0, 0, self._sequence, _SYSTEM, _COMPONENT
        ) + number.to_bytes(3, "little")
        self._sequence = (self._sequence + 1) % 256
        body = head + payload
        return bytes([_MAGIC]) + body + struct.pack("<H", _checksum(body + bytes([seed])))


def messages(flight: GeographicFlight) -> Iterator[tuple[float, bytes]]:
    """Yield each message with its time since the start [s]: attitude and place of each sample,
    heartbeat and vessel each second.
    """
    packer, due = Packer(), -math.inf
    # A STATUSTEXT has room for 50 letters.
    heights = b"Heights are above mean sea level"
    yield float(flight.time[0]), packer.pack("STATUSTEXT", _INFO, heights, 0, 0)
    for i, time in enumerate(flight.time.tolist()):
        if time >= due - 1e-6:
            due = time + _SLOW
            yield (
                time,
                packer.pack("HEARTBEAT", 0, _FIXED_WING, _NO_AUTOPILOT, _ARMED, _ACTIVE, _VERSION),
            )
            yield (
                time,
                packer.pack("SYSTEM_TIME", round(1e6 * (flight.start + time)), _milliseconds(time)),
            )
            if flight.vessel is not None:
                bow = _centidegrees(flight.vessel_heading[i])
                yield time, _ais(packer, flight.vessel, i, bow)
                yield time, _adsb(packer, flight.vessel, i, bow)
        yield from ((time, message) for message in _of_sample(packer, flight, i, time))


def _of_sample(packer: Packer, flight: GeographicFlight, i: int, time: float) -> Iterator[bytes]:
    uav = flight.uav
    roll, pitch, yaw = (
        math.radians(float(angle[i])) for angle in (flight.roll, flight.pitch, flight.heading)
    )
    yield packer.pack(
        "ATTITUDE", _milliseconds(time), roll, pitch, math.remainder(yaw, math.tau), 0.0, 0.0, 0.0
    )
    height, heading = round(1e3 * float(uav.altitude[i])), _centidegrees(flight.heading[i])
    yield packer.pack(
        "GLOBAL_POSITION_INT", _milliseconds(time), *_place(uav, i), height, height,
        _centi(uav.north[i]), _centi(uav.east[i]), _centi(-flight.climb_rate[i]), heading,
    )  # fmt: skip
    yield packer.pack(
        "VFR_HUD", float(flight.airspeed[i]), float(uav.speed[i]), float(uav.altitude[i]),
        float(flight.climb_rate[i]),
        round(float(flight.heading[i])) % 360, max(0, min(100,
        round(100.0 * float(flight.throttle[i])))),
    )  # fmt: skip


def _ais(packer: Packer, vessel: Body, i: int, bow: int) -> bytes:
    course, speed = _centidegrees(vessel.course[i]), float(vessel.speed[i])
    valid = _AIS_VALID | _VALID_COG if speed >= _AT_REST else _AIS_VALID
    return packer.pack(
        "AIS_VESSEL",
        _MMSI,
        *_place(vessel, i),
        course,
        bow,
        _centi(speed),
        0,
        0,
        0,
        valid,
        0,
        0,
        _CARGO,
        0,
        0,
        b"",
        b"VESSEL",
    )


def _adsb(packer: Packer, vessel: Body, i: int, bow: int) -> bytes:
    """Return the vessel as an ADSB_VEHICLE, for ground stations that do not show AIS."""
    speed = _centi(vessel.speed[i])
    return packer.pack(
        "ADSB_VEHICLE",
        1,
        *_place(vessel, i),
        0,
        bow,
        speed,
        0,
        _ADSB_VALID,
        0,
        _GEOMETRIC,
        b"VESSEL",
        _SURFACE_VEHICLE,
        0,
    )


def _place(body: Body, i: int) -> tuple[int, int]:
    return round(1e7 * float(body.latitude[i])), round(1e7 * float(body.longitude[i]))


def _centi(speed: float) -> int:
    return max(-32768, min(32767, round(100.0 * float(speed))))


def _centidegrees(angle: float) -> int:
    return round(100.0 * float(angle)) % 36000


def _milliseconds(time: float) -> int:
    return round(1e3 * time)


def _checksum(data: bytes) -> int:
    """Return the CRC-16/MCRF4XX of a message."""
    crc = 0xFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc >> 1) ^ 0x8408 if crc & 1 else crc >> 1
    return crc
