"""Figures of searches that are made up, so that every one of them is known."""

import math

import numpy as np
import pandas as pd
import pytest

from gnc.mission.mission import Mode
from scenarios.measures.finding import finding_figures
from scenarios.scenario.sections.flight import FlightConfig

STEP, INTERVAL, ORBIT = 0.1, 10.0, 40.0
"""Between samples, between crossings, and until the orbit is reached [s]."""

NOISE = 0.5


def history(*, first=100.0, above=6.0, believed=80.0, deviation=4.0, duration=300.0, altitude=70.0):
    """Return a search that crosses the axis every interval, and detects the plume from ``first`` on
    [s].
    """
    time = STEP * np.arange(round(duration / STEP) + 1)
    across = 50.0 * np.sin(math.pi * time / INTERVAL)
    inside = (np.abs(across) < 5.0) & (time > first - 1.0)
    # Every second crossing misses the middle of the plume.
    fraction = np.where(inside, np.where((time / INTERVAL).round() % 2 == 0, 0.9, 0.3), 0.0)
    co2 = 420.0 + 100.0 * fraction
    frame = {
        "time_s": time,
        "altitude_m": altitude,
        "altitude_command_m": altitude,
        "mode": np.where(time < ORBIT, Mode.APPROACH.number, Mode.SEARCHING.number).astype(float),
        "plume_across_m": across,
        "plume_above_m": above,
        "plume_fraction": fraction,
        "co2_ppm": co2,
        "co2_background_ppm": 420.0,
        "co2_reading_ppm": np.roll(co2, 10),
    }
    if believed is not None:
        frame |= {
            "axis_height_estimated_m": believed,
            "axis_height_deviation_m": deviation,
            "axis_measurable": 0.9,
        }
    return pd.DataFrame(frame)


def figures(made, **limits):
    return finding_figures(made, FlightConfig(**limits), noise=NOISE, stop_reason="")


def test_the_time_to_find_counts_from_the_orbit_to_the_first_reading_of_the_plume():
    row = figures(history())
    assert row["orbit_at_s"] == ORBIT
    # Detected from 99 s on, where the crossing at 100 s begins; the reading is a second late. A
    # sample, and the width of the plume.
    assert row["time_to_find_s"] == pytest.approx(100.0 - ORBIT + 0.8, abs=0.5)
    assert row["found"]


def test_a_reading_of_clean_air_is_no_plume_however_large():
    made = history(first=1e9)
    made.loc[1500:1520, "co2_reading_ppm"] += 50.0
    assert figures(made)["found"] is False


def test_the_height_is_judged_at_the_crossing_nearest_to_three_minutes():
    row = figures(history())
    # Truth: 70 m flown, 6 m above the axis.
    assert row["axis_height_3min_m"] == 64.0
    assert (row["axis_height_error_3min_m"], row["axis_height_deviation_3min_m"]) == (16.0, 4.0)
    assert (row["axis_height_end_m"], row["axis_measurable_end"]) == (80.0, 0.9)
