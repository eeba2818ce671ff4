"""A ship's size and the place of the antenna on it, from reports."""

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields

SIZE_COLUMNS: Mapping[str, tuple[str, ...]] = {
    "length": ("length", "length_m"),
    "beam": ("width", "beam", "width_m", "beam_m"),
    "bow": ("a", "size a", "to_bow", "dim_a"),
    "stern": ("b", "size b", "to_stern", "dim_b"),
    "port": ("c", "size c", "to_port", "dim_c"),
    "starboard": ("d", "size d", "to_starboard", "dim_d"),
}
"""Names of each dimension in tables, in lower case. A to D are the letters of ITU-R M.1371-5."""

_LENGTH_END, _BEAM_END = 511.0, 63.0
"""Largest distances that a report can say: they stand for these and all above (ITU-R M.1371-5,
table 52) [m]."""

_ROUNDING = 2.0
"""Largest difference between a length and A + B: each of the three is rounded to metres, some of
them upwards [m]."""


@dataclass(frozen=True, slots=True)
class ShipSize:
    """A ship's size from its reports; None for values that they do not have.

    Attributes
    ----------
    length, beam : [m]
    to_bow, to_port : from the antenna whose place is reported, ahead to the bow and across to the
        port side [m]
    """

    length: float | None = None
    beam: float | None = None
    to_bow: float | None = None
    to_port: float | None = None

    def described(self) -> str:
        """Return the size in words, empty where nothing is known."""
        words = []
        if self.length is not None:
            words.append(f"{self.length:g} m")
        if self.beam is not None:
            words.append(f"by {self.beam:g} m" if words else f"{self.beam:g} m wide")
        size = " ".join(words)
        places = [
            f"{distance:g} m from {side}"
            for distance, side in ((self.to_bow, "the bow"), (self.to_port, "the port side"))
            if distance is not None
        ]
        return f"{size}, antenna {' and '.join(places)}" if places else size

    @property
    def known(self) -> int:
        """Number of known dimensions."""
        return sum(getattr(self, each.name) is not None for each in fields(self))


def ship_size(
    *,
    length: float = math.nan,
    beam: float = math.nan,
    bow: float = math.nan,
    stern: float = math.nan,
    port: float = math.nan,
    starboard: float = math.nan,
) -> tuple[ShipSize, str]:
    """Return the size in one report, and a remark on values that are not used; empty without one.

    Parameters
    ----------
    length, beam : of the ship [m]
    bow, stern, port, starboard : distances of the antenna from them: A, B, C and D of ITU-R
        M.1371-5, figure 41 [m]

    0 and NaN mean "unknown". With 0 to bow and port the place of the antenna is unknown, and the
    other two are length and beam. 511 m and 63 m also stand for larger values, and count as
    unknown.
    """
    along = _across("length", length, "A + B", bow, stern, _LENGTH_END)
    aside = _across("width", beam, "C + D", port, starboard, _BEAM_END)
    remarks = [remark for *_, remark in (along, aside) if remark]
    if along[0] is not None and aside[0] is not None and aside[0] > along[0]:
        remarks.append(f"{along[0]:g} m long and {aside[0]:g} m wide")
        return ShipSize(), "; ".join(remarks)
    # At the very bow the distance is 0, as it is where the place is not known.
    placed = bow > 0.0 or port > 0.0
    return ShipSize(
        length=along[0],
        beam=aside[0],
        to_bow=along[1] if placed else None,
        to_port=aside[1] if placed else None,
    ), "; ".join(remarks)


def _across(
    name: str, whole: float, names: str, before: float, after: float, end: float
) -> tuple[float | None, float | None, str]:
    """Return a dimension, the antenna's distance from its beginning, and why they are not used.

    Parameters
    ----------
    name, whole : of the dimension, and its reported value [m]
    names, before, after : of its two parts, and their reported values [m]
    end : largest part that can be reported [m]
    """
    stated = whole if whole > 0.0 else None
    if not before + after > 0.0 or min(before, after) < 0.0:
        return stated, None, ""
    if max(before, after) >= end:
        return stated, None, f"{names} is {before:g} + {after:g} m, and {end:g} m may be more"
    parts = before + after
    if stated is not None and abs(parts - stated) > _ROUNDING:
        return None, None, f"{name} is {stated:g} m and {names} {before:g} + {after:g} m"
    return parts, before, ""


def size_of_all(said: Iterable[tuple[ShipSize, str]]) -> tuple[ShipSize | None, str]:
    """Return the size from the reports of one ship, and a remark where they do not agree.

    Of the most complete sizes, it is the most frequent one.
    """
    counts: Counter[tuple[ShipSize, str]] = Counter(
        (size, remark) for size, remark in said if size.known or remark
    )
    if not counts:
        return None, ""
    (size, remark), _ = max(counts.items(), key=lambda of: (of[0][0].known, of[1]))
    as_complete = [other for other, _ in counts if other.known == size.known]
    if size.known and len(as_complete) > 1:
        others = " and ".join(other.described() for other in as_complete if other != size)
        remark = "; ".join(filter(None, [remark, f"other reports say {others}"]))
    if remark and not size.known:
        return None, f"size not used: {remark}"
    return size, remark
