"""Where on earth a flight begins, and when."""

import math
from dataclasses import dataclass
from functools import cached_property

from common.geodesy import LocalFrame
from scenarios.scenario.sections.world import PlaceConfig


@dataclass(frozen=True, kw_only=True)
class Place:
    """Where and when a flight begins; what is not known is not a number.

    Attributes
    ----------
    latitude, longitude : of the origin [rad]
    altitude : at which north and east metres are counted [m]
    utc : of the start, since 1970 [s]
    """

    latitude: float
    longitude: float
    altitude: float
    utc: float

    @cached_property
    def frame(self) -> LocalFrame:
        """The frame that north and east metres are in."""
        return LocalFrame(self.latitude, self.longitude, self.altitude)


def given_place(config: PlaceConfig, altitude: float) -> Place:
    """Return the place that a scenario gives, with metres at an altitude [m]."""
    return Place(
        latitude=math.nan if config.latitude_deg is None else math.radians(config.latitude_deg),
        longitude=math.nan if config.longitude_deg is None else math.radians(config.longitude_deg),
        altitude=altitude,
        utc=math.nan if config.utc is None else config.utc.timestamp(),
    )
