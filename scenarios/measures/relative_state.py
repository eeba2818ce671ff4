"""A flight's time history: its record, and the relative state of the delta formulation that follows
from it.
"""

import math

import numpy as np
import numpy.typing as npt
import pandas as pd

from aircraft.wind import CALM
from common.geodesy import LocalFrame
from gnc.numeric import wrapped
from gnc.paper import LookAhead
from scenarios.flight.record import PLACE_COLUMNS, RELATIVE_COLUMNS, WIND_COLUMNS, FlightRecord
from scenarios.planning.flight_plan import FlightPlan

Array = npt.NDArray[np.float64]


def flight_history(plan: FlightPlan, record: FlightRecord) -> pd.DataFrame:
    """Return a row per sample; columns are those of the record, ``RELATIVE_COLUMNS``, and what
    there is of the others.
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
        names, states = (
            (*names, *WIND_COLUMNS),
            (*states, *wind.at(column("time_s"), column("altitude_m"))),
        )
    # One table at once: to add columns to one takes five times as long.
    history = pd.DataFrame(np.column_stack([record.every_step, *states]), columns=list(names))
    place = plan.world.place if plan.world else None
    if place is not None and math.isfinite(place.latitude):
        # Metres are counted at the altitude that the flight is flown at.
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
    """Return delta, rho [m], phi_r and phi [rad] of many samples at once; parameters as of
    ``gnc.paper.relative_state``.
    """
    delta = look_ahead.epsilon * (to_north**2 + to_east**2) + look_ahead.radius
    z_north, z_east = (
        to_north + delta * np.cos(reference_course),
        to_east + delta * np.sin(reference_course),
    )
    z_course = np.arctan2(z_east, z_north)
    return (
        delta,
        np.hypot(z_north, z_east),
        wrapped(reference_course - z_course),
        wrapped(course - z_course),
    )
