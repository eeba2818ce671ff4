"""How large the ship of a run is drawn: a scenario names her engine and funnel at most, never her
hull.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True, kw_only=True)
class Hull:
    """A hull as it is drawn.

    Attributes
    ----------
    title : what she is taken to be, in words
    length, beam : [m]
    funnel : from the stern, over the length [-]
    known : whether it is of her class; of a ship without one it stands for a size that is not known
    """

    title: str
    length: float
    beam: float
    funnel: float = 0.2
    known: bool = True


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
    """Return the hull of a flight's ship, by its configuration."""
    return HULLS.get(str(config.get("emission", {}).get("ship")), ANY)
