"""When a flight has enough: a verdict on the fuel, or the knowledge that there will be none.

Each look at the readings could be wrong, and a flight ends at the first that finds a verdict. So the
guard band allows for the looks before and after it (``measurement.estimate.repeated``).
"""

import math
from enum import Enum

from gnc.estimation.plume.passes import SensorState
from gnc.mission.axis import SearchedAxis
from gnc.mission.follow import PlumeFollowing
from gnc.mission.mission import Mode
from measurement.errors import MeasurementError
from measurement.estimate.estimator import estimate
from measurement.estimate.repeated import RepeatedVerdict
from measurement.estimate.verdict import OPEN
from scenarios.flight.settling import Settling
from scenarios.instruments.instrument import GasReader

INTERVAL = 15.0
"""Time between looks [s]."""

_AGREEING = 2
"""Looks in a row that have to find the plume out of reach or the sensor failed, which may pass."""

_MEASURABLE = 0.05
"""Probability that the plume can be crossed below which it is given up [-]."""

GONE = 150.0
"""How much farther from the vessel than where it began to leave a flight is over [m]."""


class Enough(Enum):
    """Why a flight leaves."""

    ABOVE = "verdict: above"
    BELOW = "verdict: below"
    OUT_OF_REACH = "plume out of reach"
    SENSOR = "sensor failed"


class Judge:
    """Looks now and then whether a flight has enough, and then has it leave.

    Parameters
    ----------
    reader : of the gases
    mission : that follows the plume
    settling : says from when on readings count

    Attributes
    ----------
    enough : why the flight leaves, or nothing
    left_at : when it began to [s]
    verdict : on the fuel, by all looks
    """

    __slots__ = (
        "_last",
        "_left_from",
        "_mission",
        "_next",
        "_reader",
        "_same",
        "_settling",
        "enough",
        "left_at",
        "verdict",
    )

    def __init__(self, reader: GasReader, mission: PlumeFollowing, settling: Settling) -> None:
        self._reader, self._mission, self._settling = reader, mission, settling
        self._next, self._same = INTERVAL, 0
        self._last: Enough | None = None
        self.enough: Enough | None = None
        self.verdict = RepeatedVerdict(reader.limit_percent)
        self.left_at, self._left_from = math.nan, math.inf

    @property
    def words(self) -> str:
        """Return why the flight left without a verdict, in a sentence."""
        axis = self._mission.axis
        believed = ""
        if isinstance(axis, SearchedAxis) and not math.isnan(axis.estimate.height):
            found = axis.estimate
            believed = f"; the plume's axis was taken to be {found.height:.0f} m high, with a deviation of {found.height_deviation:.0f} m"
        return f"{self.enough.value if self.enough else ''}: it left at {self.left_at:.0f} s without a verdict{believed}"

    def over(self, time: float, distance: float) -> bool:
        """Return whether the flight has left, at a time [s] and a distance from the vessel [m]."""
        if self.enough is not None:
            return distance > self._left_from + GONE
        if time < self._next:
            return False
        self._next += INTERVAL
        found = self._found()
        self._same = self._same + 1 if found is self._last else 1
        self._last = found
        needed = 1 if found in (Enough.ABOVE, Enough.BELOW) else _AGREEING
        if found is not None and self._same >= needed:
            self.enough, self.left_at, self._left_from = found, time, distance
            self._mission.depart()
        return False

    def _found(self) -> Enough | None:
        """Return what is known by now."""
        axis = self._mission.axis
        if isinstance(axis, SearchedAxis):
            if axis.sensor is not SensorState.WORKING:
                return Enough.SENSOR
            # Off its orbit a flight detects nothing, wherever the plume is.
            if (
                self._mission.orbit is not None
                and self._mission.orbit.in_place
                and axis.mode is not Mode.FOUND
                and axis.measurable() < _MEASURABLE
            ):
                return Enough.OUT_OF_REACH
        if math.isnan(self._settling.at):
            return None
        limit = self._reader.limit_percent
        try:
            found = estimate(
                self._reader.readings(self._settling.at), self._reader.spec, limits_percent=(limit,)
            )
        except MeasurementError:
            return None
        verdict = self.verdict.look(
            found.fsc_percent,
            noise=found.noise_percent,
            total=found.total_percent,
            admitted=found.quality != "C",
        )
        return None if verdict == OPEN else Enough(f"verdict: {verdict}")
