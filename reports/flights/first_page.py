"""What page 1 says of flights: what was flown in a sentence, and the tracks of the closest flight and of a typical one."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from reports.document.chart import Chart
from reports.document.tables import vehicle_flown
from reports.flights.names import flight_name
from reports.flights.single_flight import flight_charts
from reports.run.columns import Array, clearance, column, total
from reports.run.run_data import RunData
from reports.run.trials import Trial

_CAPTION = (
    "Seen from the vessel, with the true axis of its plume up the page. Diamonds are plume crossings after settling and the closest"
    " approach; dots are where the keep-out guard changed commands."
)

_CALM = 0.05
"""Speed of the wind below which air counts as still [m/s]."""


def flights_in_words(run: RunData, flown: pd.DataFrame) -> str:
    """Return what was flown: flights and hours, vehicle, vessel and air; without a full stop."""
    if not len(flown):
        return "No flight was flown"
    flights = f"{len(flown):,} flight{'s' * (len(flown) > 1)} ({hours(flown)}) of {vehicle_flown(run)}"
    vessel = column(flown, "vessel_speed_mps")
    if not np.isfinite(vessel).any():
        return f"{flights}, about a circle without a vessel"
    wind = column(flown, "wind_speed_mps")
    levels = [str(level) for level in flown["turbulence"].dropna().unique() if level != "none"] if "turbulence" in flown else []
    air = f"wind of {_range(wind)} m/s" if np.nanmax(wind, initial=0.0) > _CALM else "still air"
    gusty = f" and {' or '.join(levels)} turbulence" if levels else ""
    return f"{flights}, beside a vessel at {_range(vessel)} m/s, in {air}{gusty}"


def hours(flown: pd.DataFrame) -> str:
    """Return how long all flights took together."""
    time = total(flown, "duration_s") / 3600.0
    return f"{time:,.0f} h" if time >= 100.0 else f"{time:.2g} h"


def _range(values: Array) -> str:
    low, high = (f"{round(float(end), 1):g}" for end in (np.nanmin(values), np.nanmax(values)))
    return low if low == high else f"{low} to {high}"


def closest_and_typical(trials: Sequence[Trial]) -> Chart | None:
    """Return the tracks of the flight that came closest and of the one with the median closest approach, if any has a record."""
    flights = [
        (trial, row, float(distance))
        for trial in trials
        for (_, row), distance in zip(trial.flown.iterrows(), clearance(trial.flown), strict=True)
        if trial.run.has_history(str(row["flight_id"]))
    ]
    if not flights:
        return None
    flights.sort(key=lambda flight: flight[2])
    if len(flights) == 1:
        trial, row, _ = flights[0]
        return track_picture([(trial, row, "")])
    chosen = {"Closest": flights[0], "Typical": flights[len(flights) // 2]}
    several = len(trials) > 1
    return track_picture(
        [
            (trial, row, f"{what}: {f'{trial.title}, ' * several}{flight_name(trial, row)}, {float(row['min_distance_m']):.1f} m")
            for what, (trial, row, _) in chosen.items()
        ],
        told=" Closest: the flight with the closest approach. Typical: the one whose closest approach is the median.",
    )


def track_picture(shown: Sequence[tuple[Trial, "pd.Series[Any]", str]], told: str = "") -> Chart | None:
    """Return the tracks of flights side by side, each with its title, seen from the vessel; all tracks of a flight that is alone.

    Parameters
    ----------
    shown : trial, row and title of each flight
    told : what the caption says besides

    Returns
    -------
    The figure, or None if no flight has a time history.
    """
    found = [(charts[0], name) for trial, row, name in shown if (charts := flight_charts(trial, row))]
    if not found:
        return None
    tracks = found[0][0]
    if len(found) == 1:
        return tracks
    panels = [replace(chart.panels[0], title=name) for chart, name in found]
    return replace(tracks, panels=panels, columns=len(panels), caption=_CAPTION + told)
