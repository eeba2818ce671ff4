"""Figures of merit of an arena: what each is called, how it is written, and which way is better."""

import math
from collections.abc import Callable
from dataclasses import dataclass

from measurement.gases import MASS_PERCENT


def _percent(share: float) -> float:
    return 100.0 * share


def _error_of_a_minute(information: float) -> float:
    """Return the standard uncertainty of the information of a minute: infinite where there is none."""
    if math.isnan(information):
        return math.nan
    return 1.0 / math.sqrt(information) if information > 0.0 else math.inf


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """A figure of merit.

    Attributes
    ----------
    name : in ``arena.json``
    title : with its unit, as it is shown
    pattern : of a number
    greater_first : whether more is better
    shown : what is shown of the value in ``arena.json``
    """

    name: str
    title: str
    pattern: str
    greater_first: bool = False
    shown: Callable[[float], float] = float

    @property
    def quantity(self) -> str:
        """Return the title without its unit."""
        return self.title.partition(" [")[0]

    @property
    def unit(self) -> str:
        """Return the unit of the title."""
        return self.title.partition(" [")[2].removesuffix("]")

    def written(self, value: float) -> str:
        """Return a value as text; a dash where it is not a number."""
        if math.isnan(value):
            return "–"
        return self.pattern.format(value) if math.isfinite(value) else "∞"


ERROR = Figure(name="error_rms_m", title="Error rms [m]", pattern="{:.2f}")
EFFORT = Figure(name="effort_rms_rad_s", title="Effort rms [rad/s]", pattern="{:.3f}")
EXCESS = Figure(name="excess_rms_rad_s", title="Excess effort [rad/s]", pattern="{:.3f}")
CUT = Figure(name="saturated_share", title="Cut commands [%]", pattern="{:.1f}", shown=_percent)
CROSSINGS = Figure(
    name="crossings_per_minute", title="Crossings [1/min]", pattern="{:.2f}", greater_first=True
)
PLUME_TIME = Figure(
    name="plume_s_per_minute", title="In the plume [s/min]", pattern="{:.2f}", greater_first=True
)
SULPHUR = Figure(
    name="sulphur_information_per_minute",
    title=f"Sulphur error of a minute [{MASS_PERCENT}]",
    pattern="{:.4f}",
    shown=_error_of_a_minute,
)
DISTANCE = Figure(name="crossing_distance_mean_m", title="Crossing distance [m]", pattern="{:.0f}")

TRACKING_FIGURES = (ERROR, EFFORT, EXCESS, CUT)
MEASURING_FIGURES = (CROSSINGS, PLUME_TIME, SULPHUR, DISTANCE)
