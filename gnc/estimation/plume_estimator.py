"""Where a plume is, how wide and how strong, from what is smelt of it and from what is not."""

from enum import Enum

from gnc.estimation.plume_prior import GasSensor, PlumePrior

__all__ = ["GasSensor", "PlumeEstimator", "PlumePrior", "PlumeState", "SensorState"]


class PlumeState(Enum):
    """What is known of the plume."""

    SEARCHING = "searching"
    FOUND = "found"
    LOST = "lost again"


class SensorState(Enum):
    """What the readings say about their sensor."""

    WORKING = "working"
    SILENT = "silent"
    STUCK = "stuck"
    SATURATED = "saturated"


class PlumeEstimator:
    """Bayes' rule on a grid of height, bearing, strength and width, once for each pass over the axis.

    The frame is that of the *predicted* axis, which trails behind the funnel with the apparent wind as it is estimated on board: not
    of the axis that this filter estimates.

    Parameters
    ----------
    prior : what is expected
    """

    def __init__(self, prior: PlumePrior) -> None:
        raise NotImplementedError

    def predict(self, time_step: float) -> None:
        """Let ``time_step`` [s] go by: the axis may have wandered."""

    def update(self, along: float, across: float, altitude: float, reading: float, *, apparent_wind: float | None = None) -> bool:
        """Take note of the vehicle's place and of a reading; return whether a pass is over and the estimate is a new one.

        To be called after ``predict``, for each reading, and in between as often as the place is to be known: each 0.5 s at least.

        Parameters
        ----------
        along, across : of the vehicle, behind the funnel and to the right of the predicted axis (seen along it) [m]
        altitude : above the sea [m]
        reading : of CO2 [ppm], newly sampled; not a number where there is none. A constant background may be in it
        apparent_wind : past the ship now [m/s]; that of the prior unless given
        """
        raise NotImplementedError

    @property
    def state(self) -> PlumeState:
        """Whether the plume is searched for, found, or lost again."""
        raise NotImplementedError

    @property
    def sensor(self) -> SensorState:
        """What the readings say about the sensor; unless it works the estimate only diffuses."""
        raise NotImplementedError

    @property
    def height(self) -> float:
        """Mean height of the axis above the sea, at the distance and the apparent wind of the last place [m]."""
        raise NotImplementedError

    @property
    def height_deviation(self) -> float:
        """Its standard deviation [m]."""
        raise NotImplementedError

    @property
    def height_interval(self) -> tuple[float, float]:
        """2.5 % and 97.5 % quantiles of the height [m]."""
        raise NotImplementedError

    @property
    def offset(self) -> float:
        """Mean place of the axis to the right of the predicted one, at the distance of the last place [m]."""
        raise NotImplementedError

    @property
    def offset_deviation(self) -> float:
        """Its standard deviation [m]."""
        raise NotImplementedError

    @property
    def bearing(self) -> float:
        """Mean angle of the axis to the right of the predicted one [rad]: to be added to its course."""
        raise NotImplementedError

    @property
    def bearing_deviation(self) -> float:
        """Its standard deviation [rad]."""
        raise NotImplementedError

    @property
    def sigma_y(self) -> float:
        """Spread across of one realisation, at the estimated height [m]."""
        raise NotImplementedError

    @property
    def sigma_z(self) -> float:
        """Spread in height of one realisation, at the estimated height [m]."""
        raise NotImplementedError

    @property
    def signal_to_noise(self) -> float:
        """Peak of the readings over their noise, of the best pass so far [-]."""
        raise NotImplementedError

    @property
    def found_at(self) -> float:
        """Time since the start at which the plume was found first [s]; not a number before."""
        raise NotImplementedError

    @property
    def innovation(self) -> float:
        """Mean normalised innovation squared of the passes [-]: 1 where the filter is consistent."""
        raise NotImplementedError

    @property
    def measurable(self) -> float:
        """Probability that a pass at the best altitude within the limits smells the plume more often than not [-]."""
        raise NotImplementedError

    def detection(self, altitude: float) -> float:
        """Return the probability that a pass at an altitude [m] has a signal to noise above 5."""
        raise NotImplementedError
