"""From the antenna, whose place a ship reports, to the funnel, from which the plume trails.

Both are fixed to the hull. With d the antenna's place ahead of the funnel and to starboard of it, R
the rotation by the heading and omega its rate::

    funnel = antenna - R d,    its velocity = that of the antenna - omega x R d

An error e of the heading displaces the funnel by |d| e, one of its rate by |d| e a second.
"""

import math
from typing import NamedTuple

from gnc.estimation.vessel import VesselReport


class AntennaReport(NamedTuple):
    """A report of the antenna's motion, as by AIS.

    Attributes
    ----------
    motion : of the antenna, and its time
    heading : of the bow, clockwise from north [rad]
    turn_rate : of the heading [rad/s]
    """

    motion: VesselReport
    heading: float
    turn_rate: float


def turned_offset(offset: tuple[float, float], heading: float) -> tuple[float, float]:
    """Return north and east of a place ahead of another and to starboard of it [m]."""
    ahead, right = offset
    cos_h, sin_h = math.cos(heading), math.sin(heading)
    return ahead * cos_h - right * sin_h, ahead * sin_h + right * cos_h


def at_antenna(
    funnel: VesselReport, offset: tuple[float, float], heading: float, turn_rate: float
) -> VesselReport:
    """Return the motion of the antenna, given that of the funnel.

    Parameters are those of ``at_funnel`` and ``AntennaReport``.
    """
    north, east = turned_offset(offset, heading)
    return VesselReport(
        funnel.time,
        funnel.north + north,
        funnel.east + east,
        funnel.velocity_north - turn_rate * east,
        funnel.velocity_east + turn_rate * north,
    )


def at_funnel(report: AntennaReport, offset: tuple[float, float]) -> VesselReport:
    """Return the motion of the funnel, given that of the antenna.

    Parameters
    ----------
    report : of the antenna
    offset : of the antenna, ahead of the funnel and to starboard of it [m]
    """
    north, east = turned_offset(offset, report.heading)
    motion, turn_rate = report.motion, report.turn_rate
    return VesselReport(
        motion.time,
        motion.north - north,
        motion.east - east,
        motion.velocity_north + turn_rate * east,
        motion.velocity_east - turn_rate * north,
    )
