"""Which time histories a study keeps, and how they are written."""

import io

import pandas as pd

from common.run_layout import time_history_path
from scenarios.engine.task import Row, Task


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


def history_files(task: Task, history: pd.DataFrame | None, *, planned: int, wanted: int, row: Row) -> dict[str, bytes]:
    """Return the time history of a flight as a Parquet file, by its path, if there is one and it is kept.

    Parameters
    ----------
    history : of the flight, if it has one
    task, planned, wanted, row : as of ``keeps_history``
    """
    if history is None or not keeps_history(task, planned=planned, wanted=wanted, row=row):
        return {}
    buffer = io.BytesIO()
    history.to_parquet(buffer, index=False)
    return {time_history_path(row["flight_id"]): buffer.getvalue()}
