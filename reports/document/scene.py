"""What the replay of one flight shows: who was where, and what is about them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from reports.run.columns import Array
from reports.run.plume_shape import PlumeShape
from reports.run.ship import Hull

COLUMNS = (
    "north", "east", "altitude", "heading", "pitch", "roll", "reference_north", "reference_east", "vessel_north", "vessel_east",
    "vessel_heading", "plume_axis",
)  # fmt: skip
"""What a scene knows at each of its times."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """One flight over the sea.

    Attributes
    ----------
    start : of the first sample [s]
    interval : between samples, always the same [s]
    columns : for each name of ``COLUMNS`` shape (n,): places of the vessel over the ground, those
        of UAV and reference north and east of the vessel, altitude above the sea [m]; angles
        without jumps, clockwise from north where they are courses [rad]
    guard : stretches in which the keep-out guard changed commands: from, to [s], and whether it
        held its radius
    crossings : times at which the plume was crossed, shape (k,) [s]
    distances : least and largest distance that its curve shows, of what the keep-out area is about
        [m]
    keepout_radius : r_min [m]
    keepout_shape : "sphere" or "cylinder"
    source_height : of the funnel's mouth above the sea [m]
    hull : its shape
    plumes : shapes of the plume, each with the time from which it has it [s]
    """

    start: float
    interval: float
    columns: Mapping[str, Array]
    guard: Sequence[tuple[float, float, bool]]
    crossings: Array
    distances: tuple[float, float]
    keepout_radius: float
    keepout_shape: str
    source_height: float
    hull: Hull
    plumes: Sequence[tuple[float, PlumeShape]]
