"""What the guidance learns of the plume in flight: readings of CO2, or the truth; and what it
believes, for the record.
"""

import math

import numpy as np

from common.columns import described
from gnc.estimation.navigation import MeasuredMotion
from gnc.guidance import Guidance
from gnc.mission.axis import ExpectedAxis, PredictedAxis, SearchedAxis
from gnc.mission.follow import PlumeFollowing
from scenarios.instruments.instrument import GasReader
from scenarios.vehicles.vehicle import Vehicle
from scenarios.world.world import World

_SELDOM = 15.0
"""Time between looks at what is costly to compute [s]."""


class PlumeReadings:
    """Passes on the readings of a sniffer, and the true axis of the plume to a flight that is given
    it.

    Parameters
    ----------
    reader : a sniffer that is read in flight, or none
    world, vehicle : of the flight
    axis : of the plume, as the guidance has it
    interval : guidance steps between rows of the record, at which the sniffer's path is known
    knows_axis : whether the guidance is given the true axis
    """

    __slots__ = ("_axis", "_interval", "_knows_axis", "_reader", "_vehicle", "_world")

    def __init__(
        self,
        reader: GasReader | None,
        world: World,
        vehicle: Vehicle,
        axis: ExpectedAxis,
        *,
        interval: int,
        knows_axis: bool,
    ) -> None:
        self._reader, self._world, self._vehicle, self._axis = reader, world, vehicle, axis
        self._interval, self._knows_axis = interval, knows_axis

    def pass_on(self, step: int, time: float, motion: MeasuredMotion, guidance: Guidance) -> None:
        """Pass on what has come until a step; the guidance has taken note of its own motion at it."""
        if step % self._interval == 0:
            sample, axis = self._vehicle.sample(), self._axis
            axis.flown = sample[0]
            readings = self._reader.follow(time, motion, sample) if self._reader is not None else ()
            if isinstance(axis, SearchedAxis):
                axis.take_readings(time, readings)
        if self._knows_axis and step % guidance.plan_interval == 0:
            self._tell(time, guidance)

    def _tell(self, time: float, guidance: Guidance) -> None:
        """Say where the mean axis is, seen from the centre of oscillation as the guidance has it."""
        exhaust, orbit = self._world.exhaust, guidance.mission.orbit
        if exhaust is None or orbit is None or not isinstance(self._axis, PredictedAxis):
            return
        centre = orbit.centre
        north, east, _, _ = self._world.vessel.motion(time)
        height = self._world.source_height
        at = (np.array([value]) for value in (time, north + centre.x, east + centre.y, height))
        plume = exhaust.sample(*at)
        across, above = float(plume.across[0]), float(plume.axis_height[0])
        if math.isfinite(above):
            bearing, distance = math.atan2(centre.y, centre.x), math.hypot(centre.x, centre.y)
            self._axis.set_true_axis(above, bearing - math.atan2(across, distance))


BELIEF_COLUMNS = described(
    {
        "axis_height_estimated_m": "estimated height of the plume's axis",
        "axis_height_deviation_m": "standard deviation of the estimated height",
        "axis_offset_estimated_m": "estimated offset of the axis across the predicted one",
        "axis_offset_deviation_m": "standard deviation of the estimated offset",
        "axis_spread_estimated_m": "estimated vertical spread of the plume",
        "axis_spread_across_estimated_m": "estimated horizontal spread of the plume",
        "axis_measurable": "estimated probability that the plume can be crossed within the limits of the altitude",
        "axis_innovation": "mean normalised innovation squared of the passes, 1 where the filter is consistent",
    }
)
"""Of a time history, of flights that search for the plume."""


class PlumeBelief:
    """What the guidance believes of the plume, as columns of the time history.

    Parameters
    ----------
    axis : of the plume, as the guidance has it
    """

    COLUMNS = tuple(BELIEF_COLUMNS)

    def __init__(self, axis: SearchedAxis) -> None:
        self._axis = axis
        self._measurable, self._next = math.nan, 0.0

    def read(
        self,
        time: float,
        motion: MeasuredMotion,  # noqa: ARG002 - of an instrument
        sample: tuple[float, ...],  # noqa: ARG002 - of an instrument
    ) -> tuple[float, ...]:
        """Return a value for each column."""
        found = self._axis.estimate
        if time >= self._next:
            self._measurable, self._next = self._axis.measurable(), time + _SELDOM
        return (
            found.height, found.height_deviation, found.offset, found.offset_deviation, found.spread,
            found.spread_across, self._measurable, found.innovation,
        )  # fmt: skip


def axis_of(guidance: Guidance) -> ExpectedAxis | None:
    """Return the axis of the plume that a guidance follows, if it follows one."""
    return guidance.mission.axis if isinstance(guidance.mission, PlumeFollowing) else None
