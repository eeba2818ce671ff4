"""NMEA sentences of AIS (``!AIVDM,...``), decoded by pyais one line after the other."""

import re
from typing import Any, NamedTuple

from common.text import install_words
from scenarios.errors import InputError
from scenarios.world.ais.size import ShipSize, ship_size

SENTENCE = re.compile(r"![A-Z]{2}VD[MO],\d,\d,[^*]*\*[0-9A-Fa-f]{2}")
"""A sentence of AIS of any talker: AI of a ship, BS of a base station, AB, AN, SA and others."""

TAG_TIME = re.compile(r"[\\,]c:(\d+)")
"""Time of reception in a tag block of NMEA 4.10: seconds since 1970, or milliseconds."""

MILLISECONDS_FROM = 100_000_000_000
"""Least number that is a time since 1970 in milliseconds; in seconds it is the year 5138."""

POSITION_REPORTS = (1, 2, 3, 18, 19)
"""Message types with position, speed and course (ITU-R M.1371-5): class A, and class B."""

_SIDES = ("bow", "stern", "port", "starboard")
"""Sides of the ship from which messages give the antenna's distances."""

_GROUPS_MAX = 64
"""Largest number of incomplete messages at a time [-]: ten groups on two channels, and more with
several receivers."""


class Message(NamedTuple):
    """A message of AIS with all of its sentences.

    Attributes
    ----------
    before, after : text before and after its last sentence on the line
    said : its fields, as pyais names them
    """

    before: str
    after: str
    said: dict[str, Any]

    @property
    def mmsi(self) -> int:
        """Identity of the ship or station."""
        return int(self.said["mmsi"])

    @property
    def places(self) -> bool:
        """Whether it has position, speed and course."""
        return self.said["msg_type"] in POSITION_REPORTS

    def value(self, name: str) -> float:
        """Return a field; NaN where the message does not have it."""
        value = self.said.get(name)
        return float("nan") if value is None else float(value)

    @property
    def size(self) -> tuple[ShipSize, str] | None:
        """The ship's size, and a remark on values that are not used, as in ``ship_size``; None for
        a message without size. For a ship's boat, pyais has that ship's identity instead of
        dimensions.
        """
        if "to_bow" not in self.said:
            return None
        return ship_size(**{end: self.value(f"to_{end}") for end in _SIDES})


class SentenceDecoder:
    """Puts messages together from the lines of a file or of a receiver.

    Parameters
    ----------
    source : of the lines, in messages
    checked : whether sentences with a wrong checksum are left out

    Attributes
    ----------
    unreadable : number of lines that are not a sentence of NMEA, or whose sentence has no content

    Raises
    ------
    InputError : pyais is not installed
    """

    def __init__(self, source: str, *, checked: bool = False) -> None:
        try:
            import pyais
        except ImportError:
            raise InputError(
                f"{source}: NMEA sentences need pyais; install the extra: {install_words('ais')}"
            ) from None
        self._decode = pyais.decode
        self._checked = checked
        self._parts: dict[tuple[str, str], list[str]] = {}
        self.unreadable = 0

    def decode(self, line: str) -> Message | None:
        """Return the message that a line completes, or None."""
        found = SENTENCE.search(line)
        if found is None or (self._checked and not _checksum_fits(found[0])):
            # Sentences of other instruments on the line, such as "$GPGGA,...", do not count as
            # unreadable.
            self.unreadable += bool(line.strip()) and (found is not None or "$" not in line)
            return None
        whole = self._completed(found[0])
        if not whole:
            return None
        try:
            said: dict[str, Any] = self._decode(*whole).asdict()
        except Exception:  # noqa: BLE001 - of any kind, by a line that the radio damaged
            self.unreadable += 1
            return None
        return Message(line[: found.start()], line[found.end() :], said)

    def _completed(self, sentence: str) -> list[str]:
        """Return the sentences of the message that this one completes, or an empty list."""
        _, count, part, group, channel, *_ = sentence.split(",")
        if count == "1":
            return [sentence]
        # The last sentence of a message completes it, if none before it was lost.
        whole = self._parts.pop((group, channel), []) if part != "1" else []
        whole.append(sentence)
        if len(whole) < int(part):
            return []
        if len(whole) < int(count):
            if len(self._parts) >= _GROUPS_MAX:
                del self._parts[next(iter(self._parts))]
            self._parts[group, channel] = whole
            return []
        return whole


def _checksum_fits(sentence: str) -> bool:
    """Return whether a sentence has the checksum of the text between ``!`` and ``*``."""
    body, _, stated = sentence[1:].partition("*")
    checksum = 0
    for letter in body.encode("ascii", "replace"):
        checksum ^= letter
    return checksum == int(stated, 16)
