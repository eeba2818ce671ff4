"""Which time histories a study keeps, and how they are written."""

import io

import pandas as pd

from scenarios.engine.work import Row, Task


def keeps_history(task: Task, *, planned: int, wanted: int, row: Row) -> bool:
    """Return whether the time history of a flight is kept.

    Of all flights an even sample is, and every one that did not meet its criteria.

    Parameters
    ----------
    task : the flight's
    planned, wanted : number of flights, and of time histories to be kept of them
    row : of the flight in the summary
    """
    sampled = (task.number + 1) * wanted // planned > task.number * wanted // planned
    return sampled or task.recorded or task.every_step or not row["criteria_met"]


def history_path(flight_id: str) -> str:
    """Return where in a run directory the time history of a flight is."""
    return f"flights/{flight_id}.parquet"


def history_file(history: pd.DataFrame) -> bytes:
    """Return a time history as a Parquet file."""
    buffer = io.BytesIO()
    history.to_parquet(buffer, index=False)
    return buffer.getvalue()
