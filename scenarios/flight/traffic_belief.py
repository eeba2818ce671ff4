"""Accuracy of the guard's knowledge of the other ships, for the record."""

import math
from collections.abc import Sequence

from common.columns import described
from gnc.estimation.navigation import MeasuredMotion
from gnc.guidance import Guidance
from scenarios.world.traffic import OtherShip

_RESOLUTION = 0.05
"""Accuracy to which the guard evaluates a turn [m]: a disc counts as no smaller."""


class TrafficBelief:
    """The premise that each of the other ships is within its discs, as a column of the time
    history.

    Parameters
    ----------
    guidance : of the flight
    ships : ships that the guidance knows; those that become known in flight are added
    """

    COLUMNS = described(
        {
            "traffic_disc_ratio": "largest ratio, of all other ships that are near, of the distance"
            " from the centre of a disc to its radius: above 1 it is not where the guard takes it"
            " to be",
        }
    )

    def __init__(self, guidance: Guidance, ships: Sequence[OtherShip]) -> None:
        self._guidance, self._ships = guidance, ships

    def read(
        self,
        time: float,
        motion: MeasuredMotion,
        sample: tuple[float, ...],  # noqa: ARG002 - of an instrument
    ) -> tuple[float, ...]:
        """Return a value for each column."""
        traffic, own = self._guidance.traffic, self._guidance.own
        worst = math.nan
        # An error of the own position counts as one of the ship's; in dead reckoning it has a
        # separate term.
        off_north = off_east = 0.0
        if own.lost == 0.0:
            off_north, off_east = own.ground_north - motion.north, own.ground_east - motion.east
        for vessel in traffic.near if traffic is not None else ():
            ship = next(each for each in self._ships if each.name == vessel.name)
            if not ship.begins <= time <= ship.ends:
                continue
            ship_north, ship_east, *_ = (float(value) for value in ship.track.motion(time))
            for disc in vessel.tubes:
                since = time - disc.time
                north = disc.north + disc.velocity_north * since - off_north
                east = disc.east + disc.velocity_east * since - off_east
                off = math.hypot(ship_north - north, ship_east - east)
                ratio = off / max(disc.reach(since), _RESOLUTION)
                worst = ratio if math.isnan(worst) else max(worst, ratio)
        return (worst,)
