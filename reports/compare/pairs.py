"""The runs that are compared, which flights of two of them are the same (of the same point or case,
with the same number and the same seed), and how far the figures of these differ.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from common.columns import Column
from common.intervals import CONFIDENCE, quantile_interval
from common.run_layout import SUMMARY
from reports.errors import ReportError
from reports.run.columns import Array, Mask, completed, is_figure, judged, kept_out, met
from reports.run.files import damage_named
from reports.run.run_data import FLIGHT_ENTRIES, RunData, read_run, refuse_other_version
from reports.run.trials import Trial, read_trials

RUNS_MAX = 6
"""Runs that fit side by side."""

_NOT_COMPARED = {
    **dict.fromkeys(("design", "measurement"), "which has no flights to compare"),
}
"""Studies whose runs are not compared, and why; a study that others add says it in its manifest."""

_ENTRIES = (
    *FLIGHT_ENTRIES, "name", "overrides", "config_hash", "fingerprint", "packages", "git_revision",
    "python", "platform",
    "flights_planned",
)  # fmt: skip
_COLUMNS = (
    "flight_id", "trial", "seed", "outcome", "message", "criteria_met", "kept_out",
    "keepout_violations", "keepout_radius_m",
    "min_distance_m", "settling_time_s", "duration_s",
)  # fmt: skip
"""What a comparison needs of a manifest, and of a summary."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """A run of a comparison.

    Attributes
    ----------
    letter : "A" for the first
    data : as read from disk
    trials : of the run
    """

    letter: str
    data: RunData
    trials: Sequence[Trial]

    @property
    def name(self) -> str:
        """Name of its directory."""
        return self.data.path.resolve().name

    @property
    def title(self) -> str:
        """Its letter and the name of its directory."""
        return f"{self.letter}: {self.name}"

    @property
    def manifest(self) -> dict[str, Any]:
        """Its manifest."""
        return self.data.manifest

    @property
    def state(self) -> str:
        """How it ended, in words."""
        return "complete" if self.data.verdict.is_done else "interrupted"


def read_runs(paths: Sequence[Path]) -> list[Run]:
    """Read the runs to be compared.

    Raises
    ------
    ReportError : there are too few or too many, one is named twice, or one is none with flights of
        this version that has ended
    """
    if not 2 <= len(paths) <= RUNS_MAX:
        raise ReportError(
            f"{len(paths)} run{'s' if len(paths) != 1 else ''} given; 2 to {RUNS_MAX} can be"
            " compared: name so many"
        )
    resolved = [path.resolve() for path in paths]
    for i, path in enumerate(resolved):
        if path in resolved[:i]:
            raise ReportError(f"'{paths[i]}' is given twice; name another run")
    return [_read(chr(ord("A") + i), path) for i, path in enumerate(paths)]


def _read(letter: str, path: Path) -> Run:
    data = read_run(path)
    study = str(data.manifest.get("study"))
    if reason := data.manifest.get("not_compared") or _NOT_COMPARED.get(study):
        raise ReportError(f"'{path}' is of the study '{study}', {reason}; name a run of flights")
    refuse_other_version(data, _ENTRIES)
    if missing := [name for name in _COLUMNS if name not in data.summary]:
        raise ReportError(
            f"'{path}' was flown by another version: its {SUMMARY} has no '{missing[0]}'; run the"
            " scenario again in another --out"
        )
    # A run that did not end has no verdict, and is refused.
    _ = data.verdict
    with damage_named(path):
        return Run(letter=letter, data=data, trials=read_trials(data))


SPEED_RATIO = "nu"
"""Input that follows from speeds of vessel, UAV and air."""

_NAMING = ("flight_id", "trial", "variant")
"""Columns of ``draws.csv`` that name a flight."""

_STATES: Mapping[str, Callable[[pd.DataFrame], Mask]] = {
    "met": met,
    "known to keep out": kept_out,
    "completed their mission": completed,
}
"""What a flight may be in one of two runs alone."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Pairs:
    """Flights that a run has in common with the first.

    Attributes
    ----------
    first, other : the runs
    before, after : rows of their summaries; the flights of row i are the same
    same_name : flights without a partner for which the other run has a flight of the same name
        with another seed
    """

    first: Run
    other: Run
    before: pd.DataFrame
    after: pd.DataFrame
    same_name: int

    def __len__(self) -> int:
        """Return the number of pairs."""
        return len(self.before)

    @property
    def alone(self) -> tuple[int, int]:
        """Number of flights without a partner, of the first run and of the other."""
        return len(self.first.data.summary) - len(self), len(self.other.data.summary) - len(self)

    @property
    def other_verdict(self) -> Mask:
        """Flights whose fuel is called otherwise."""
        if not all("sulphur_verdict" in rows for rows in (self.before, self.after)):
            return np.zeros(len(self), dtype=np.bool_)
        before, after = (
            rows["sulphur_verdict"].fillna("").to_numpy(dtype=str)
            for rows in (self.before, self.after)
        )
        differs: Mask = before != after
        return differs

    @property
    def samples(self) -> npt.NDArray[np.int64]:
        """Number of each pair's random sample: pairs of a trial that have one seed share it, and
        one without a seed is alone.
        """
        alone = np.where(self.before["seed"].isna(), np.arange(len(self)), -1)
        numbers = self.before.groupby(["trial", "seed", alone], dropna=False).ngroup()
        return np.asarray(numbers, dtype=np.int64)

    @property
    def names(self) -> list[str]:
        """What the first run calls each flight."""
        return [str(flight_id) for flight_id in self.before["flight_id"]]

    @property
    def no_longer_met(self) -> Mask:
        """Flights that met every criterion in the first run alone."""
        return met(self.before) & ~met(self.after)

    @property
    def newly_met(self) -> Mask:
        """Flights that meet every criterion in the other run alone."""
        return ~met(self.before) & met(self.after)

    @property
    def in_first_alone(self) -> dict[str, Mask]:
        """Flights that met every criterion, are known to keep out, or completed their mission in
        the first run alone.
        """
        return {words: state(self.before) & ~state(self.after) for words, state in _STATES.items()}

    @property
    def in_other_alone(self) -> dict[str, Mask]:
        """The same of the other run."""
        return {words: state(self.after) & ~state(self.before) for words, state in _STATES.items()}

    @property
    def no_longer(self) -> Mask:
        """Flights that are worse in the other run in any of these."""
        worse: Mask = np.logical_or.reduce(list(self.in_first_alone.values()))
        return worse

    def differing_inputs(self) -> dict[str, int]:
        """Return the keys that were sampled or swept in both runs with another value in some pairs,
        and in how many.

        ``SPEED_RATIO`` is among them where it differs, though it is that of the flight: paired
        flights have the same swept one.
        """
        tables = [run.data.draws.set_index("flight_id") for run in (self.first, self.other)]
        shared = [name for name in tables[0] if name in tables[1] and name not in _NAMING]
        before, after = (
            table.reindex(rows["flight_id"])
            for table, rows in zip(tables, (self.before, self.after), strict=True)
        )
        counts = {
            str(name): int(np.count_nonzero(_differs(before[name], after[name]))) for name in shared
        }
        return {name: count for name, count in counts.items() if count}

    def differing_figures(self, *, apart: Sequence[str] = ()) -> list[str]:
        """Return the columns in which any pair differs in the least, but for those ``apart``; one
        that a run lacks differs.
        """
        columns = [name for name in dict.fromkeys([*self.before, *self.after]) if name not in apart]
        return [
            str(name)
            for name in columns
            if name not in self.before
            or name not in self.after
            or np.any(_differs(self.before[name], self.after[name]))
        ]


