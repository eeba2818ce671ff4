"""Where the vehicle is, how it moves and what the wind is: known exactly, or from its sensors.

The guidance works in the frame of the mean air, in which the vehicle flies at its airspeed. That
frame drifts with the estimated wind; in still air it is the frame of the ground.
"""

import bisect
import math
from dataclasses import dataclass
from typing import Any, NamedTuple

from gnc.estimation.error_budget import STILL, Process, WindErrorByGusts

NOISE_DEVIATIONS = 3.0
"""Standard deviations of noise that are allowed for [-]."""

_SPEED_MIN = 1.0
"""Least speed in the ratio of airspeed to speed over the mean air [m/s]."""


class MeasuredMotion(NamedTuple):
    """A vehicle's motion.

    Attributes
    ----------
    north, east : position [m]
    velocity_north, velocity_east : over the ground [m/s]
    heading_rate : rate of the course through the air [rad/s]
    """

    north: float
    east: float
    velocity_north: float
    velocity_east: float
    heading_rate: float


class SatelliteFix(NamedTuple):
    """Position and velocity over the ground by satellite navigation.

    Attributes
    ----------
    north, east : [m]
    velocity_north, velocity_east : [m/s]
    """

    north: float
    east: float
    velocity_north: float
    velocity_east: float


class EngineReadings(NamedTuple):
    """The readings that show whether an aircraft has the thrust that its throttle should give.

    Attributes
    ----------
    throttle : commanded [-]
    forward, upward : measured by accelerometers along the body's axes, over g [-]; 0 and 1 at rest
    """

    throttle: float
    forward: float
    upward: float


class SensorReadings(NamedTuple):
    """What the sensors on board measure.

    Attributes
    ----------
    fix : by satellite navigation; None while that is lost
    airspeed : [m/s]
    heading, roll : of the body [rad]
    heading_rate : rate of the course through the air [rad/s]
    servo_error : error of the control surface that is farthest from its command, over its travel
        [-]
    engine : readings of the engine; None for a vehicle without an engine, such as the paper's
    """

    fix: SatelliteFix | None
    airspeed: float
    heading: float
    roll: float
    heading_rate: float
    servo_error: float
    engine: EngineReadings | None = None


@dataclass(kw_only=True, eq=False)
class AirMotion:
    """The part of a vehicle's motion that a turn away is predicted from.

    Attributes
    ----------
    ground_north, ground_east : position over the ground [m]
    course : of the motion through the mean air, from -pi to pi [rad]
    heading_rate : rate of that course [rad/s]
    wind_north, wind_east : velocity of the air mass [m/s]
    wind_error : error of the wind in excess of its final error, while few measurements are in the
        estimate, by sensors and by the vehicle's own motion [m/s]
    wind_by_gusts : error of the wind by turbulence; None without turbulence
    lost : time since satellite navigation was lost [s]
    speed : of the motion through the mean air [m/s]
    """

    ground_north: float
    ground_east: float
    course: float
    heading_rate: float = 0.0
    wind_north: float = 0.0
    wind_east: float = 0.0
    wind_error: float = 0.0
    wind_by_gusts: WindErrorByGusts | None = None
    lost: float = 0.0
    speed: float = 0.0


class OwnMotion(AirMotion):
    """The vehicle's motion, updated once per guidance step.

    Attributes
    ----------
    north, east : position in the frame of the air mass [m]
    drift_north, drift_east : drift of that frame since the start [m]
    airspeed : as measured, against gusty air [m/s]; NaN where it is not measured
    air_ratio : airspeed over the speed through the mean air [-]

    Further attributes are those of ``AirMotion``.
    """

    def __init__(self) -> None:
        super().__init__(ground_north=0.0, ground_east=0.0, course=0.0)
        self.north = 0.0
        self.east = 0.0
        self.drift_north = 0.0
        self.drift_east = 0.0
        self.airspeed = math.nan
        self.air_ratio = 1.0

    def update(self, measurement: Any) -> None:
        """Take in a measurement, in the form that this navigation takes."""
        raise NotImplementedError


class TrueNavigation(OwnMotion):
    """The exact motion, in still air."""

    def update(self, measurement: MeasuredMotion) -> None:
        """Take in the motion now."""
        north, east, v_north, v_east, self.heading_rate = measurement
        self.north = self.ground_north = north
        self.east = self.ground_east = east
        self.course = math.atan2(v_east, v_north)
        self.speed = math.hypot(v_north, v_east)


