"""Which time histories a study keeps, and how they are written."""

import io
import json
from collections.abc import Mapping
from typing import Any

import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from common.run_layout import evaluation_path, time_history_path
from scenarios.engine.task import Row, Task
from scenarios.simulation.guard_belief import BELIEF_MEANINGS
from scenarios.simulation.outcome import Outcome
from scenarios.simulation.record import MEANINGS, unit_of

INSTRUMENT_MEANINGS = {
    **{
        name: text
        for gas in ("so2_ppb", "co2_ppm", "no_ppb", "no2_ppb")
        for name, text in (
            (gas, "true concentration along the path"),
            (gas.replace("_", "_reading_"), "reading, held until the next one"),
        )
    },
    "co2_background_ppm": "true CO2 of the air without the exhaust",
    "plume_across_m": "place across the plume's mean axis",
    "plume_above_m": "height above the plume's mean axis",
    "plume_fraction": "concentration over that in the centre of the plume",
    "axis_height_estimated_m": "estimated height of the plume's axis",
    "axis_height_deviation_m": "standard deviation of the estimated height",
    "axis_offset_estimated_m": "estimated offset of the axis across the predicted one",
    "axis_offset_deviation_m": "standard deviation of the estimated offset",
    "axis_spread_estimated_m": "estimated vertical spread of the plume",
    "axis_spread_across_estimated_m": "estimated horizontal spread of the plume",
    "axis_measurable": "estimated probability that the plume can be crossed within the limits of the altitude",
    **BELIEF_MEANINGS,
    "axis_innovation": "mean normalised innovation squared of the passes, 1 where the filter is consistent",
}
"""Of time histories, of a sniffer, of a search for the plume and of the keep-out guard."""

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
    *,
    planned: int,
    kept: int,
    row: Row,
) -> dict[str, bytes]:
    """Return the time history of a flight as a Parquet file, by its path, if there is one and it is
    kept; and the document.

    Parameters
    ----------
    history : of the flight, if it has one
    document : what an instrument made of the flight, if any did
    task, planned, kept, row : as of ``keeps_history``
    """
    if history is None or not keeps_history(task, planned=planned, kept=kept, row=row):
        return {}
    files = {time_history_path(row["flight_id"]): as_parquet(history)}
    if document is not None:
        files[evaluation_path(row["flight_id"])] = json.dumps(document).encode()
    return files


def as_parquet(history: pd.DataFrame) -> bytes:
    """Return a time history as a Parquet file; unit and meaning of each column are in the metadata
    of its field.
    """
    # In this thread: to begin others takes longer than to convert so few columns, and other flights
    # have the other cores.
    table, meanings = (
        pa.Table.from_pandas(history, preserve_index=False, nthreads=1),
        MEANINGS | INSTRUMENT_MEANINGS,
    )
    described = [
        field.with_metadata({"unit": unit_of(field.name), "meaning": meanings.get(field.name, "")})
        for field in table.schema
    ]
    buffer = io.BytesIO()
    pq.write_table(table.cast(pa.schema(described, metadata=table.schema.metadata)), buffer)
    return buffer.getvalue()
