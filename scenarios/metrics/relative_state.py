"""A flight's time history: its record, and the relative state of the delta formulation that follows from it."""

import pandas as pd

from gnc.laws.delta import RelativeState, relative_state
from scenarios.planning.planner import FlightPlan
from scenarios.simulation.closed_loop import COLUMNS, FlightRecord

RELATIVE_COLUMNS = ("delta_m", "rho_m", "phi_r_rad", "phi_rad")
"""The states of equation (19), in its order."""


def flight_history(plan: FlightPlan, record: FlightRecord) -> pd.DataFrame:
    """Return a row per sample; columns are those of the record and ``RELATIVE_COLUMNS``."""
    history = pd.DataFrame(record.every_step, columns=list(COLUMNS))
    motion = history[["reference_north_m", "north_m", "reference_east_m", "east_m", "reference_course_rad", "course_rad"]]
    states: list[RelativeState] = [
        relative_state(plan.steering.look_ahead, to_north - north, to_east - east, reference_course, course)
        for to_north, north, to_east, east, reference_course, course in motion.itertuples(index=False, name=None)
    ]
    history[list(RELATIVE_COLUMNS)] = states
    return history
