"""What the faults of flights are called, and the marks of their times."""

import pandas as pd

from common.faults import fault_kinds, faults_in
from reports.run.flight_config import Row


def fault_name(kind: object) -> str:
    """Return what a fault is called."""
    return str(kind).replace("_", " ")


def faults_name(row: Row) -> str:
    """Return what the faults of a flight are called, given its row."""
    return fault_name(fault_kinds(dict(row)))


def names_of_faults(rows: pd.DataFrame) -> list[str]:
    """Return what the faults of each flight are called."""
    return [faults_name(row) for row in rows.to_dict("records")]


def fault_marks(row: Row) -> dict[str, float]:
    """Return the time of each fault of a flight [s], by what a mark at it is called."""
    faults = faults_in(dict(row))
    if len(faults) == 1:
        return {"fault": faults[0][1]}
    return {f"fault {i}, {fault_name(kind)}": at for i, (kind, at) in enumerate(faults, start=1)}
