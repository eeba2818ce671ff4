"""The columns of a flight's faults in the summary, for the packages that fill and read them."""

import math
from collections.abc import Mapping
from typing import Any

NO_FAULT = "none"
"""Kind of a fault that a flight does not have."""


def fault_columns(number: int) -> tuple[str, str]:
    """Return the columns with the kind and the time of a flight's fault, by its number in the order
    of time, from 1.
    """
    kind = "fault" if number == 1 else f"fault_{number}"
    return kind, f"{kind}_time_s"


def faults_in(row: Mapping[Any, Any]) -> list[tuple[str, float]]:
    """Return kind and time [s] of each fault in a row of the summary, in the order of time."""
    found: list[tuple[str, float]] = []
    number = 1
    while (columns := fault_columns(number))[0] in row:
        kind, begins = row[columns[0]], row.get(columns[1], math.nan)
        if isinstance(begins, int | float) and math.isfinite(begins):
            found.append((str(kind), float(begins)))
        number += 1
    return found


def fault_kinds(row: Mapping[Any, Any]) -> str:
    """Return the kinds of the faults in a row of the summary, as "vessel_data, engine"; ``none``
    without one.
    """
    kinds, number = [], 1
    while (column := fault_columns(number)[0]) in row:
        kinds.append(str(row[column]))
        number += 1
    return ", ".join(kind for kind in kinds if kind != NO_FAULT) or NO_FAULT
