"""The wind, estimated on board from airspeed, course through the air and velocity over the ground."""

import math


class WindFilter:
    """A Kalman filter for a wind that wanders slowly.

    What is measured is the wind triangle, w = v_ground - V_a (cos chi_a, sin chi_a). Its error
    along chi_a is that of the airspeed, across it V_a times that of the course; gusts are in both.
    They are taken one after the other, each as a scalar. The first measurement is the first
    estimate: any wind that were taken to be likely before it would be in the estimate until more
    came.

    Parameters
    ----------
    airspeed_sigma : error of the measured airspeed, gusts included [m/s]
    course_sigma : error of the course through the air, gusts included [rad]
    drift : how far the wind wanders in a second, one sigma [m/s]

    Attributes
    ----------
    north, east : estimated velocity of the air mass, where it blows to; 0 before anything is
        measured [m/s]
    """

    __slots__ = (
        "_course_variance",
        "_drift_variance",
        "_measured",
        "_p_ee",
        "_p_ne",
        "_p_nn",
        "_speed_variance",
        "east",
        "north",
    )

    def __init__(self, *, airspeed_sigma: float, course_sigma: float, drift: float) -> None:
        self._speed_variance = airspeed_sigma**2
        self._course_variance = course_sigma**2
        self._drift_variance = drift**2
        self._measured = False
        self._p_nn = self._p_ne = self._p_ee = 0.0
        self.north = self.east = 0.0

    @property
    def sigma(self) -> float:
        """Return the standard deviation of the estimate in its worst direction, once anything is
        measured [m/s].
        """
        half = 0.5 * (self._p_nn - self._p_ee)
        return math.sqrt(0.5 * (self._p_nn + self._p_ee) + math.hypot(half, self._p_ne))

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
        time_step : since the last one [s]
        """
        cos_c, sin_c = math.cos(air_course), math.sin(air_course)
        north, east = velocity_north - airspeed * cos_c, velocity_east - airspeed * sin_c
        along, across = self._speed_variance, airspeed * airspeed * self._course_variance
        if not self._measured:
            self._measured = True
            self.north, self.east = north, east
            self._p_nn = along * cos_c * cos_c + across * sin_c * sin_c
            self._p_ee = along * sin_c * sin_c + across * cos_c * cos_c
            self._p_ne = (along - across) * sin_c * cos_c
            return
        drift = self._drift_variance * time_step
        self._p_nn += drift
        self._p_ee += drift
        self._scalar(cos_c, sin_c, north * cos_c + east * sin_c, along)
        self._scalar(-sin_c, cos_c, east * cos_c - north * sin_c, across)

    def _scalar(self, h_north: float, h_east: float, measured: float, variance: float) -> None:
        """Correct by one component of the wind, in the direction ``h_north``, ``h_east``."""
        to_north = self._p_nn * h_north + self._p_ne * h_east
        to_east = self._p_ne * h_north + self._p_ee * h_east
        innovation_variance = h_north * to_north + h_east * to_east + variance
        gain_north, gain_east = to_north / innovation_variance, to_east / innovation_variance
        innovation = measured - h_north * self.north - h_east * self.east
        self.north += gain_north * innovation
        self.east += gain_east * innovation
        self._p_nn -= gain_north * to_north
        self._p_ne -= gain_north * to_east
        self._p_ee -= gain_east * to_east