def paired(first: Run, other: Run) -> Pairs:
    """Return the flights that two runs have in common.

    Raises
    ------
    ReportError : they have none
    """
    rows = (first.data.summary, other.data.summary)
    left = [_identities(table) for table in rows]
    found: list[pd.DataFrame] = []
    # Trials may have other names, such as in a run of one trial and in one of a list; and flights
    # may have no seed, as their process was lost before it was known.
    for keys in (["trial", "name", "seed"], ["name", "seed"], ["trial", "name"]):
        matched = _matched(left[0], left[1], keys)
        found.append(matched[["place_x", "place_y"]])
        left = [
            table[~table["place"].isin(matched[place])]
            for table, place in zip(left, ("place_x", "place_y"), strict=True)
        ]
    places = pd.concat(found).sort_values("place_x")
    same = len(set(left[0]["name"]) & set(left[1]["name"]))
    if not len(places):
        what = _why_none(left[0], left[1], same)
        one, two = (
            f"'{run.data.path}' ({len(table)} flight{'s' * (len(table) != 1)})"
            for run, table in zip((first, other), rows, strict=True)
        )
        raise ReportError(f"{one} and {two} have no flight in common: {what}")
    before, after = (
        table.iloc[places[place]].reset_index(drop=True)
        for table, place in zip(rows, ("place_x", "place_y"), strict=True)
    )
    return Pairs(first=first, other=other, before=before, after=after, same_name=same)


