"""A recorded flight sent to a ground station in real time, as MAVLink over UDP."""

import re
import socket
import time

from reports.errors import ReportError
from reports.export.geographic import GeographicFlight
from reports.export.mavlink import messages

_ADDRESS = re.compile(r"udp://([A-Za-z0-9.\-]+):(\d{1,5})")

_PORT_MAX = 65535


def stream_address(text: str) -> tuple[str, int]:
    """Return host and port of ``udp://HOST:PORT``.

    Raises
    ------
    ReportError : it is not of that form
    """
    found = _ADDRESS.fullmatch(text)
    if found is None or not 0 < int(found[2]) <= _PORT_MAX:
        raise ReportError(
            f"--stream is '{text}'; give udp://HOST:PORT, as in udp://127.0.0.1:14550"
        )
    return found[1], int(found[2])


def stream_flight(flight: GeographicFlight, address: tuple[str, int]) -> tuple[str, int, float]:
    """Send a flight, and return its name, the number of messages and its duration [s].

    Parameters
    ----------
    flight : as recorded
    address : host and port

    Raises
    ------
    ReportError : nothing can be sent to the address
    """
    sent, at = 0, 0.0
    began = time.monotonic()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as link:
        for at, message in messages(flight):
            if (ahead := (at - float(flight.time[0])) - (time.monotonic() - began)) > 0.0:
                time.sleep(ahead)
            try:
                link.sendto(message, address)
            except ConnectionRefusedError:
                # Nobody listens yet: a ground station may come later.
                continue
            except OSError as error:
                raise ReportError(
                    f"--stream: cannot send to {address[0]}:{address[1]}: {error.strerror}; check the address"
                ) from None
            sent += 1
    return flight.flight_id, sent, at
