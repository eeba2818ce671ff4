"""The agent's reward: crossings of the plume near the vessel, and keeping out."""

VIOLATION, LOST = -10.0, -10.0
"""Reward of entering the keep-out area, and of losing the aircraft."""

_SIDE = 0.1
"""Distance from the plume's axis that the vehicle has to come from, over the keep-out radius [-].
"""


class CrossingReward:
    """Counts crossings of the plume behind the vessel.

    A crossing counts if the vehicle was ``_SIDE`` off the axis before it, and not on the other side
    since, so that weaving along the axis earns nothing. It is worth the keep-out radius over its
    distance from the vessel, at most 1: concentration falls with distance.

    Parameters
    ----------
    radius : of the keep-out area [m]

    Attributes
    ----------
    crossings : so far
    """

    def __init__(self, radius: float) -> None:
        self._radius, self._from = radius, 0.0
        self.crossings = 0

    def update(self, along: float, across: float) -> float:
        """Return the reward of a place: along the plume from the vessel, and to the right of its
        axis [m].
        """
        crossed = self._from * across < 0.0
        if abs(across) >= _SIDE * self._radius:
            self._from = across
        elif crossed:
            self._from = 0.0
        if not (crossed and along > 0.0):
            return 0.0
        self.crossings += 1
        return min(1.0, self._radius / along)