def _why_none(one: pd.DataFrame, two: pd.DataFrame, same: int) -> str:
    """Return why no flight is in both runs, and what to do; ``same`` is the number of names that
    are.
    """
    if not same:
        return "no name is in both"
    what = f"{same} agree{'s' * (same == 1)} in name but not in seed"
    if set(one["trial"]) & set(two["trial"]):
        return f"{what}; give both the same --seed"
    names = " and ".join(f"'{table['trial'].iloc[0]}'" for table in (one, two))
    return (
        f"{what}, since seeds follow from --seed and from the scenario's name, here {names}; fly"
        " one scenario both times, with"
        " --set for what is to differ, or, if it has one flight, give both the same flight_seed"
    )


def _identities(rows: pd.DataFrame) -> pd.DataFrame:
    """Return trial, name and seed of flights, and their places: the name is that within the trial,
    without the name of the trial before it.
    """
    if not len(rows):
        return pd.DataFrame({"trial": [], "name": [], "seed": [], "place": []})
    named = zip(rows["flight_id"].astype(str), rows["trial"].astype(str), strict=True)
    names = [flight.removeprefix(f"{trial}_") for flight, trial in named]
    places = np.arange(len(rows))
    return pd.DataFrame(
        {
            "trial": rows["trial"].astype(str),
            "name": names,
            "seed": rows["seed"].astype(float),
            "place": places,
        }
    )


def _matched(one: pd.DataFrame, two: pd.DataFrame, keys: list[str]) -> pd.DataFrame:
    """Return the flights of both that agree in ``keys``, where no other flight of the same run
    does.
    """
    by_seed = "seed" in keys
    tables = [table[table["seed"].notna()] if by_seed else table for table in (one, two)]
    found = (
        tables[0]
        .drop_duplicates(keys, keep=False)
        .merge(tables[1].drop_duplicates(keys, keep=False), on=keys)
    )
    return found if by_seed else found[found["seed_x"].isna() | found["seed_y"].isna()]


def _differs(before: "pd.Series[Any]", after: "pd.Series[Any]") -> Mask:
    """Return which values differ; two that are missing do not."""
    equal = np.asarray(before.to_numpy() == after.to_numpy(), dtype=np.bool_)
    differs: Mask = ~(equal | (before.isna().to_numpy() & after.isna().to_numpy()))
    return differs


PAIRS_MIN = 6
"""Pairs from which on a median has an interval: fewer lie all on one side of it more often than in
5 %.
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
        """Return the differences of the pairs whose flights both have the figure."""
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
