"""What a key needs to have an effect: a part of the flights that reads it.

A need stands where the key does, as ``Annotated[Angle, BLOWS]``, or for a whole section as one of
its ``NEEDS``. From that follow the refusal of a key that nothing uses, the conditions in
``plume-flight describe`` and on the reference page, the keys behind a # in a new file, and the
parameters that a manifest calls unused.
"""

from collections.abc import Callable
from dataclasses import dataclass
from operator import attrgetter
from typing import Any


@dataclass(frozen=True, slots=True)
class Need:
    """What uses a key.

    Attributes
    ----------
    acts : whether flights of a scenario have it; reads nothing but its keys and properties
    user : the part that uses the key, and how to have it
    """

    acts: Callable[[Any], object]
    user: str


def when(key: str, *values: str, user: str) -> Need:
    """Return the need of a key that another one turns on.

    Parameters
    ----------
    key : the other one
    values : by which it does, the first of them for the message; any but "none" and nothing if not
        given
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
    """Return the need of what a ship emits of a gas beside those that every sniffer knows."""
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
