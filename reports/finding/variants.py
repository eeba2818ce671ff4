"""The flights of a trial that searches, and the same flights with a part changed."""

import math
from dataclasses import dataclass

import numpy as np
import pandas as pd

from reports.document.chart import VARIANT_STYLES, Style
from reports.document.palette import VARIANTS, Meaning
from reports.run.columns import Array, column, study_flight
from reports.run.run_data import RunData
from reports.run.trials import AS_IN_THE_STUDY, Trial, read_trials

_SEVERAL = 2
"""Flights of which there is a share that found the plume."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Variant:
    """Flights that differ in their cases alone.

    Attributes
    ----------
    name, colour, style : in tables and in figures
    rows : of the flights that reached their orbit
    """

    name: str
    colour: str
    rows: pd.DataFrame
    style: Style = "solid"

    @property
    def times(self) -> Array:
        """Time to find of each flight from reaching its orbit [s], infinite where it never found
        the plume.
        """
        return np.nan_to_num(column(self.rows, "time_to_find_s"), nan=math.inf)

    @property
    def found(self) -> int:
        """Number of flights that found the plume."""
        return int(np.isfinite(self.times).sum())

    @property
    def latest(self) -> float:
        """Time within which 95 % of the flights found the plume [s]: that of a flight, as there is
        nothing between a time and never.
        """
        return float(np.quantile(self.times, 0.95, method="inverted_cdf"))

    def share_found(self, within: float) -> float:
        """Return the share of flights that found the plume within a time [s]; at least one flight
        is needed.
        """
        return float(np.mean(self.times <= within))

    def beside(self, other: "Variant", name: str) -> Array:
        """Return a figure over that of the same case in another variant, of the cases that both
        have; at least a pair each.
        """
        mine, theirs = (of.rows.set_index(study_flight(of.rows))[name] for of in (self, other))
        pairs = pd.concat([mine, theirs], axis=1, join="inner").dropna()
        ratio: Array = pairs.iloc[:, 0].to_numpy(dtype=np.float64) / pairs.iloc[:, 1].to_numpy(
            dtype=np.float64
        )
        return ratio


def variants_of(trial: Trial) -> list[Variant]:
    """Return the study's own flights, and those of each comparison; none of a variant without a
    flight on its orbit.
    """
    compared = trial.run.comparison
    names: list[str] = []
    if len(compared):
        compared = compared[compared["trial"] == trial.key]
        names = [str(name) for name in dict.fromkeys(compared["variant"])]
    own = Variant(name=AS_IN_THE_STUDY, colour=Meaning.FLOWN, rows=_on_orbit(trial.rows))
    others = [
        Variant(
            name=name.replace("_", " "),
            colour=VARIANTS[i % len(VARIANTS)],
            style=VARIANT_STYLES[i % len(VARIANT_STYLES)],
            rows=_on_orbit(compared[compared["variant"] == name]),
        )
        for i, name in enumerate(names)
    ]
    return [variant for variant in (own, *others) if len(variant.rows)]


def searching_variants(run: RunData) -> list[Variant]:
    """Return the variants of a run of one trial in which several flights search for the plume; none
    of any other.
    """
    trials = read_trials(run)
    if len(trials) != 1 or len(trials[0].rows) < _SEVERAL:
        return []
    rows = trials[0].rows
    searches = "axis_height_end_m" in rows and rows["axis_height_end_m"].notna().any()
    return variants_of(trials[0]) if searches else []


def _on_orbit(rows: pd.DataFrame) -> pd.DataFrame:
    return rows[rows["orbit_at_s"].notna()] if "orbit_at_s" in rows else rows.iloc[:0]
