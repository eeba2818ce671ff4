"""The vessel's motion, estimated from reports that arrive every few seconds, noisy, late, or not at
all.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

State = tuple[float, float, float]
Covariance = tuple[float, float, float, float, float, float]


class VesselReport(NamedTuple):
    """What a vessel reports of itself, as by AIS.

    Attributes
    ----------
    time : at which it was true [s]
    north, east : [m]
    velocity_north, velocity_east : over the ground [m/s]
    """

    time: float
    north: float
    east: float
    velocity_north: float
    velocity_east: float


class VesselMotion(NamedTuple):
    """A vessel's estimated motion.

    Attributes
    ----------
    north, east : [m]
    velocity_north, velocity_east : over the ground [m/s]
    acceleration_north, acceleration_east : [m/s^2]
    sigma : standard deviation of each coordinate of the place [m]
    """

    north: float
    east: float
    velocity_north: float
    velocity_east: float
    acceleration_north: float
    acceleration_east: float
    sigma: float


@dataclass(frozen=True, slots=True, kw_only=True)
class FilterParameters:
    """Parameters of the filter of a vessel's reports.

    Attributes
    ----------
    position_sigma, velocity_sigma : of a report's components [m, m/s]; 0 for one that is exact
    acceleration : one sigma [m/s^2]
    memory : of the acceleration [s]
    """

    position_sigma: float
    velocity_sigma: float
    acceleration: float
    memory: float


class VesselFilter:
    """Singer's model of a manoeuvring target, one Kalman filter for north and one for east, which
    share their covariance.

    Acceleration is a random process of standard deviation ``acceleration`` that forgets itself with
    the time constant ``memory``; position is its double integral (R. A. Singer, IEEE Trans. AES
    6:473, 1970; Bar-Shalom et al., Estimation with Applications to Tracking and Navigation, 2001,
    section 8.2). A report that is older than the newest one is dropped; a late one is taken at the
    time at which it was true.

    Parameters
    ----------
    parameters : of the reports' errors and of the vessel's acceleration

    Attributes
    ----------
    time : of the newest report, before the first one minus infinity [s]
    """

    __slots__ = (
        "_acceleration_variance",
        "_covariance",
        "_east",
        "_memory",
        "_north",
        "_position",
        "_velocity",
        "time",
    )

    def __init__(self, parameters: FilterParameters) -> None:
        self._position, self._velocity = parameters.position_sigma**2, parameters.velocity_sigma**2
        self._acceleration_variance = parameters.acceleration**2
        self._memory = parameters.memory
        self._north: State = (0.0, 0.0, 0.0)
        self._east: State = (0.0, 0.0, 0.0)
        self._covariance: Covariance = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        self.time = -math.inf

    @property
    def exact(self) -> bool:
        """Return whether reports have no errors."""
        return self._position == self._velocity == 0.0

    def report(self, report: VesselReport) -> None:
        """Correct the estimate by a report."""
        if report.time <= self.time:
            return
        if self.time == -math.inf:
            self._north = (report.north, report.velocity_north, 0.0)
            self._east = (report.east, report.velocity_east, 0.0)
            self._covariance = (
                self._position,
                0.0,
                0.0,
                self._velocity,
                0.0,
                self._acceleration_variance,
            )
        else:
            ahead = report.time - self.time
            self._north, self._east = (
                self._predicted(self._north, ahead),
                self._predicted(self._east, ahead),
            )
            self._covariance = self._predicted_covariance(ahead)
            self._correct(0, report.north, report.east, self._position)
            self._correct(1, report.velocity_north, report.velocity_east, self._velocity)
        self.time = report.time

    def at(self, time: float) -> VesselMotion:
        """Return the motion extrapolated to ``time`` [s], not before that of the newest report."""
        ahead = time - self.time
        north, east = self._predicted(self._north, ahead), self._predicted(self._east, ahead)
        sigma = math.sqrt(max(0.0, self._predicted_covariance(ahead)[0]))
        return VesselMotion(north[0], east[0], north[1], east[1], north[2], east[2], sigma)

    def _transition(self, time: float) -> tuple[float, float, float]:
        """Return how acceleration now acts on place, velocity and acceleration after ``time``."""
        memory = self._memory
        decay = math.exp(-time / memory)
        to_velocity = memory * (1.0 - decay)
        return memory * (time - to_velocity), to_velocity, decay

    def _predicted(self, state: State, time: float) -> State:
        to_place, to_velocity, decay = self._transition(time)
        place, velocity, acceleration = state
        return (
            place + time * velocity + to_place * acceleration,
            velocity + to_velocity * acceleration,
            decay * acceleration,
        )

    def _predicted_covariance(self, time: float) -> Covariance:
        """Return the covariance after ``time``: F P F' + Q."""
        b, c, d = self._transition(time)
        p00, p01, p02, p11, p12, p22 = self._covariance
        q00, q01, q02, q11, q12, q22 = self._noise(time)
        r00, r01, r02 = (
            p00 + time * p01 + b * p02,
            p01 + time * p11 + b * p12,
            p02 + time * p12 + b * p22,
        )
        r11, r12 = p11 + c * p12, p12 + c * p22
        return (
            r00 + time * r01 + b * r02 + q00,
            r01 + c * r02 + q01,
            d * r02 + q02,
            r11 + c * r12 + q11,
            d * r12 + q12,
            d * d * p22 + q22,
        )

    def _noise(self, time: float) -> Covariance:
        """Return what the random acceleration adds in ``time``: Singer's exact discrete process
        noise.
        """
        m, t = self._memory, time
        e = math.exp(-t / m)
        scale = self._acceleration_variance
        if t < 0.005 * m:
            # The closed forms cancel to nothing over short times; their leading terms are true to
            # 0.5 %.
            q = 2.0 * scale / m
            return (
                q * t**5 / 20.0,
                q * t**4 / 8.0,
                q * t**3 / 6.0,
                q * t**3 / 3.0,
                q * t**2 / 2.0,
                q * t,
            )
        x = t / m
        return (
            scale * m**4 * (1.0 - e * e + 2.0 * x + 2.0 * x**3 / 3.0 - 2.0 * x * x - 4.0 * x * e),
            scale * m**3 * (e * e + 1.0 - 2.0 * e + 2.0 * x * e - 2.0 * x + x * x),
            scale * m**2 * (1.0 - e * e - 2.0 * x * e),
            scale * m**2 * (4.0 * e - 3.0 - e * e + 2.0 * x),
            scale * m * (e * e + 1.0 - 2.0 * e),
            scale * (1.0 - e * e),
        )

    def _correct(self, i: int, north: float, east: float, variance: float) -> None:
        """Update both axes with a measured place (i = 0) or velocity (i = 1)."""
        p = self._covariance
        column = ((p[0], p[1], p[2]), (p[1], p[3], p[4]))[i]
        total = column[i] + variance
        if total <= 0.0:
            return
        c0, c1, c2 = column
        k0, k1, k2 = c0 / total, c1 / total, c2 / total
        off_north, off_east = north - self._north[i], east - self._east[i]
        self._north = (
            self._north[0] + k0 * off_north,
            self._north[1] + k1 * off_north,
            self._north[2] + k2 * off_north,
        )
        self._east = (
            self._east[0] + k0 * off_east,
            self._east[1] + k1 * off_east,
            self._east[2] + k2 * off_east,
        )
        self._covariance = (
            p[0] - k0 * c0, p[1] - k0 * c1, p[2] - k0 * c2, p[3] - k1 * c1, p[4] - k1 * c2, p[5] - k2 * c2
        )  # fmt: skip
