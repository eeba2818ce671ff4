"""A flight's time history: its record with derived columns, the choice of those that a study keeps,
and the file.
"""

import io
import json
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from aircraft.wind import CALM
from common.columns import Table, column_of
from common.geodesy import LocalFrame
from common.run_layout import FLIGHTS, evaluation_path, smoke_path, time_history_path, traffic_path
from gnc.numeric import wrapped
from gnc.paper import LookAhead
from scenarios.engine.task import Row, Task
from scenarios.flight.outcome import Outcome
from scenarios.flight.record import (
    HULL_COLUMNS,
    PLACE_COLUMNS,
    RELATIVE_COLUMNS,
    WIND_COLUMNS,
    FlightRecord,
)
from scenarios.planning.flight_plan import FlightPlan

Array = npt.NDArray[np.float64]


def flight_history(plan: FlightPlan, record: FlightRecord) -> pd.DataFrame:
    """Return a row per sample; columns are those of the record, ``RELATIVE_COLUMNS``, and the
    others that exist.
    """
    numbers = {name: i for i, name in enumerate(record.columns)}

    def column(name: str) -> Array:
        return record.every_step[:, numbers[name]]

    to_north, to_east = (
        column(f"reference_{axis}_m") - column(f"{axis}_m") for axis in ("north", "east")
    )
    through_air = [
        column(f"velocity_{axis}_mps") - column(f"wind_{axis}_mps") for axis in ("north", "east")
    ]
    course = np.arctan2(through_air[1], through_air[0])
    states: tuple[Array, ...] = relative_states(
        plan.steering.look_ahead, to_north, to_east, column("reference_course_rad"), course
    )
    names = (*record.columns, *RELATIVE_COLUMNS)
    wind = plan.world.weather.wind if plan.world else CALM
    if wind != CALM:
        names = (*names, *WIND_COLUMNS)
        states = (*states, *wind.at(column("time_s"), column("altitude_m")))
    if plan.world is not None and plan.world.hull is not None:
        names = (*names, *HULL_COLUMNS)
        states = (*states, plan.world.headings(column("time_s")))
    # One table at once: adding columns to a table takes five times as long.
    history = pd.DataFrame(np.column_stack([record.every_step, *states]), columns=list(names))
    place = plan.world.place if plan.world else None
    if place is not None and math.isfinite(place.latitude):
        # Metres are counted at the altitude of the flight.
        frame = LocalFrame(place.latitude, place.longitude, plan.altitude)
        found = (
            np.degrees(angle) for angle in frame.to_geodetic(column("north_m"), column("east_m"))
        )
        history = history.assign(**dict(zip(PLACE_COLUMNS, found, strict=False)))
    if place is not None and math.isfinite(place.utc):
        history["time_utc"] = pd.to_datetime(
            np.round(1e3 * (place.utc + column("time_s"))), unit="ms", utc=True
        )
    return history


def relative_states(
    look_ahead: LookAhead, to_north: Array, to_east: Array, reference_course: Array, course: Array
) -> tuple[Array, Array, Array, Array]:
    """Return delta, rho [m], phi_r and phi [rad] of many samples at once; parameters are those of
    ``gnc.paper.relative_state``.
    """
    delta = look_ahead.epsilon * (to_north**2 + to_east**2) + look_ahead.radius
    z_north = to_north + delta * np.cos(reference_course)
    z_east = to_east + delta * np.sin(reference_course)
    z_course = np.arctan2(z_east, z_north)
    return (
        delta,
        np.hypot(z_north, z_east),
        wrapped(reference_course - z_course),
        wrapped(course - z_course),
    )


UNFINISHED = (Outcome.NOT_SETTLED.value, Outcome.INCOMPLETE.value)
"""Outcomes of missions that were not completed although the aircraft was not lost."""


def keeps_history(task: Task, *, planned: int, kept: int, row: Row) -> bool:
    """Return whether the time history of a flight is kept.

    An even sample of all flights is kept, and every flight that is not known to have kept out, or
    that did not meet its requirements. Many missions may not have been completed: the study chooses
    among them.

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
    traffic: bytes | None = None,
    columns: Table,
    planned: int,
    kept: int,
    row: Row,
) -> dict[str, bytes]:
    """Return the files of a flight's time history by their paths: the history as Parquet, the
    document, the smoke and the tracks of other ships; empty if the history is not kept.

    Parameters
    ----------
    history : of the flight, if it has one
    document : made by an instrument from the flight, or None
    smoke : parcels of the exhaust, or None
    traffic : tracks of other ships, or None
    columns : units and meanings of the columns of time histories
    task, planned, kept, row : same as ``keeps_history``
    """
    if history is None or not keeps_history(task, planned=planned, kept=kept, row=row):
        return {}
    files = {time_history_path(row["flight_id"]): as_parquet(history, columns)}
    if document is not None:
        files[evaluation_path(row["flight_id"])] = json.dumps(document).encode()
    if smoke is not None:
        files[smoke_path(row["flight_id"])] = smoke
    if traffic is not None:
        files[traffic_path(row["flight_id"])] = traffic
    return files


def as_parquet(history: pd.DataFrame, columns: Table) -> bytes:
    """Return a time history as a Parquet file; unit and meaning of each column are in the metadata
    of its field.
    """
    # In this thread: starting other threads takes longer than converting so few columns, and other
    # flights use the other cores.
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
