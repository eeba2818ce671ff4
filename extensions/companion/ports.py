"""Ports for MAVLink: UDP, TCP or a serial line, with a telemetry log of both directions.

Addresses are ``udp://HOST:PORT`` and ``tcp://HOST:PORT``, at which a vehicle listens and to which a
companion sends; ``udpin://HOST:PORT``, at which a companion listens; and ``serial://DEVICE:BAUD``.
"""

import contextlib
import os
import re
import select
import socket
import termios
import time
import tty
from collections.abc import Sequence
from pathlib import Path
from typing import IO, Any, Protocol, Self

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from common.text import host_and_port
from scenarios.errors import InputError

_DATAGRAM = 65535
_PEERS_MAX = 8
"""Largest number of connected programs [-]: data from further ones are not read."""

_FORGET_AFTER = 30.0
"""Time after which a silent peer over UDP is forgotten [s]."""

_LONGEST_LINE = 400
"""Largest number of letters of an incomplete line of text [-]."""

_SERIAL = re.compile(r"serial://(/[^:]+):(\d+)")

Peer = tuple[str, int]
Packets = list[tuple[Peer, bytes]]


class Line(Protocol):
    """Bytes to peers and from them."""

    def receive(self, timeout: float) -> Packets:
        """Return what has come, after waiting for it for at most a time [s]."""

    def send(self, data: bytes, peer: Peer) -> None:
        """Send to a peer; one that is gone gets nothing."""

    def connected(self) -> Sequence[Peer]:
        """Return the peers that are known even before they have sent anything."""

    def close(self) -> None:
        """Let the line go."""


class Udp:
    """Datagrams, received at an address of this machine or sent to one other address.

    Parameters
    ----------
    host, port : to listen at, or to send to
    listening : which of both
    """

    def __init__(self, host: str, port: int, *, listening: bool) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        if listening:
            self._socket.bind((host, port))
        self.other = None if listening else (socket.gethostbyname(host), port)

    def receive(self, timeout: float) -> Packets:
        """Return what has come, after waiting for it for at most a time [s]."""
        found: Packets = []
        if select.select([self._socket], [], [], timeout)[0]:
            with contextlib.suppress(BlockingIOError, ConnectionRefusedError):
                while True:
                    data, peer = self._socket.recvfrom(_DATAGRAM)
                    if self.other in (None, peer):
                        found.append((peer, data))
        return found

    def send(self, data: bytes, peer: Peer) -> None:
        """Send to a peer; one that is gone gets nothing."""
        with contextlib.suppress(OSError):
            self._socket.sendto(data, peer)

    def connected(self) -> Sequence[Peer]:
        """Return the peer to which this sends, if it does not listen."""
        return [self.other] if self.other is not None else []

    def close(self) -> None:
        """Let the line go."""
        self._socket.close()


class Tcp:
    """Streams, to programs that connect to this machine, or to one other address.

    Parameters
    ----------
    host, port : to listen at, or to connect to
    listening : which of both
    """

    def __init__(self, host: str, port: int, *, listening: bool) -> None:
        self._server: socket.socket | None = None
        self._streams: dict[Peer, socket.socket] = {}
        if listening:
            self._server = socket.create_server((host, port))
            self._server.setblocking(False)
            return
        stream = socket.create_connection((host, port), timeout=5.0)
        peer: Peer = stream.getpeername()
        self._take(stream, peer)

    def _take(self, stream: socket.socket, peer: Peer) -> None:
        stream.setblocking(False)
        stream.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._streams[peer] = stream

    def receive(self, timeout: float) -> Packets:
        """Return what has come, after waiting for it for at most a time [s]."""
        listening = [self._server] if self._server else []
        ready, _, _ = select.select([*listening, *self._streams.values()], [], [], timeout)
        if self._server in ready and self._server is not None:
            with contextlib.suppress(OSError):
                stream, peer = self._server.accept()
                if len(self._streams) < _PEERS_MAX:
                    self._take(stream, peer)
                else:
                    stream.close()
        found: Packets = []
        for peer, stream in list(self._streams.items()):
            if stream not in ready:
                continue
            try:
                data = stream.recv(_DATAGRAM)
            except BlockingIOError:
                continue
            except OSError:
                data = b""
            if data:
                found.append((peer, data))
            else:
                self._drop(peer)
        if not ready and not self._streams and not self._server:
            time.sleep(timeout)
        return found

    def send(self, data: bytes, peer: Peer) -> None:
        """Send to a peer; one that is gone gets nothing."""
        stream = self._streams.get(peer)
        if stream is None:
            return
        try:
            stream.sendall(data)
        except OSError:
            # Waiting for a peer that does not read would delay the vehicle.
            self._drop(peer)

    def _drop(self, peer: Peer) -> None:
        self._streams.pop(peer).close()

    def connected(self) -> Sequence[Peer]:
        """Return the other ends of all streams."""
        return list(self._streams)

    def close(self) -> None:
        """Let the line go."""
        for stream in [*self._streams.values(), *([self._server] if self._server else [])]:
            stream.close()


