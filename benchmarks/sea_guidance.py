"""Computing time that wind, estimators, filter and keep-out guard add to a step of the guidance.

One flight is flown and recorded at the rate of the guidance. Its sensor values are then sent, step by step and in turn
for several rounds, to the guidance for calm air (course and speed from the velocity, steering law, airspeed trim; no guard)
and to the guidance for operational conditions.
"""

import copy
import io
import math
import statistics
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd

from common.run_layout import SUMMARY, time_history_path
from gnc.sea_guidance import SeaGuidance
from gnc.tracker import Guidance
from scenarios.engine.task import Task
from scenarios.planning.sea_planner import SeaPlan, plan_sea_flight
from scenarios.schema.sea_config import Reports, SeaFlight, SeaScenario, SeaStart, SeaVessel, Wind
from scenarios.sea_flights import SeaWork, Trial
from scenarios.vehicles.sea_airframe import airframe_for

SETTLED = 150.0
"""Time from which steps are timed: the UAV is on its orbit [s]."""

SCENARIO = SeaScenario(
    title="bench",
    wind=Wind(speed_mps=5.0, from_deg=60.0),
    vessel=SeaVessel(speed_mps=7.0),
    reports=Reports(interval_s=(2.0, 10.0)),
    start=SeaStart(distance_m=(400.0, 500.0), spread_deg=10.0),
    flight=SeaFlight(crossings=0, duration_max_s=400.0, log_rate_hz=20.0),
)

Sensed = tuple[float, tuple[float, float, float, float], float, float, float, float]
"""Arguments of ``SeaGuidance.step``: time, position and velocity, airspeed, heading, roll, heading rate."""


def report_sea_guidance(rounds: int) -> None:
    """Print the benchmark: medians over rounds, and ratios within a round."""
    with tempfile.TemporaryDirectory() as folder:
        airframe = airframe_for(SCENARIO, Path(folder))
        work = SeaWork(trials=(Trial(name="bench", scenario=SCENARIO, spreads={}),), histories=1, airframe=airframe)
        flown = work.fly(Task(number=0))
        row = flown.tables[SUMMARY][0]
        history = pd.read_parquet(io.BytesIO(flown.files[time_history_path(row["flight_id"])]))
        plans = [
            plan_sea_flight(SCENARIO, flight_id="bench", seed=row["seed"], airframe=airframe, spreads={}) for _ in range(rounds)
        ]
    sensed = _sensed(history, plans[0])
    pairs = [_round(plan, sensed) for plan in plans]
    calm, sea = (statistics.median(times) for times in zip(*pairs, strict=True))
    added = statistics.median((b - a) / a for a, b in pairs)
    print(f"a step of the guidance: {calm:.1f} us in calm air, {sea:.1f} us in operational conditions, {100.0 * added:.0f} % more")


def _sensed(history: pd.DataFrame, plan: SeaPlan) -> list[Sensed]:
    through_air = [history[f"velocity_{axis}_mps"] - wind for axis, wind in zip(("north", "east"), plan.weather.wind, strict=True)]
    heading = np.arctan2(through_air[1], through_air[0])
    names = [
        "time_s",
        "north_m",
        "east_m",
        "velocity_north_mps",
        "velocity_east_mps",
        "airspeed_mps",
        "roll_rad",
        "heading_rate_rad_s",
    ]
    rows = history[names].assign(heading=heading).itertuples(index=False, name=None)
    return [(t, (n, e, v_n, v_e), airspeed, psi, roll, rate) for t, n, e, v_n, v_e, airspeed, roll, rate, psi in rows]


def _round(plan: SeaPlan, sensed: list[Sensed]) -> tuple[float, float]:
    """Return the time of a step in calm air and in operational conditions [us]."""
    guidance = SeaGuidance(plan.guidance, plan.vessel_filter, plan.guard)
    heard = list(reversed(plan.heard or []))
    first = next(i for i, step in enumerate(sensed) if step[0] >= SETTLED)
    _fly_sea(guidance, heard, sensed[:first])
    began = time.perf_counter()
    _fly_sea(guidance, heard, sensed[first:])
    sea = time.perf_counter() - began
    trimmed = replace(plan.guidance.guidance, airspeed_gain=0.15, airspeed_trim_max=1.0)
    calm_guidance = Guidance(trimmed, copy.copy(guidance.reference))
    began = time.perf_counter()
    for _, (north, east, v_north, v_east), _, _, _, rate in sensed[first:]:
        calm_guidance.step(north, east, math.atan2(v_east, v_north), math.sqrt(v_north**2 + v_east**2), rate)
    calm = time.perf_counter() - began
    scale = 1e6 / (len(sensed) - first)
    return calm * scale, sea * scale


def _fly_sea(guidance: SeaGuidance, heard: list, sensed: list[Sensed]) -> None:
    for step in sensed:
        while heard and heard[-1][0] <= step[0]:
            guidance.vessel.report(heard.pop()[1])
        guidance.step(*step)
