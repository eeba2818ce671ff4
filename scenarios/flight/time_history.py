"""Which time histories a study keeps, and how they are written."""

import io
import json
from collections.abc import Mapping
from typing import Any

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from common.columns import Table, column_of
from common.run_layout import FLIGHTS, evaluation_path, smoke_path, time_history_path
from scenarios.engine.task import Row, Task
from scenarios.flight.outcome import Outcome

UNFINISHED = (Outcome.NOT_SETTLED.value, Outcome.INCOMPLETE.value)
"""Outcomes of missions that were not completed though the aircraft came through."""


def keeps_history(task: Task, *, planned: int, kept: int, row: Row) -> bool:
    """Return whether the time history of a flight is kept.

    Of all flights an even sample is, and every one that is not known to have kept out, or did not
    do what is required of it. Of missions that were not completed there may be many: the study
    chooses among them.

    Parameters
    ----------
    task : the flight's
    planned, kept : number of flights, and of time histories to keep of them
    row : of the flight in the summary
    """
    sampled = (task.number + 1) * kept // planned > task.number * kept // planned
    if sampled or task.recorded or task.every_step or not row.get("kept_out", row["criteria_met"]):
        return True
    if row["outcome"] in UNFINISHED or row.get("required") == "keep_out":
        return False
    return not row["criteria_met"]


def history_files(
    task: Task,
    history: pd.DataFrame | None,
    document: Mapping[str, Any] | None,
    smoke: bytes | None,
    *,
    columns: Table,
    planned: int,
    kept: int,
    row: Row,
) -> dict[str, bytes]:
    """Return the time history of a flight as a Parquet file, by its path, if there is one and it is
    kept; with it the document and the smoke.

    Parameters
    ----------
    history : of the flight, if it has one
    document : what an instrument made of the flight, if any did
    smoke : parcels of the exhaust, if there was any
    columns : what the columns of time histories are
    task, planned, kept, row : same as ``keeps_history``
    """
    if history is None or not keeps_history(task, planned=planned, kept=kept, row=row):
        return {}
    files = {time_history_path(row["flight_id"]): as_parquet(history, columns)}
    if document is not None:
        files[evaluation_path(row["flight_id"])] = json.dumps(document).encode()
    if smoke is not None:
        files[smoke_path(row["flight_id"])] = smoke
    return files


def as_parquet(history: pd.DataFrame, columns: Table) -> bytes:
    """Return a time history as a Parquet file; unit and meaning of each column are in the metadata
    of its field.
    """
    # In this thread: to begin others takes longer than to convert so few columns, and other flights
    # have the other cores.
    table = pa.Table.from_pandas(history, preserve_index=False, nthreads=1)
    by_table = {FLIGHTS: columns}
    described = [
        field.with_metadata({"unit": column.unit, "meaning": column.meaning})
        for field in table.schema
        for column in [column_of(by_table, FLIGHTS, field.name)]
    ]
    buffer = io.BytesIO()
    pq.write_table(table.cast(pa.schema(described, metadata=table.schema.metadata)), buffer)
    return buffer.getvalue()