class Serial:
    """A serial line.

    Parameters
    ----------
    device, baud : of the line
    """

    def __init__(self, device: str, baud: int) -> None:
        speed = getattr(termios, f"B{baud}", None)
        if speed is None:
            raise InputError(f"--connect: {baud} baud is no speed of a serial line; give 57600")
        self._file = os.open(device, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        tty.setraw(self._file)
        settings = termios.tcgetattr(self._file)
        settings[4] = settings[5] = speed
        termios.tcsetattr(self._file, termios.TCSANOW, settings)
        self._other: Peer = (device, 0)

    def receive(self, timeout: float) -> Packets:
        """Return what has come, after waiting for it for at most a time [s]."""
        if not select.select([self._file], [], [], timeout)[0]:
            return []
        try:
            data = os.read(self._file, _DATAGRAM)
        except OSError:
            data = b""
        return [(self._other, data)] if data else []

    def send(self, data: bytes, peer: Peer) -> None:  # noqa: ARG002 - there is one
        """Send to the other end; what does not fit into its buffer is lost."""
        with contextlib.suppress(OSError):
            os.write(self._file, data)

    def connected(self) -> Sequence[Peer]:
        """Return the other end."""
        return [self._other]

    def close(self) -> None:
        """Let the line go."""
        os.close(self._file)


def opened(option: str, address: str, *, listening: bool) -> Line:
    """Return the line at an address.

    Parameters
    ----------
    option : that gives the address, for messages
    address : see the module
    listening : whether others connect to it

    Raises
    ------
    InputError : the address is none, or cannot be opened
    """
    scheme, _, rest = address.partition("://")
    host, serial = host_and_port(rest), _SERIAL.fullmatch(address)
    try:
        if serial and not listening:
            return Serial(serial[1], int(serial[2]))
        if host and scheme == "tcp":
            return Tcp(*host, listening=listening)
        if host and scheme in ("udp", "udpin"):
            return Udp(*host, listening=listening or scheme == "udpin")
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(f"{option} {address}: cannot be opened: {reason}") from None
    known = "udp://HOST:PORT or tcp://HOST:PORT"
    more = "" if listening else ", udpin://HOST:PORT or serial://DEVICE:BAUD"
    raise InputError(f"{option} is '{address}'; give {known}{more}, as in tcp://127.0.0.1:5760")


def opened_input(option: str, address: str) -> Line:
    """Return the line at an address on which others send and get no answer; a UDP address is
    listened at.

    Parameters
    ----------
    option, address : as in ``opened``

    Raises
    ------
    InputError : the address is none, or cannot be opened
    """
    return opened(option, re.sub("^udp://", "udpin://", address), listening=False)


class TextLines:
    """Lines of text, put together from the pieces in which they arrive.

    Parameters
    ----------
    line : over which they arrive
    """

    def __init__(self, line: Line) -> None:
        self._line = line
        self._rest: dict[Peer, bytes] = {}

    def receive(self) -> list[str]:
        """Return the lines that have arrived, without waiting."""
        found: list[str] = []
        for peer, data in self._line.receive(0.0):
            *lines, rest = (self._rest.pop(peer, b"") + data).split(b"\n")
            if len(self._rest) < _PEERS_MAX:
                self._rest[peer] = rest[-_LONGEST_LINE:]
            found += [line.decode("ascii", "replace") for line in lines]
        return found


class Port:
    """Messages over a line.

    Parameters
    ----------
    line : to send over
    system, component : of the sender
    log : telemetry log of both directions, or None

    Attributes
    ----------
    malformed : number of packets that were damaged or not MAVLink
    """

    def __init__(self, line: Line, *, system: int, component: int, log: Path | None = None) -> None:
        self._line = line
        self._packer = mavlink.MAVLink(None, srcSystem=system, srcComponent=component)
        self._parsers: dict[Peer, Any] = {}
        self._heard: dict[Peer, float] = {}
        self._log: IO[bytes] | None = None
        self._log_path = log
        self.malformed = 0
        self.system, self.component = system, component

    def __enter__(self) -> Self:
        """Open the log.

        Raises
        ------
        InputError : it cannot be written
        """
        if self._log_path is not None:
            try:
                self._log = self._log_path.open("wb")
            except OSError as error:
                raise InputError(
                    f"--log {self._log_path}: cannot be written: {error.strerror}"
                ) from None
        return self

    def __exit__(self, *_: object) -> None:
        """Close line and log."""
        self._line.close()
        if self._log is not None:
            self._log.close()

    def receive(self, timeout: float) -> list[tuple[Peer, Any]]:
        """Return the messages that have arrived, with their senders, after waiting for at most a
        time [s].
        """
        found: list[tuple[Peer, Any]] = []
        for peer, data in self._line.receive(timeout):
            parser = self._parsers.get(peer)
            if parser is None:
                if len(self._parsers) >= _PEERS_MAX:
                    self._forget()
                if len(self._parsers) >= _PEERS_MAX:
                    continue
                parser = self._parsers[peer] = mavlink.MAVLink(None)
                parser.robust_parsing = True
            for message in parser.parse_buffer(data) or ():
                if message.get_type() == "BAD_DATA" or message.get_type().startswith("UNKNOWN"):
                    self.malformed += 1
                    continue
                self._heard[peer] = time.monotonic()
                found.append((peer, message))
                self._note(message.get_msgbuf())
        return found

    def _forget(self) -> None:
        """Forget peers that have been silent for long."""
        for peer in list(self._parsers):
            if time.monotonic() - self._heard.get(peer, -_FORGET_AFTER) >= _FORGET_AFTER:
                del self._parsers[peer]
                self._heard.pop(peer, None)

    def send(self, message: Any, peer: Peer | None = None) -> None:
        """Send a message to a peer, or to every peer that has sent something or is connected."""
        data = message.pack(self._packer)
        self._packer.seq = (self._packer.seq + 1) % 256
        self._note(data)
        everybody = dict.fromkeys([*self._line.connected(), *self._heard])
        for each in [peer] if peer is not None else everybody:
            self._line.send(data, each)

    def forward(self, message: Any, sender: Peer) -> None:
        """Pass a peer's message on to the others, as an autopilot routes messages."""
        for each in self._heard:
            if each != sender:
                self._line.send(bytes(message.get_msgbuf()), each)

    def _note(self, data: bytes) -> None:
        if self._log is not None:
            self._log.write(round(1e6 * time.time()).to_bytes(8, "big") + bytes(data))
