"""How the premises of the keep-out guard held in many flights, by term and by case."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from common.columns import Column, described
from common.physics import SECONDS_PER_HOUR
from common.premises import TERMS, ratio_column

TABLE_COLUMNS = described(
    {
        "case": Column("case of the flights", kind="text"),
        "term": Column("term of the error budget", kind="text"),
        "flights": Column("flights in which the term has a ratio", digits=0),
        "ratio_median": "median over flights of the largest ratio of a flight",
        "ratio_max": "largest ratio of all flights",
        "flight_id": Column("flight of the largest ratio", title="Flight", kind="text"),
        "flights_above": Column("flights with a ratio above 1", digits=0),
        "flights_above_expected": "flights above 1 that the rate of the budget lets expect at most:"
        " of processes in turbulence; none of a term that is a bound",
    }
)
"""Of ``premises.csv``: a row per case and term."""

_PROCESSES = ("wind", "turning", "drift")
"""Terms that are processes in turbulence: each exceeds its budget at the budget's rate."""


def premise_table(rows: pd.DataFrame, cases: Sequence[str], per_hour: float) -> pd.DataFrame:
    """Return median and largest ratio of each term and case, and how many flights are above 1.

    Parameters
    ----------
    rows : a row per flight, with the columns of the summary
    cases : of each flight
    per_hour : rate at which a process exceeds what is reckoned with [1/h]
    """
    found = []
    for case, of_case in rows.groupby(np.asarray(cases), sort=False):
        for term in TERMS:
            ratios = pd.to_numeric(of_case[ratio_column(term)], errors="coerce").dropna()
            if ratios.empty:
                continue
            known = of_case.loc[ratios.index]
            gusty = (known["turbulence"] != "none") & (term in _PROCESSES)
            hours = float(known["duration_s"][gusty].sum()) / SECONDS_PER_HOUR
            largest = int(np.argmax(ratios))
            found.append(
                {
                    "case": case,
                    "term": term,
                    "flights": len(ratios),
                    "ratio_median": float(ratios.median()),
                    "ratio_max": float(ratios.max()),
                    "flight_id": known["flight_id"].iloc[largest],
                    "flights_above": int((ratios > 1.0).sum()),
                    "flights_above_expected": per_hour * hours,
                }
            )
    return pd.DataFrame(found, columns=list(TABLE_COLUMNS))


def premise_lines(table: pd.DataFrame) -> list[str]:
    """Return the table for the console: for each case a line, for each term a column."""
    terms = [term for term in TERMS if term in set(table["term"])]
    width = max([len("case"), *map(len, table["case"])]) if len(table) else 0
    lines = [f"  {'case':{width}}" + "".join(f"  {term:>14}" for term in terms)]
    for case, of_case in table.groupby("case", sort=False):
        cells = {row.term: _cell(row) for row in of_case.itertuples()}
        lines.append(
            f"  {case:{width}}" + "".join(f"  {cells.get(term, ''):>14}" for term in terms)
        )
    return [
        "largest ratio of error to budget in a flight: median / largest (flights above 1)",
        *lines,
    ]


def _cell(row: object) -> str:
    median, largest = row.ratio_median, row.ratio_max  # type: ignore[attr-defined]
    above = row.flights_above  # type: ignore[attr-defined]
    return f"{median:.2f} / {largest:.2f}{f' ({above})' if above else ''}"
