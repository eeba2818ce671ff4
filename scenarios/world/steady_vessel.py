"""The ship and its plume, in local north-east metres."""

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Vessel:
    """A ship at constant velocity, at the origin at time 0.

    Attributes
    ----------
    speed : V_V [m/s]
    course : chi_V, clockwise from north [rad]
    plume_heading : chi_P, clockwise from the bow [rad]
    plume_elevation : alpha_P [rad]
    source_height : height of the plume's origin above the sea [m]
    """

    speed: float
    course: float
    plume_heading: float
    plume_elevation: float
    source_height: float

    @property
    def velocity_ned(self) -> tuple[float, float]:
        """North and east velocity [m/s]."""
        return self.speed * math.cos(self.course), self.speed * math.sin(self.course)

    @property
    def plume_direction_ned(self) -> tuple[float, float]:
        """North and east components of the unit vector along the plume's axis over the ground."""
        heading = self.course + self.plume_heading
        return math.cos(heading), math.sin(heading)

    def place_ned(self, ahead: float, right: float) -> tuple[float, float]:
        """Return north and east [m] at time 0 of a place given ahead of and right of the vessel [m]."""
        sin_c, cos_c = math.sin(self.course), math.cos(self.course)
        return ahead * cos_c - right * sin_c, ahead * sin_c + right * cos_c
