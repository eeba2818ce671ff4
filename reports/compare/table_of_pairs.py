"""The paired differences as a table, for other programs."""

import csv
import math
from collections.abc import Iterator, Sequence
from pathlib import Path

from common.text import cell
from reports.compare.content import Compared
from reports.compare.pairs import measures
from reports.run.columns import met

_NAMES = ("run", "directory", "flight_id", "trial", "seed", "criteria_met_first", "criteria_met")


def write_differences(compared: Sequence[Compared], path: Path) -> None:
    """Write a row per pair: names, and each figure in the first run, in the other, and its
    difference, empty where it has none.
    """
    runs = [compared[0].pairs.first, *(of.pairs.other for of in compared)]
    every = measures(run.data for run in runs)
    names = [name for name in every if any(name in of.found for of in compared)]
    columns = [column for name in names for column in (f"{name}_first", name, f"{name}_difference")]
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([*_NAMES, *columns])
        writer.writerows(
            [cell(value) for value in row] for of in compared for row in _rows(of, names)
        )


def _rows(compared: Compared, names: Sequence[str]) -> Iterator[list[object]]:
    pairs = compared.pairs
    was_met, is_met = met(pairs.before), met(pairs.after)
    for i, (flight, trial, seed) in enumerate(
        zip(pairs.names, pairs.before["trial"], pairs.before["seed"], strict=True)
    ):
        row: list[object] = [
            pairs.other.letter,
            pairs.other.name,
            flight,
            str(trial),
            seed,
            bool(was_met[i]),
            bool(is_met[i]),
        ]
        for name in names:
            difference = compared.found.get(name)
            values = (difference.before, difference.after, difference.change) if difference else ()
            scale = difference.figure.scale if difference else 1.0
            row += [float(of[i]) / scale for of in values] if values else [math.nan] * 3
        yield row