class WindFilter:
    """A Kalman filter for a wind that wanders slowly.

    It measures the wind triangle, w = v_ground - V_a (cos chi_a, sin chi_a). The error along chi_a
    is the error of the airspeed, the error across it is V_a times the error of the course; gusts
    are in both. The two components are taken in one after the other, each as a scalar. The first
    measurement is the first estimate: an assumed wind would stay in the estimate until more
    measurements came.

    Parameters
    ----------
    airspeed_sigma : error of the measured airspeed, gusts included [m/s]
    course_sigma : error of the course through the air, gusts included [rad]
    drift : standard deviation of the wind's change in one second [m/s]

    Attributes
    ----------
    north, east : estimated velocity of the air mass, 0 before anything is measured [m/s]
    gain : share of the last measurement in the estimate, in the mean over directions [-]
    variance_north, variance_east, covariance : of that estimate [m^2/s^2]
    """

    def __init__(self, *, airspeed_sigma: float, course_sigma: float, drift: float) -> None:
        self._speed_variance = airspeed_sigma**2
        self._course_variance = course_sigma**2
        self._drift_variance = drift**2
        self._measured = False
        self.variance_north = 0.0
        self.covariance = 0.0
        self.variance_east = 0.0
        self.north = 0.0
        self.east = 0.0
        self.gain = 0.0

    @property
    def sigma(self) -> float:
        """Standard deviation of the estimate in its worst direction, after a measurement [m/s]."""
        half = 0.5 * (self.variance_north - self.variance_east)
        return math.sqrt(
            0.5 * (self.variance_north + self.variance_east) + math.hypot(half, self.covariance)
        )

    def update(
        self,
        airspeed: float,
        air_course: float,
        velocity_north: float,
        velocity_east: float,
        time_step: float,
    ) -> None:
        """Correct the estimate by one measurement.

        Parameters
        ----------
        airspeed : V_a, horizontal [m/s]
        air_course : chi_a, of the motion through the air [rad]
        velocity_north, velocity_east : over the ground [m/s]
        time_step : since the last measurement [s]
        """
        cos_c = math.cos(air_course)
        sin_c = math.sin(air_course)
        north = velocity_north - airspeed * cos_c
        east = velocity_east - airspeed * sin_c
        along = self._speed_variance
        across = airspeed * airspeed * self._course_variance
        if not self._measured:
            self._measured = True
            self.north = north
            self.east = east
            self.variance_north = along * cos_c * cos_c + across * sin_c * sin_c
            self.variance_east = along * sin_c * sin_c + across * cos_c * cos_c
            self.covariance = (along - across) * sin_c * cos_c
            self.gain = 1.0
            return
        drift = self._drift_variance * time_step
        self.variance_north += drift
        self.variance_east += drift
        before = self.variance_north + self.variance_east
        self._correct(cos_c, sin_c, north * cos_c + east * sin_c, along)
        self._correct(-sin_c, cos_c, east * cos_c - north * sin_c, across)
        if before > 0.0:
            self.gain = 1.0 - (self.variance_north + self.variance_east) / before

    def _correct(self, h_north: float, h_east: float, measured: float, variance: float) -> None:
        """Correct by the wind's component in the direction of the unit vector h."""
        to_north = self.variance_north * h_north + self.covariance * h_east
        to_east = self.covariance * h_north + self.variance_east * h_east
        innovation_variance = h_north * to_north + h_east * to_east + variance
        gain_north = to_north / innovation_variance
        gain_east = to_east / innovation_variance
        innovation = measured - h_north * self.north - h_east * self.east
        self.north += gain_north * innovation
        self.east += gain_east * innovation
        self.variance_north -= gain_north * to_north
        self.covariance -= gain_north * to_east
        self.variance_east -= gain_east * to_east


