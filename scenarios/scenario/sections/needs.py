"""The needs of keys: a key has an effect only if a part of the flights reads it.

A need is declared in the annotation of the key, as ``Annotated[Angle, BLOWS]``, or for a whole
section in its ``NEEDS``. It is used to refuse a key that nothing reads, for the conditions in
``plume-flight describe`` and on the reference page, for the keys behind a # in a new file, and for
the parameters that a manifest calls unused.
"""

from collections.abc import Callable
from dataclasses import dataclass
from operator import attrgetter
from typing import Any


@dataclass(frozen=True, slots=True)
class Need:
    """The part of a flight that uses a key.

    Attributes
    ----------
    acts : whether flights of a scenario have the part; reads only keys and properties of the
        scenario
    user : name of the part, and how to turn it on
    """

    acts: Callable[[Any], object]
    user: str


def when(key: str, *values: str, user: str) -> Need:
    """Return the need of a key that another one turns on.

    Parameters
    ----------
    key : the other one
    values : values of the other key that turn it on, the first of them for the message; by default
        any value except "none" and an empty one
    user : the part that uses the key
    """
    value_of = attrgetter(key)
    return Need(
        lambda s: value_of(s) in values if values else value_of(s) and value_of(s) != "none",
        f"{user}: set {key} to '{values[0]}'" if values else f"{user}: set {key}",
    )


def of_study(study: str, user: str) -> Need:
    """Return the need of one study."""
    return Need(lambda s: s.study == study, f"{user}: set study to '{study}'")


def of_others(study: str, user: str) -> Need:
    """Return the need of any study but one."""
    return Need(lambda s: s.study != study, f"other studies; {user}")


STEADY = (
    "the mission that follows the vessel with estimates of vessel and wind; guidance.mission"
    " 'track' is in still air, beside a steady vessel: leave it out, or set it to 'follow'"
)

OPERATIONAL = Need(lambda s: s.follows, STEADY)
"""Air, vessel or equipment that are not steady and known."""

FOLLOWS = Need(
    lambda s: s.follows,
    "the mission that follows the vessel with a steered reference: set guidance.mission to"
    " 'follow'",
)
TRACKS = Need(
    lambda s: not s.follows,
    "the mission that tracks the paper's reference; here the reference is steered: set"
    " guidance.mission to 'track'",
)
VESSEL = Need(
    lambda s: not s.circles, "an oscillation beside a vessel; here reference.path is 'circle'"
)
OSCILLATES = Need(
    lambda s: not s.stands_off,
    "an oscillation in the plume; here the vessel is circled: set guidance.mission to 'follow'",
)
EXHAUST = when("emission.ship", user="a ship with exhaust")
SNIFFER = Need(
    lambda s: "sniffer" in s.payload.instruments,
    "a sniffer: put 'sniffer' into payload.instruments",
)


def channel_of_gas(gas: str) -> Need:
    """Return the need of a key for the emission of a gas that not every sniffer knows."""
    return Need(
        lambda s: gas in (getattr(s.payload, "channels", None) or {}),
        f"a sniffer with a channel for it: add the table payload.channels.{gas}",
    )


BLOWS = Need(lambda s: s.wind.blows, "wind: set wind.speed_mps or wind.table")
OWN_TRACK = Need(
    lambda s: not s.vessel.from_file,
    "a vessel whose track is not from a file, which says where it goes: leave out this key or"
    " vessel.track",
)
