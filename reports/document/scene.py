"""What the replay of one flight shows: who was where, and what is about them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from common.hull import ShipHull
from reports.run.columns import Array
from reports.run.flight_config import Hull

COLUMNS = (
    "north", "east", "altitude", "airspeed", "heading", "pitch", "roll", "reference_north",
    "reference_east", "vessel_north",
    "vessel_east", "vessel_heading", "plume_axis", "wind_north", "wind_east", "apparent_drift",
    "gas",
)  # fmt: skip
"""What a scene knows at each of its times."""


class Event(NamedTuple):
    """Something to look at: what it is called on its button, and when [s]."""

    name: str
    time: float


class OtherTrack(NamedTuple):
    """Another ship: its name, the radius that is kept from it [m], its place at each sample, north
    and east, shape (n,) [m], its heading [rad], and the samples between which its track is known.
    """

    name: str
    radius: float
    north: Array
    east: Array
    heading: Array
    known: tuple[int, int]


class Gas(NamedTuple):
    """What the track is coloured by: a gas, its unit, the value of the strongest colour, and where
    it is from, in words.
    """

    name: str
    unit: str
    most: float
    source: str


class Estimate(NamedTuple):
    """How an estimate of the fuel's sulphur grew.

    Attributes
    ----------
    rows : time [s], content and the ends of its interval [%], verdict or nothing
    limits : that it is compared with [%]
    """

    rows: Sequence[tuple[float, float, float, float, str]]
    limits: Sequence[float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """One flight over the sea.

    Attributes
    ----------
    start : of the first sample [s]
    interval : between samples, always the same [s]
    columns : for each name of ``COLUMNS`` shape (n,): places of the vessel over the ground, those
        of UAV and reference north and east of the vessel, altitude above the sea [m]; angles
        without jumps, clockwise from north where they are courses [rad]; airspeed and true wind
        [m/s]; how much air has passed the vessel [m]; the gas in its unit
    utc : of time 0, since 1970 [s], or None where it is not known
    guard : stretches in which the keep-out guard changed commands: from, to [s], and whether it
        held its radius
    crossings : times at which the plume was crossed, shape (k,) [s]
    events : what one can go to
    distances : least and largest distance that its curve shows, of what the keep-out area is about
        [m]
    keepout_radius : r_min [m]
    keepout_shape : "sphere" or "cylinder", or one of ``HULL_SHAPES``
    outline : of the hull, where the keep-out area is about it
    source_height : of the stack's mouth above the sea [m]
    plume_length, plume_rise : how far a plume without smoke is drawn [m], and how much it climbs
        [-]
    hull : its shape
    gas : what the track is coloured by, or None
    estimate : of the fuel's sulphur, or None
    smoke : parcels of the exhaust as the run has them, or None of a plume that is an axis alone
    others : ships besides the vessel
    """

    start: float
    interval: float
    columns: Mapping[str, Array]
    utc: float | None
    guard: Sequence[tuple[float, float, bool]]
    crossings: Array
    events: Sequence[Event]
    distances: tuple[float, float]
    keepout_radius: float
    keepout_shape: str
    source_height: float
    plume_length: float
    plume_rise: float
    hull: Hull
    outline: ShipHull | None
    gas: Gas | None
    estimate: Estimate | None
    smoke: Mapping[str, Any] | None
    others: Sequence[OtherTrack] = ()
