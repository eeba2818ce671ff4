"""What each colour means, the same in every figure, on the screen and in print."""

from enum import StrEnum, unique

COLOURS = {
    "blue": "#0072B2",
    "vermillion": "#D55E00",
    "green": "#009E73",
    "orange": "#E69F00",
    "sky": "#56B4E9",
    "purple": "#CC79A7",
    "plum": "#882255",
    "black": "#222222",
    "grey": "#6e6e6e",
    "white": "#ffffff",
}
"""Okabe and Ito's palette, and the wine of Tol's muted one: colour-blind readers can tell them
apart. White is the page's.
"""


@unique
class Meaning(StrEnum):
    """What a colour stands for in figures of flights, each for one thing alone.

    What has no meaning here (theory, a perfect instrument, an event) is black or grey, by its
    style; categories, such as laws, sensors and loops, have the colours of ``SERIES``.
    """

    FLOWN = "blue"
    """What the aircraft did: its track, its histories, a flight."""
    COMMANDED = "orange"
    """What it was commanded to do: the reference, a command, a planned margin."""
    LIMIT = "vermillion"
    """The keep-out area, r_min, any criterion or limit, what is beyond it, and how near to it was
    come.
    """
    CROSSING = "green"
    """Crossings of the plume."""
    WIND = "sky"
    """Wind, and its estimate."""
    GUARD = "purple"
    """The keep-out guard changed commands."""
    GUARD_LOST = "plum"
    """The keep-out guard could not hold its radius."""
    SHIP = "black"
    """The ship, and where it went."""
    PLUME = "grey"
    """The plume: its axis and its width."""


SERIES = ("blue", "orange", "green", "sky", "plum", "black", "grey")
"""Colours of categories, in their order: without those of limits and of the guard."""

VARIANTS = tuple(colour for colour in SERIES if colour != Meaning.FLOWN)
"""Colours of comparisons, in their order: not that of the study's own flights."""

SCALE = "Cividis"
"""Colour scale of values, light for the least: of even steps for all eyes. Matplotlib writes it in
small letters.
"""

INK = "#4d4d4d"
"""Colour of words among curves."""

FILL_OPACITY = 0.16
"""Opacity of what a curve encloses: the grid still shows through."""

BAND_OPACITY = 0.35
"""Opacity of a tinted stretch of time, below curves: narrow ones still show."""


def series_colour(number: int) -> str:
    """Return the colour of a category by its number; they repeat beyond the last."""
    return SERIES[number % len(SERIES)]
