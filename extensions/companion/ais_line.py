"""Reports of ships from an AIS receiver on board, in NMEA sentences over UDP, TCP or a serial line.

A report is true at the time at which its sentence arrives, or at the time of reception in its tag
block, by the clock of this computer. A report whose time of reception is later than now is not
used: one of the two clocks is wrong.
"""

import math
import time
from collections.abc import Callable

from common.physics import METRES_PER_SECOND_PER_KNOT
from extensions.companion.fields import VesselState
from extensions.companion.ports import Line, TextLines
from scenarios.world.ais.reports import AisRow, why_unused
from scenarios.world.ais.sentences import MILLISECONDS_FROM, TAG_TIME, Message, SentenceDecoder
from scenarios.world.ais.size import ShipSize

_CLOCKS_DIFFER = 1.0
"""Largest time by which a reception may be later than now [s]: times are in whole seconds."""


class AisReceiver:
    """An AIS receiver on a line.

    Parameters
    ----------
    line : on which its sentences arrive
    clock : time of this computer since 1970 [s]

    Attributes
    ----------
    from_future : number of reports that were received later than now
    without_place : number of reports without a possible position, or without speed or course

    Raises
    ------
    InputError : pyais is not installed
    """

    def __init__(self, line: Line, clock: Callable[[], float] = time.time) -> None:
        self._lines, self._clock = TextLines(line), clock
        self._decoder = SentenceDecoder("--ais", checked=True)
        self._sizes: dict[int, ShipSize] = {}
        self.from_future = self.without_place = 0

    @property
    def unreadable(self) -> int:
        """Number of lines that were damaged or not NMEA."""
        return self._decoder.unreadable

    def lines(self) -> list[str]:
        """Return the lines for a console about reports that were left out."""
        counts = {
            "lines of AIS that were damaged, or no NMEA": self.unreadable,
            "reports of AIS from the future": self.from_future,
            "reports of AIS without a place, a speed or a course": self.without_place,
        }
        return [f"{what}: {count}" for what, count in counts.items() if count]

    def receive(self) -> list[VesselState]:
        """Return the reports that have arrived since the last call, in their order."""
        messages = [self._decoder.decode(line) for line in self._lines.receive()]
        found = [self._taken(message) for message in messages if message is not None]
        return [vessel for vessel in found if vessel is not None]

    def _taken(self, message: Message) -> VesselState | None:
        if message.size is not None and message.size[0].known:
            self._sizes[message.mmsi] = message.size[0]
        if not message.places:
            return None
        now, stated = self._clock(), TAG_TIME.search(message.before)
        at = float(stated[1]) if stated else now
        at = at / 1000.0 if at >= MILLISECONDS_FROM else at
        if at > now + _CLOCKS_DIFFER:
            self.from_future += 1
            return None
        row = AisRow(0, at, *map(message.value, ("lat", "lon", "speed", "course")))
        if why_unused([row])[0]:
            self.without_place += 1
            return None
        # A speed without a course is almost 0, and has no direction.
        directed = row.course < 360.0
        course = math.radians(row.course) if directed else 0.0
        speed = METRES_PER_SECOND_PER_KNOT * row.speed if directed else 0.0
        heading = message.value("heading")
        return VesselState(
            mmsi=message.mmsi,
            name="",
            latitude=math.radians(row.latitude),
            longitude=math.radians(row.longitude),
            velocity_north=speed * math.cos(course),
            velocity_east=speed * math.sin(course),
            bow=math.radians(heading) if heading < 360.0 else course,
            age=max(0.0, now - at),
            size=self._sizes.get(message.mmsi),
        )
