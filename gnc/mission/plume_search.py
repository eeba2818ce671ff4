"""How high and how far off the predicted axis to fly next, so that the plume is found soon and then known well."""

from typing import NamedTuple, Protocol

from gnc.estimation.plume_estimator import PlumeEstimator


class Demand(NamedTuple):
    """Where to cross next.

    Attributes
    ----------
    altitude : above the sea [m], within the limits
    offset : of the centre of oscillation to the right of the predicted axis [m], at the distance of the estimator's last place
    """

    altitude: float
    offset: float


class Search(Protocol):
    """Decides after each pass (``PlumeEstimator.update`` returned True) where to fly next."""

    def next_demand(self, estimator: PlumeEstimator, altitude: float, pass_time: float) -> Demand:
        """Return where to cross next.

        Parameters
        ----------
        estimator : after its last pass
        altitude : of the vehicle now [m]
        pass_time : between passes [s]
        """


class HeightSearch:
    """Maximises the probability of detection per time, then narrows the height down, then stays.

    Parameters
    ----------
    lowest, highest : altitudes that may be flown [m]: limits of the flight, of the terrain and of the keep-out area together
    climb_rate : that the vehicle climbs and sinks at [m/s]
    """

    def __init__(self, *, lowest: float, highest: float, climb_rate: float) -> None:
        raise NotImplementedError

    def next_demand(self, estimator: PlumeEstimator, altitude: float, pass_time: float) -> Demand:
        """Return where to cross next; arguments as of ``Search``."""
        raise NotImplementedError


class LadderSearch:
    """Goes up and down a ladder of heights, one after each pass, until the plume is found; then flies at the estimated height.

    Parameters
    ----------
    lowest, highest : altitudes that may be flown [m]
    rung : between heights [m]
    """

    def __init__(self, *, lowest: float, highest: float, rung: float = 15.0) -> None:
        raise NotImplementedError

    def next_demand(self, estimator: PlumeEstimator, altitude: float, pass_time: float) -> Demand:
        """Return where to cross next; arguments as of ``Search``."""
        raise NotImplementedError
