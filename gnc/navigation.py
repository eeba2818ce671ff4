"""Where the vehicle is and how it moves, from its sensors; through a loss of satellite navigation by dead reckoning."""

import bisect
import math
from dataclasses import dataclass

from gnc.wind_filter import WindFilter


@dataclass(frozen=True, slots=True, kw_only=True)
class NavigationParameters:
    """What the navigation knows beforehand.

    Attributes
    ----------
    crab_banks, crab_offsets : course through the air minus heading, over bank, ascending [rad]
    airspeed_sigma, course_sigma, wind_drift, wind_prior : of ``gnc.wind_filter.WindFilter`` [m/s, rad, m/s, m/s]
    wind_interval : guidance steps between measurements of the wind
    time_step : of the guidance [s]
    """

    crab_banks: tuple[float, ...]
    crab_offsets: tuple[float, ...]
    airspeed_sigma: float
    course_sigma: float
    wind_drift: float
    wind_prior: float
    wind_interval: int
    time_step: float


class Navigation:
    """Own motion over the ground and through the air.

    The air mass has a frame of its own, which drifts with the estimated wind; in calm it is that of the ground. The guidance works
    in it, for there the vehicle flies at its airspeed.

    Attributes
    ----------
    north, east : over the ground [m]
    velocity_north, velocity_east : over the ground [m/s]
    drift_north, drift_east : how far the frame of the air mass has drifted [m]
    wind : the estimate
    lost : for how long there has been no satellite navigation [s]
    """

    __slots__ = (
        "_parameters",
        "_steps",
        "drift_east",
        "drift_north",
        "east",
        "lost",
        "north",
        "velocity_east",
        "velocity_north",
        "wind",
    )

    def __init__(self, parameters: NavigationParameters) -> None:
        self._parameters = parameters
        self.wind = WindFilter(
            airspeed_sigma=parameters.airspeed_sigma,
            course_sigma=parameters.course_sigma,
            drift=parameters.wind_drift,
            prior_sigma=parameters.wind_prior,
        )
        self.north = self.east = self.velocity_north = self.velocity_east = 0.0
        self.drift_north = self.drift_east = self.lost = 0.0
        self._steps = 0

    def update(self, position: tuple[float, float, float, float] | None, airspeed: float, heading: float, roll: float) -> None:
        """Take in what the sensors say now.

        Parameters
        ----------
        position : north, east [m], north and east velocity over the ground [m/s] by satellite navigation, if there is any
        airspeed : [m/s]
        heading, roll : of the body [rad]
        """
        p, wind = self._parameters, self.wind
        due = self._steps % p.wind_interval == 0
        self._steps += 1
        if position is None:
            course = heading + self._crab(roll)
            self.velocity_north = wind.north + airspeed * math.cos(course)
            self.velocity_east = wind.east + airspeed * math.sin(course)
            self.north += p.time_step * self.velocity_north
            self.east += p.time_step * self.velocity_east
            self.lost += p.time_step
        else:
            self.north, self.east, self.velocity_north, self.velocity_east = position
            self.lost = 0.0
            if due:
                time_step = p.wind_interval * p.time_step
                wind.update(airspeed, heading + self._crab(roll), self.velocity_north, self.velocity_east, time_step)
        self.drift_north += p.time_step * wind.north
        self.drift_east += p.time_step * wind.east

    def _crab(self, roll: float) -> float:
        banks, offsets = self._parameters.crab_banks, self._parameters.crab_offsets
        i = min(max(bisect.bisect(banks, roll), 1), len(banks) - 1)
        share = (roll - banks[i - 1]) / (banks[i] - banks[i - 1])
        return offsets[i - 1] + share * (offsets[i] - offsets[i - 1])
