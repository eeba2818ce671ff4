"""Figures of flights that are compared, and how far they differ between the flights of a pair."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import pandas as pd

from common.columns import Column
from common.intervals import CONFIDENCE, quantile_interval
from common.run_layout import SUMMARY
from reports.compare.pairs import Pairs
from reports.run.columns import Array, is_figure, judged
from reports.run.run_data import RunData

PAIRS_MIN = 6
"""Pairs from which on a median has an interval: of fewer, all lie on one side of it more often than
in 5 %.
"""


JUDGED = ("clearance_m", "tracking_error_rms_m", "crossing_interval_error", "settling_time_s")
"""Figures that most reports judge: by them a flight differs much or little."""

COMPARED = (
    "min_distance_m",
    "clearance_m",
    "keepout_violations",
    "crossing_interval_mean_s",
    "crossing_interval_error",
    "crossing_distance_mean_m",
    "crossing_count",
    "tracking_error_rms_m",
    "settling_time_s",
    "airspeed_error_rms_mps",
    "altitude_error_max_m",
    "bank_max_deg",
    "guard_interventions",
    "guard_time_s",
    "duration_s",
    "fsc_percent",
    "fsc_error_percent",
    "fsc_uncertainty_percent",
)
"""Figures of the flight itself that are compared, in the order they are shown."""


def measures(runs: Iterable[RunData]) -> dict[str, Column]:
    """Return the figures that are compared, by the names of the columns of ``differences.csv``: the
    flight's own, and those of users' instruments and studies that hold numbers in every run that
    has them.
    """
    runs = list(runs)
    added = {name: of for run in reversed(runs) for name, of in run.added(SUMMARY).items()}
    numbers = [
        name
        for name in added
        if all(is_figure(run.summary, name) for run in runs if name in run.summary)
    ]
    return {name: runs[0].column(name) for name in COMPARED} | {
        name: added[name] for name in numbers
    }


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

    figure: Column
    before: Array
    after: Array
    median: float
    low: float
    high: float

    @property
    def change(self) -> Array:
        """Return the difference of each pair; not a number where a flight does not have the
        figure.
        """
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
    for name, figure in measures((pairs.first.data, pairs.other.data)).items():
        before, after = (
            figure.scale * judged(rows, name, figure) for rows in (pairs.before, pairs.after)
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
                figure=figure,
                before=before,
                after=after,
                median=float(np.median(samples)),
                low=interval.low,
                high=interval.high,
            )
    return found
