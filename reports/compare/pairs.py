"""Which flights of two runs are the same: of the same point or case, with the same number and the
same seed.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from reports.compare.runs import Run
from reports.errors import ReportError
from reports.run.columns import Mask, completed, kept_out, met

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
    same_name : flights without a partner of which the other run has one of the same name, with
        another seed
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
    # Trials of other names, as of a run of one trial and of a list; and flights whose process was
    # lost before the seed was known.
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
    """Return what flights are told by, and their places: the name is that within the trial, which
    several put before it.
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