@dataclass(frozen=True, slots=True, kw_only=True)
class NavigationParameters:
    """The parameters of the navigation, known beforehand.

    Attributes
    ----------
    crab_banks, crab_offsets : course through the air minus heading, over bank, ascending [rad]
    airspeed_sigma, course_sigma, wind_drift : of ``WindFilter`` [m/s, rad, m/s]
    wind_noise : largest error of a single measurement of the wind, by the sensors' noise [m/s]
    wind_error : largest error of the estimated wind in the end, by the sensors' noise [m/s]; the
        guard allows for it at all times
    first_wind_error : largest error of the first measurement of the wind, by the vehicle's own
        motion, as it rolls or climbs [m/s]
    turbulence : as the vehicle meets it [m/s]
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
    turbulence: Process = STILL
    wind_interval: int
    time_step: float


class EstimatedNavigation(OwnMotion):
    """The motion estimated from sensors, by dead reckoning while satellite navigation is lost.

    Dead reckoning assumes that the air moves with the estimated wind, and in turbulence also with
    what is left of the last measured gust (``gnc.estimation.error_budget``).

    An autopilot turns relative to the gusty air, the guidance relative to the mean air; see
    ``gnc.airspeed.air_turn``.

    Parameters
    ----------
    parameters : of the navigation

    Attributes
    ----------
    wind : the wind's filter
    velocity_north, velocity_east : over the ground [m/s]

    Further attributes are those of ``OwnMotion``.
    """

    def __init__(self, parameters: NavigationParameters) -> None:
        super().__init__()
        self._parameters = parameters
        self._until_measured = 0
        self._unmeasured = 0.0
        self._first_variance = 0.0
        self._step_north = 0.0
        self._step_east = 0.0
        turbulence = parameters.turbulence
        if turbulence.sigma > 0.0:
            self.wind_by_gusts = WindErrorByGusts(turbulence)
        self._gust_kept = turbulence.remaining(parameters.time_step)
        self._gust_north = 0.0
        self._gust_east = 0.0
        self._last_reading: SensorReadings | None = None
        self.wind = WindFilter(
            airspeed_sigma=parameters.airspeed_sigma,
            course_sigma=parameters.course_sigma,
            drift=parameters.wind_drift,
        )
        self.velocity_north = 0.0
        self.velocity_east = 0.0

    def update(self, measurement: SensorReadings) -> None:
        """Take in the sensors' readings now."""
        fix, airspeed, heading, roll, heading_rate, _, _ = measurement
        if fix is None:
            self._reckon(airspeed, heading + self._crab(roll))
        else:
            self.ground_north, self.ground_east, self.velocity_north, self.velocity_east = fix
            self.lost = 0.0
            self._last_reading = measurement
            self._until_measured -= 1
            if self._until_measured < 0:
                self._measure_wind(airspeed, heading + self._crab(roll))
        self.drift_north += self._step_north
        self.drift_east += self._step_east
        self.north = self.ground_north - self.drift_north
        self.east = self.ground_east - self.drift_east
        v_north = self.velocity_north - self.wind_north
        v_east = self.velocity_east - self.wind_east
        self.course = math.atan2(v_east, v_north)
        self.speed = math.hypot(v_north, v_east)
        self.airspeed = airspeed
        self.air_ratio = max(_SPEED_MIN, airspeed) / max(_SPEED_MIN, self.speed)
        self.heading_rate = heading_rate * self.air_ratio

    def _measure_wind(self, airspeed: float, air_course: float) -> None:
        p, wind = self._parameters, self.wind
        self._until_measured = p.wind_interval - 1
        since = p.wind_interval * p.time_step + self._unmeasured
        wind.update(airspeed, air_course, self.velocity_north, self.velocity_east, since)
        self._unmeasured = 0.0
        if self.wind_by_gusts is not None:
            self.wind_by_gusts.measure(wind.gain, since)
        self.wind_north = wind.north
        self.wind_east = wind.east
        self._step_north = p.time_step * wind.north
        self._step_east = p.time_step * wind.east
        # The share of the first measurement in the estimate falls with the variance, as in a mean.
        sigma = wind.sigma
        variance = sigma**2
        if not self._first_variance:
            self._first_variance = variance
        self.wind_error = p.first_wind_error * variance / self._first_variance
        if p.wind_noise > p.wind_error:
            beyond = min(p.wind_noise, NOISE_DEVIATIONS * sigma) - p.wind_error
            self.wind_error += max(0.0, beyond)

    def _measure_last_gust(self) -> None:
        """Take in the gust at the last fix: its wind triangle, less the estimated wind."""
        last = self._last_reading
        if last is None or last.fix is None:
            return
        air_course = last.heading + self._crab(last.roll)
        self._gust_north = (
            last.fix.velocity_north - last.airspeed * math.cos(air_course) - self.wind_north
        )
        self._gust_east = (
            last.fix.velocity_east - last.airspeed * math.sin(air_course) - self.wind_east
        )

    def _reckon(self, airspeed: float, air_course: float) -> None:
        time_step = self._parameters.time_step
        before_north = self.velocity_north
        before_east = self.velocity_east
        self.velocity_north = self.wind_north + airspeed * math.cos(air_course)
        self.velocity_east = self.wind_east + airspeed * math.sin(air_course)
        if self.wind_by_gusts is not None:
            if self.lost == 0.0:
                self._measure_last_gust()
            self._gust_north *= self._gust_kept
            self._gust_east *= self._gust_kept
            self.velocity_north += self._gust_north
            self.velocity_east += self._gust_east
        # The trapezoidal rule: with the velocity at one end alone, half a turn would be wrong by
        # the distance that is flown in a step.
        self.ground_north += 0.5 * time_step * (before_north + self.velocity_north)
        self.ground_east += 0.5 * time_step * (before_east + self.velocity_east)
        self.lost += time_step
        # The wind wanders on meanwhile.
        self._unmeasured += time_step

    def _crab(self, roll: float) -> float:
        banks, offsets = self._parameters.crab_banks, self._parameters.crab_offsets
        i = min(max(bisect.bisect(banks, roll), 1), len(banks) - 1)
        share = (roll - banks[i - 1]) / (banks[i] - banks[i - 1])
        return offsets[i - 1] + share * (offsets[i] - offsets[i - 1])
