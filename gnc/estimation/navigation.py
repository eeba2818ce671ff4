"""Where the vehicle is and how it moves, from its sensors; through a loss of satellite navigation
by dead reckoning.
"""

import bisect
import math
from dataclasses import dataclass

from gnc.estimation.wind_filter import WindFilter

NOISE_DEVIATIONS = 3.0
"""Standard deviations of noise that are allowed for [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NavigationParameters:
    """What the navigation knows beforehand.

    Attributes
    ----------
    crab_banks, crab_offsets : course through the air minus heading, over bank, ascending [rad]
    airspeed_sigma, course_sigma, wind_drift : of ``gnc.estimation.wind_filter.WindFilter``
        [m/s, rad, m/s]
    wind_noise, wind_error : largest errors by the noise of the sensors of a single measurement of
        the wind, and of its estimate in the end, with which the guard reckons at all times [m/s]
    first_wind_error : largest error of the first wind that is measured by the vehicle's own motion,
        as it rolls or climbs [m/s]
    wind_interval : guidance steps between measurements of the wind
    time_step : of the guidance [s]
    """

    crab_banks: tuple[float, ...]
    crab_offsets: tuple[float, ...]
    airspeed_sigma: float
    course_sigma: float
    wind_drift: float
    wind_noise: float = 0.0
    wind_error: float = 0.0
    first_wind_error: float = 0.0
    wind_interval: int
    time_step: float


class Navigation:
    """Own motion over the ground and through the air.

    The air mass has a frame of its own, which drifts with the estimated wind; in calm it is that of
    the ground. The guidance works in it, for there the vehicle flies at its airspeed.

    Attributes
    ----------
    north, east : over the ground [m]
    velocity_north, velocity_east : over the ground [m/s]
    drift_north, drift_east : how far the frame of the air mass has drifted [m]
    wind : the estimate
    wind_error : by how much more it may be wrong than in the end, since it was measured seldom so
        far [m/s]
    lost : for how long there has been no satellite navigation [s]
    """

    __slots__ = (
        "_first_variance",
        "_parameters",
        "_step_east",
        "_step_north",
        "_unmeasured",
        "_until_measured",
        "drift_east",
        "drift_north",
        "east",
        "lost",
        "north",
        "velocity_east",
        "velocity_north",
        "wind",
        "wind_error",
    )

    def __init__(self, parameters: NavigationParameters) -> None:
        self._parameters = parameters
        self.wind = WindFilter(
            airspeed_sigma=parameters.airspeed_sigma,
            course_sigma=parameters.course_sigma,
            drift=parameters.wind_drift,
        )
        self.north = self.east = self.velocity_north = self.velocity_east = 0.0
        self.drift_north = self.drift_east = self.lost = self.wind_error = 0.0
        self._step_north = self._step_east = self._unmeasured = 0.0
        self._until_measured = 0
        self._first_variance = 0.0

    def update(
        self,
        position: tuple[float, float, float, float] | None,
        airspeed: float,
        heading: float,
        roll: float,
    ) -> None:
        """Take in what the sensors say now.

        Parameters
        ----------
        position : north, east [m], north and east velocity over the ground [m/s] by satellite
            navigation, if there is any
        airspeed : [m/s]
        heading, roll : of the body [rad]
        """
        if position is None:
            self._reckon(airspeed, heading + self._crab(roll))
        else:
            self.north, self.east, self.velocity_north, self.velocity_east = position
            self.lost = 0.0
            self._until_measured -= 1
            if self._until_measured < 0:
                self._measure(airspeed, heading + self._crab(roll))
        self.drift_north += self._step_north
        self.drift_east += self._step_east

    def _measure(self, airspeed: float, air_course: float) -> None:
        p, wind = self._parameters, self.wind
        self._until_measured = p.wind_interval - 1
        since = p.wind_interval * p.time_step + self._unmeasured
        wind.update(airspeed, air_course, self.velocity_north, self.velocity_east, since)
        self._unmeasured = 0.0
        sigma = wind.sigma
        variance = sigma**2
        self._first_variance = self._first_variance or variance
        # As much of the first measurement is left in the estimate as in a mean of as many.
        self.wind_error = p.first_wind_error * variance / self._first_variance
        if p.wind_noise > p.wind_error:
            self.wind_error += max(0.0, min(p.wind_noise, NOISE_DEVIATIONS * sigma) - p.wind_error)
        self._step_north, self._step_east = p.time_step * wind.north, p.time_step * wind.east

    def _reckon(self, airspeed: float, air_course: float) -> None:
        time_step, wind = self._parameters.time_step, self.wind
        before_north, before_east = self.velocity_north, self.velocity_east
        self.velocity_north = wind.north + airspeed * math.cos(air_course)
        self.velocity_east = wind.east + airspeed * math.sin(air_course)
        # By the mean of the velocities at both ends: by one of them half a turn would be wrong by
        # the way of a step.
        self.north += 0.5 * time_step * (before_north + self.velocity_north)
        self.east += 0.5 * time_step * (before_east + self.velocity_east)
        self.lost += time_step
        # The wind wanders on meanwhile.
        self._unmeasured += time_step

    def _crab(self, roll: float) -> float:
        banks, offsets = self._parameters.crab_banks, self._parameters.crab_offsets
        i = min(max(bisect.bisect(banks, roll), 1), len(banks) - 1)
        share = (roll - banks[i - 1]) / (banks[i] - banks[i - 1])
        return offsets[i - 1] + share * (offsets[i] - offsets[i - 1])
