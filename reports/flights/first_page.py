"""What page 1 says of flights: what was flown in a sentence, and the tracks of the closest flight
and of a typical one.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from common.physics import SECONDS_PER_HOUR
from reports.document.chart import Chart
from reports.document.tables import approach, vehicle_flown
from reports.flights.names import name_in_run
from reports.flights.tracks import track_picture
from reports.run.columns import (
    SEVERE,
    Array,
    Mask,
    by_severity,
    clearance,
    column,
    radii_differ,
    recorded_at,
    severity,
)
from reports.run.flight_config import flight_configs, wind_changes
from reports.run.run_data import RunData
from reports.run.trials import Trial

_TELLING = ("Lost", "Diverged", "Violated", "Closest")
"""What a flight is shown for, by its severity."""

_NAME_MAX = 30
"""Letters of a flight's name that there is room for above its picture."""

_STEADY = 0.005
"""Change of the speed ratio up to which a vessel keeps its speed and course [-]."""

_MINUTES_MIN = 2.0
"""Time of flight from which on it is given in minutes [min]."""

CALM = 0.05
"""Speed of the wind below which air counts as still [m/s]."""


def flights_in_words(run: RunData, flown: pd.DataFrame) -> str:
    """Return what was flown: flights and hours, vehicle, vessel and air; without a full stop."""
    if not len(flown):
        return "No flight was flown"
    flights = (
        f"{len(flown):,} flight{'s' * (len(flown) > 1)} ({simulated(flown)}) of"
        f" {vehicle_flown(run)}"
    )
    vessel = column(flown, "vessel_speed_mps")
    if not np.isfinite(vessel).any():
        return f"{flights}, about a circle without a vessel"
    wind = column(flown, "wind_speed_mps")
    levels = flown["turbulence"].dropna() if "turbulence" in flown else pd.Series(dtype=str)
    levels = levels[levels != "none"]
    changes = any(map(wind_changes, flight_configs(run, flown)))
    air = (
        f"wind of {_range(wind)} m/s{' at the start' * changes}"
        if changes or np.nanmax(wind, initial=0.0) > CALM
        else "still air"
    )
    some = f", in {len(levels):,} of them," * (len(levels) < len(flown))
    gusty = f" and{some} {' or '.join(map(str, levels.unique()))} turbulence" if len(levels) else ""
    manoeuvres = np.any(column(flown, "nu_max") - column(flown, "nu_min") > _STEADY)
    return (
        f"{flights}, beside a vessel at {_range(vessel)} m/s{' at the start' * bool(manoeuvres)},"
        f" in {air}{gusty}"
    )


def simulated(flown: pd.DataFrame) -> str:
    """Return how long all flights took together; less than an hour is in minutes, less than two
    minutes in seconds.
    """
    time = float(np.nansum(column(flown, "duration_s"))) / SECONDS_PER_HOUR
    if 60.0 * time < _MINUTES_MIN:
        return f"{SECONDS_PER_HOUR * time:.0f} s simulated"
    if time < 1.0:
        return f"{60.0 * time:.2g} min simulated"
    return f"{time:,.0f} h simulated" if time >= 99.5 else f"{time:.2g} h simulated"


def _range(values: Array) -> str:
    low, high = (f"{round(float(end), 1):g}" for end in (np.nanmin(values), np.nanmax(values)))
    return low if low == high else f"{low} to {high}"


def telling_and_typical(trials: Sequence[Trial]) -> Chart | None:
    """Return the tracks of the flight that matters most, and of the one with the median closest
    approach, if any has a record.

    What matters most is a flight that lost its aircraft, diverged or violated the keep-out area,
    else the closest one. The median is that of all flights that were flown: of those with a record,
    among which is every flight that failed, it would be another. Where the flight at the median has
    none, the one nearest to it takes its place. Without a vessel there is no approach: shown is the
    first flight.
    """
    flown = [(trial, row) for trial in trials for _, row in trial.flown.iterrows()]
    rows = pd.concat([trial.flown for trial in trials])
    recorded, distances = trials[0].run.with_history(rows), clearance(rows)
    near = recorded & np.isfinite(distances)
    if not near.any():
        return _first_recorded(trials)
    # The place of each flight goes with its row.
    matters = by_severity(rows.assign(place=np.arange(len(rows)))[recorded]).iloc[:1]
    telling, first = _TELLING[severity(matters)[0]], int(matters["place"].iloc[0])
    beside = np.flatnonzero(np.isfinite(distances))
    found, median = recorded_at(distances[beside], near[beside], len(beside) // 2)
    typical = int(beside[found])
    chosen = {telling: first} | ({"Typical": typical} if typical != first else {})
    beyond = radii_differ(rows)
    names = {what: name_in_run(*flown[place]) for what, place in chosen.items()}
    shown = [
        (*flown[place], _panel_title(flown[place][1], what, names[what], beyond=beyond))
        for what, place in chosen.items()
    ]
    remark = _shown_words(recorded, names, median=median, beyond=beyond)
    return track_picture(shown, remark=remark * (len(flown) > 1))


def _panel_title(row: "pd.Series[Any]", what: str, name: str, *, beyond: bool) -> str:
    """Return what a flight is shown for, its name unless that is long, and how near it came."""
    distance, radius = float(row["min_distance_m"]), float(row["keepout_radius_m"])
    nearest = f"{approach(distance, radius)} m"
    if beyond:
        nearest = f"{approach(distance - radius, 0.0)} m beyond r_min"
    return f"{what}: {name}, {nearest}" if len(name) <= _NAME_MAX else f"{what}: {nearest}"


def _first_recorded(trials: Sequence[Trial]) -> Chart | None:
    """Return the track of the first flight that has a time history, or None."""
    found = (
        (trial, row)
        for trial in trials
        for _, row in trial.flown.iterrows()
        if trial.run.has_history(str(row["flight_id"]))
    )
    trial, row = next(found, (None, None))
    if trial is None or row is None:
        return None
    several = sum(len(of.flown) for of in trials) > 1
    return track_picture(
        [(trial, row, "")],
        remark=f" {name_in_run(trial, row)}, the first with a time history." * several,
    )


def _shown_words(recorded: Mask, names: Mapping[str, str], *, median: bool, beyond: bool) -> str:
    """Return which flights are shown, whether the typical one is the median, and of what."""
    of = "" if recorded.all() else " of those with a time history"
    what = "least distance beyond its own r_min" if beyond else "closest approach"
    near = (
        f"the one whose {what} is the median"
        if median
        else "of these the one nearest to the median of all flights"
    )
    meanings = {
        **{word: f"a flight that {did}" for word, did in zip(_TELLING, SEVERE, strict=False)},
        "Closest": f"the flight with the {what}{of}",
        "Typical": near,
    }
    return "".join(f" {what}: {name}, {meanings[what]}." for what, name in names.items())
