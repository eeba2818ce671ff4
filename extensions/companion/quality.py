"""The quality of a link, as declared, and its simulation.

The guidance allows for the declared quality. Telemetry is used a fixed time after its measurement,
so that jitter does not become noise, and commands need the latency to arrive: both are dead time of
the turn that the guard and the preview predict. The rest of the jitter, lost packets and silence
bring the vehicle nearer than predicted, by the distance that it flies in the meantime.
"""

import heapq
import itertools
import math
import random
from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import Any

from common.text import did_you_mean
from scenarios.errors import InputError

_MISSED = 1e-2
"""Probability that more packets in a row are lost in a flight than the allowance [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Link:
    """A link to a vehicle, the same in both directions.

    Attributes
    ----------
    latency : shortest time that a message takes [s]
    jitter : largest additional time [s]
    loss : share of messages that are lost [-]
    silence : longest time without any message during which the flight goes on [s]
    """

    latency: float = 0.0
    jitter: float = 0.0
    loss: float = 0.0
    silence: float = 0.0

    @classmethod
    def of(cls, text: str) -> "Link":
        """Return the link of ``latency=0.2,jitter=0.05,loss=0.05``; values that are not given are
        0.

        Raises
        ------
        InputError : the text is not of that form, or a value is out of range
        """
        known = [field.name for field in fields(cls)]
        given: dict[str, float] = {}
        for part in filter(None, text.split(",")):
            name, _, value = part.partition("=")
            if name not in known:
                raise InputError(
                    f"--link has '{name}'{did_you_mean(name, known) or ';'} known are"
                    f" {', '.join(known)}, as in latency=0.2,loss=0.05"
                )
            try:
                given[name] = float(value)
            except ValueError:
                raise InputError(f"--link: {name} is '{value}'; give a number") from None
            most = 0.5 if name == "loss" else 10.0
            if not 0.0 <= given[name] <= most:
                raise InputError(f"--link: {name} is {value}; it must be from 0 to {most:g}")
        return cls(**given)

    @property
    def wait(self) -> float:
        """Return the time from a measurement until its telemetry is used [s]."""
        return self.latency + self.jitter

    @property
    def dead_time(self) -> float:
        """Return the time from a measurement until the command that follows from it arrives, in the
        mean over the jitter [s].
        """
        return self.wait + self.latency + 0.5 * self.jitter

    def late(self, time_step: float, duration: float) -> float:
        """Return the largest additional delay of a command by jitter, losses in a row or silence
        [s].

        Parameters
        ----------
        time_step : between commands [s]
        duration : of the flight [s]
        """
        lost = 0
        if self.loss > 0.0:
            chances = _MISSED * time_step / duration
            lost = math.ceil(math.log(chances) / math.log(self.loss))
        return 0.5 * self.jitter + max(lost * time_step, self.silence)


class SimulatedLink:
    """One direction of a bad link.

    Parameters
    ----------
    link : its quality
    seed : of its jitter and losses
    """

    def __init__(self, link: Link, seed: int | str) -> None:
        self._link, self._random = link, random.Random(seed)
        self._under_way: list[tuple[float, int, Any]] = []
        self._number = itertools.count()

    def put(self, time: float, message: Any) -> None:
        """Send a message at a time [s]."""
        if self._random.random() < self._link.loss:
            return
        arrives = time + self._link.latency + self._random.random() * self._link.jitter
        heapq.heappush(self._under_way, (arrives, next(self._number), message))

    def due(self, time: float) -> Iterator[Any]:
        """Yield the messages that have arrived by a time [s], in order of arrival."""
        while self._under_way and self._under_way[0][0] <= time + 1e-9:
            yield heapq.heappop(self._under_way)[2]

    @property
    def next_arrival(self) -> float:
        """Return when the next message arrives [s], infinite if none is under way."""
        return self._under_way[0][0] if self._under_way else math.inf
