"""How soon a plume was found, how well its height was known, and how often it was hit from then
on.
"""

import math

import numpy as np
import numpy.typing as npt
import pandas as pd

from gnc.mission.mission import Mode
from measurement.plume.fluctuating_plume import FOUND_WITHIN, HIT, passes
from scenarios.engine.task import Row
from scenarios.scenario.sections.flight import FlightConfig

Array = npt.NDArray[np.float64]

TRUE_CO2 = "co2_ppm"
"""Column of what was in the air along the path, of a simulated sniffer."""

SIGNAL_TO_NOISE = 5.0
"""Of a reading, from which the plume counts as detected [-] (Kattner 2015, of CO2)."""

KNOWN_AFTER = 180.0
"""Time on the orbit after which the height of the axis is judged [s]."""

_BASE_WINDOW, _BASE_QUANTILE = 60.0, 0.25
"""Stretch of readings, and quantile of them, that are taken for clean air [s, -]."""

_MEMORY = 10.0
"""Time after which what is read no longer comes from the plume that was flown through [s]."""

_BELIEFS = ("axis_height_estimated_m", "axis_height_deviation_m", "axis_measurable")


def finding_figures(
    history: pd.DataFrame, flight: FlightConfig, *, noise: float, stop_reason: str
) -> Row:
    """Measure the search of a flight with a sniffer.

    Parameters
    ----------
    history : of the flight, with the columns of its sniffer
    flight : its limits of the altitude
    noise : standard deviation of a reading of CO2 [ppm]
    stop_reason : why it left early, or an empty text
    """
    time, altitude = (
        np.asarray(history[name], dtype=np.float64) for name in ("time_s", "altitude_m")
    )
    commanded = np.asarray(history["altitude_command_m"], dtype=np.float64)
    # A vehicle with a fault is commanded to sink.
    outside = ((altitude < flight.altitude_min_m) | (altitude > flight.altitude_max_m)) & (
        commanded > 0.0
    )
    step = float(time[1] - time[0]) if len(time) > 1 else 0.0
    row: Row = {
        "altitude_outside_s": step * float(np.count_nonzero(outside)),
        "enough": stop_reason,
    }
    on_orbit = np.flatnonzero(np.asarray(history["mode"]) != Mode.APPROACH.number)
    row |= _beliefs_at_end(history)
    if not len(on_orbit):
        return row
    begins = float(time[on_orbit[0]])
    detected = np.flatnonzero(_detected(history, noise, step) & (time >= begins))
    found_at = float(time[detected[0]]) if len(detected) else math.inf
    to_find = found_at - begins
    row |= {"orbit_at_s": begins, "found": to_find <= FOUND_WITHIN}
    row |= (
        {"time_to_find_s": to_find, "hit_rate_found": _hit_rate(history, time >= found_at)}
        if len(detected)
        else {}
    )
    return row | _height_known(history, time, begins + KNOWN_AFTER)


def _detected(history: pd.DataFrame, noise: float, step: float) -> npt.NDArray[np.bool_]:
    """Return the samples at which the reading shows the plume and the UAV was in the plume shortly
    before.
    """
    reading = history["co2_reading_ppm"]
    base = reading.rolling(max(1, round(_BASE_WINDOW / step)), min_periods=1, center=True).quantile(
        _BASE_QUANTILE
    )
    there = (
        (history[TRUE_CO2] - history["co2_background_ppm"])
        .rolling(max(1, round(_MEMORY / step)), min_periods=1)
        .max()
    )
    return np.asarray((reading - base > SIGNAL_TO_NOISE * noise) & (there > noise), dtype=np.bool_)


def _hit_rate(history: pd.DataFrame, since: npt.NDArray[np.bool_]) -> float:
    """Return the share of passes that hit the plume [-]."""
    across, fraction = (
        np.asarray(history[name][since], dtype=np.float64)
        for name in ("plume_across_m", "plume_fraction")
    )
    hits = [float(np.max(fraction[at])) > HIT for at in passes(across)]
    return float(np.mean(hits)) if hits else math.nan


def _height_known(history: pd.DataFrame, time: Array, at: float) -> Row:
    """Return the estimated height of the axis at the crossing nearest to a time [s], and the true
    one.
    """
    across, above = (
        np.asarray(history[name], dtype=np.float64) for name in ("plume_across_m", "plume_above_m")
    )
    crossed = np.flatnonzero(across[:-1] * across[1:] < 0.0)
    if not len(crossed) or time[-1] < at:
        return {}
    i = int(crossed[np.argmin(np.abs(time[crossed] - at))])
    truth = float(history["altitude_m"].iloc[i] - above[i])
    row: Row = {"axis_height_3min_m": truth}
    if _BELIEFS[0] in history:
        believed, deviation = (float(history[name].iloc[i]) for name in _BELIEFS[:2])
        row |= {
            "axis_height_error_3min_m": believed - truth,
            "axis_height_deviation_3min_m": deviation,
        }
    return row


def _beliefs_at_end(history: pd.DataFrame) -> Row:
    if _BELIEFS[0] not in history:
        return {}
    names = ("axis_height_end_m", "axis_deviation_end_m", "axis_measurable_end")
    return {name: float(history[of].iloc[-1]) for name, of in zip(names, _BELIEFS, strict=True)}
