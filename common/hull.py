"""A ship's hull seen from above: where its funnel and its antenna are, and how far from it a place
is.

The outline is the rectangle of length and beam that reports give (ITU-R M.1371-5, figure 41). It
contains the hull, for any shape of bow and stern, so a distance from it is at most that from
the ship. Places are ahead of the funnel and to starboard of it.
"""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

STACK_FROM_BOW = 0.8
"""Place of a funnel that is not known, from the bow over the length: aft, as on most merchant ships
[-].
"""


HULL_SHAPES = {"sphere": "hull", "cylinder": "hull prism"}
"""What keep-out areas about a hull are called in tables, by their shape about a funnel; a prism
counts horizontal distances alone.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ShipHull:
    """A hull, and what stands on it.

    Attributes
    ----------
    length, beam : [m]
    stack : place of the funnel, from the bow and from the port side [m]
    antenna : place of the antenna whose position is reported, the same [m]
    """

    length: float
    beam: float
    stack: tuple[float, float]
    antenna: tuple[float, float]

    @property
    def antenna_offset(self) -> tuple[float, float]:
        """Return the place of the antenna, ahead of the funnel and to starboard of it [m]."""
        return self.stack[0] - self.antenna[0], self.antenna[1] - self.stack[1]

    @property
    def antenna_distance(self) -> float:
        """Return how far the antenna is from the funnel [m]."""
        return math.hypot(*self.antenna_offset)

    @property
    def sides(self) -> tuple[float, float, float, float]:
        """Return the distances of bow, stern, port and starboard side from the funnel [m]."""
        from_bow, from_port = self.stack
        return from_bow, self.length - from_bow, from_port, self.beam - from_port

    @property
    def farthest(self) -> float:
        """Return the distance of the farthest corner of the outline from the funnel [m]."""
        bow, stern, port, starboard = self.sides
        return math.hypot(max(bow, stern), max(port, starboard))

    def corners(self) -> Array:
        """Return the corners in order, shape (4, 2): ahead of the funnel and to starboard [m]."""
        bow, stern, port, starboard = self.sides
        return np.array([[bow, -port], [bow, starboard], [-stern, starboard], [-stern, -port]])

    def distance(self, ahead: Array, starboard: Array) -> Array:
        """Return how far places are from the outline, 0 within it; all of one shape [m].

        Parameters
        ----------
        ahead, starboard : of the funnel [m]
        """
        bow, stern, port, right = self.sides
        along = np.maximum(np.maximum(ahead - bow, -stern - ahead), 0.0)
        across = np.maximum(np.maximum(starboard - right, -port - starboard), 0.0)
        distance: Array = np.hypot(along, across)
        return distance

    def around(self, radius: float, bearing: Array) -> tuple[Array, Array]:
        """Return the edge of the area within a radius of the outline, as points ahead of the funnel
        and to starboard of it: the farthest point on each bearing, clockwise from the bow [m].

        Between two corners the edge is straight. The first point is repeated at the end, so that
        bearings once round give a closed curve.
        """
        ahead, right = np.cos(bearing), np.sin(bearing)
        corners = self.corners()
        farthest = corners[
            np.argmax(np.outer(ahead, corners[:, 0]) + np.outer(right, corners[:, 1]), axis=1)
        ]
        return farthest[:, 0] + radius * ahead, farthest[:, 1] + radius * right

    def reach(self, bearing: float) -> float:
        """Return how far the outline is from the funnel on a bearing, clockwise from the bow
        [m, rad].
        """
        bow, stern, port, starboard = self.sides
        ahead, right = math.cos(bearing), math.sin(bearing)
        along = (bow if ahead > 0.0 else stern) / max(abs(ahead), 1e-12)
        across = (starboard if right > 0.0 else port) / max(abs(right), 1e-12)
        return min(along, across)


def ship_frame(north: Array, east: Array, heading: Array) -> tuple[Array, Array]:
    """Return places ahead of a point of a ship and to starboard of it, from places north and east
    of it and the ship's heading [m, rad].
    """
    cos_h, sin_h = np.cos(heading), np.sin(heading)
    return cos_h * north + sin_h * east, cos_h * east - sin_h * north
