"""Figures of flights that are compared, and how far they differ between the flights of a pair."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np
import pandas as pd

from common.intervals import CONFIDENCE, quantile_interval
from measurement.gases import MASS_PERCENT
from reports.compare.pairs import Pairs
from reports.monte_carlo.names import FIGURES, Figure
from reports.run.columns import Array, clearance, column, interval_error

PAIRS_MIN = 6
"""Pairs from which on a median has an interval: of fewer, all lie on one side of it more often than
in 5 %.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Measure:
    """A figure of a flight.

    Attributes
    ----------
    figure : its name and unit, and how it is written
    values : of each row of a summary; not a number where a flight does not have it
    """

    figure: Figure
    values: Callable[[pd.DataFrame], Array]


def _off_interval(rows: pd.DataFrame) -> Array:
    off: Array = np.abs(interval_error(rows))
    return off


def _off_fuel(rows: pd.DataFrame) -> Array:
    off: Array = np.abs(column(rows, "fsc_percent") - column(rows, "fsc_expected_percent"))
    return off


def _of(name: str, words: str, unit: str, digits: int) -> Measure:
    return Measure(
        figure=Figure(name=words, unit=unit, digits=digits), values=partial(column, name=name)
    )


MEASURES: Mapping[str, Measure] = {
    "min_distance_m": Measure(
        figure=FIGURES["min_distance_m"], values=partial(column, name="min_distance_m")
    ),
    "clearance_m": Measure(figure=FIGURES["clearance_m"], values=clearance),
    "keepout_violations": _of("keepout_violations", "Keep-out violations", "-", 0),
    "crossing_interval_mean_s": _of("crossing_interval_mean_s", "Mean crossing interval", "s", 3),
    "crossing_interval_error": Measure(
        figure=FIGURES["crossing_interval_error"], values=_off_interval
    ),
    "crossing_distance_mean_m": _of(
        "crossing_distance_mean_m", "Mean distance of the crossings", "m", 1
    ),
    "crossing_count": _of("crossing_count", "Plume crossings after settling", "-", 0),
    "tracking_error_rms_m": Measure(
        figure=FIGURES["tracking_error_rms_m"], values=partial(column, name="tracking_error_rms_m")
    ),
    "settling_time_s": Measure(
        figure=FIGURES["settling_time_s"], values=partial(column, name="settling_time_s")
    ),
    "airspeed_error_rms_mps": _of(
        "airspeed_error_rms_mps", "Airspeed error, rms after settling", "m/s", 3
    ),
    "altitude_error_max_m": _of(
        "altitude_error_max_m", "Altitude error, largest after settling", "m", 2
    ),
    "bank_max_deg": _of("bank_max_deg", "Largest bank", "deg", 1),
    "guard_interventions": _of("guard_interventions", "Interventions of the guard", "-", 0),
    "guard_time_s": _of("guard_time_s", "Time guarded", "s", 1),
    "duration_s": _of("duration_s", "Flight time", "s", 1),
    "fsc_percent": _of("fsc_percent", "Sulphur content found", MASS_PERCENT, 4),
    "fsc_error_percent": Measure(
        figure=Figure(name="Error of the sulphur content", unit=MASS_PERCENT, digits=4),
        values=_off_fuel,
    ),
    "fsc_uncertainty_percent": _of(
        "fsc_uncertainty_percent", "Uncertainty of the sulphur content, 1σ", MASS_PERCENT, 4
    ),
}
"""By the names of the columns of ``differences.csv``, in the order they are shown."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Difference:
    """How a figure differs between the flights of each pair.

    Attributes
    ----------
    figure : which one
    before, after : of each flight, in the first run and in the other, in the figure's unit
    median, low, high : of the differences, and the exact interval of their median; not a number of
        fewer than ``PAIRS_MIN``. Pairs that share their random sample, such as those at the points
        of a sweep, count as one, with the mean of their differences
    """

    figure: Figure
    before: Array
    after: Array
    median: float
    low: float
    high: float

    @property
    def change(self) -> Array:
        """Return the difference of each pair; not a number where a flight does not have the figure."""
        change: Array = self.after - self.before
        return change

    @property
    def known(self) -> Array:
        """Return the differences of the pairs of which both flights have the figure."""
        change = self.change
        return change[np.isfinite(change)]

    @property
    def is_none(self) -> bool:
        """Return whether the figure is the same in both flights of every pair."""
        return not np.any(self.known)

    @property
    def excludes_zero(self) -> bool:
        """Return whether the median differs from 0 by more than its interval."""
        return self.low > 0.0 or self.high < 0.0


def differences(pairs: Pairs) -> dict[str, Difference]:
    """Return how each figure differs that both flights of some pair have, and that is not 0 in all
    of them.
    """
    found = {}
    for name, measure in MEASURES.items():
        before, after = (
            measure.figure.scale * measure.values(rows) for rows in (pairs.before, pairs.after)
        )
        change = after - before
        known = np.isfinite(change)
        if known.any() and np.any(before[known] != 0.0) | np.any(after[known] != 0.0) | (
            name == "keepout_violations"
        ):
            means = pd.Series(change[known]).groupby(pairs.samples[known]).mean()
            samples = np.asarray(means, dtype=np.float64)
            # The exact interval of order statistics: for any distribution, however few flights and
            # many ties.
            interval = quantile_interval(samples, 0.5, CONFIDENCE)
            found[name] = Difference(
                figure=measure.figure,
                before=before,
                after=after,
                median=float(np.median(samples)),
                low=interval.low,
                high=interval.high,
            )
    return found
