"""How large the ship of a run is drawn: as the scenario or the file of its track says, else as
ships of its class are.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from common.hull import STACK_FROM_BOW, ShipHull


@dataclass(frozen=True, slots=True, kw_only=True)
class Hull:
    """A hull as it is drawn.

    Attributes
    ----------
    title : what it is taken to be, in words
    length, beam : [m]
    funnel : from the stern, over the length [-]
    known : whether it is of its class; of a ship without one it stands for a size that is not known
    given : whether it is its own, as the scenario or its reports say
    aside : how far to starboard of the funnel the middle of the hull is [m]
    """

    title: str
    length: float
    beam: float
    funnel: float = 0.2
    known: bool = True
    given: bool = False
    aside: float = 0.0


HULLS = {
    "container": Hull(title="a container feeder", length=160.0, beam=25.0),
    "coaster": Hull(title="a coaster", length=90.0, beam=14.0),
    "tanker": Hull(title="a tanker", length=180.0, beam=30.0),
    "cruise": Hull(title="a cruise ship", length=290.0, beam=36.0, funnel=0.35),
}
"""By the names of ``measurement/ships.toml``: usual sizes of such ships, assumptions."""

ANY = Hull(title="a merchant ship", length=150.0, beam=23.0, known=False)
"""Of a ship whose class is not known, as one of a user's own."""


def hull_of(config: Mapping[str, Any]) -> Hull:
    """Return the hull of a flight's ship, by its configuration: its own, else that of its class."""
    own = outline_of(config)
    if own is None:
        return HULLS.get(str(config.get("emission", {}).get("ship")), ANY)
    return Hull(
        title="the ship",
        length=own.length,
        beam=own.beam,
        funnel=1.0 - own.stack[0] / own.length,
        given=True,
        aside=0.5 * own.beam - own.stack[1],
    )


def outline_of(config: Mapping[str, Any]) -> ShipHull | None:
    """Return the outline of a flight's ship, where its size is known."""
    vessel = config.get("vessel") or {}
    length, beam = vessel.get("length_m"), vessel.get("beam_m")
    if length is None or beam is None:
        return None
    along, across = vessel.get("stack_from_bow_m"), vessel.get("stack_from_port_m")
    stack = (
        STACK_FROM_BOW * length if along is None else along,
        0.5 * beam if across is None else across,
    )
    return ShipHull(length=length, beam=beam, stack=stack, antenna=stack)
