"""Computing time of a step of the guidance, in both compositions.

Two flights are flown and recorded at the rate of the guidance: one beside a steady vessel in still air, which has the
paper's composition, and one that follows a plume in wind, by sensors and reports. What is measured in each is then sent
to its guidance, step by step, both in turn for several rounds.
"""

import io
import statistics
import time
from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from common.run_layout import SUMMARY, time_history_path
from gnc.compose import compose
from gnc.estimation.target_motion import ReportedTarget
from gnc.guidance import Guidance
from scenarios.engine.task import Task
from scenarios.experiment.requests import Experiment
from scenarios.flight import FlightWork
from scenarios.planning.flight_plan import FlightPlan
from scenarios.planning.spreads import PredictedSpreads
from scenarios.schema.scenario import Scenario
from scenarios.schema.sections.equipment import VesselReportsConfig
from scenarios.schema.sections.flight import FlightConfig, StartConfig
from scenarios.schema.sections.world import VesselConfig, WindConfig
from scenarios.vehicles.vehicle_setup import VehicleSetup

SETTLED = 150.0
"""Time from which steps are timed: the UAV is on its orbit [s]."""

_START = StartConfig(distance_m=(400.0, 500.0), spread_deg=10.0)
_FLIGHT = FlightConfig(crossings=0, duration_max_s=400.0, log_rate_hz=20.0)
_VESSEL = VesselConfig(speed_mps=7.0)

TRACKING = Scenario(title="bench", vessel=_VESSEL, start=_START, flight=_FLIGHT)

FOLLOWING = Scenario(
    title="bench",
    wind=WindConfig(speed_mps=5.0, from_deg=60.0),
    vessel=_VESSEL,
    reports=VesselReportsConfig(interval_s=(2.0, 10.0)),
    start=_START,
    flight=_FLIGHT,
)

Measured = Sequence[tuple[float, Any]]
"""Time, and what is measured then, in the form that the guidance takes."""


def report_guidance(rounds: int, setup: VehicleSetup) -> None:
    """Print the benchmark: medians over rounds, and ratios within a round.

    Parameters
    ----------
    rounds : number of rounds
    setup : of the aircraft
    """
    paper, following = (_flown(scenario, setup) for scenario in (TRACKING, FOLLOWING))
    pairs = [(_step_time(*paper), _step_time(*following)) for _ in range(rounds)]
    of_paper, of_following = (statistics.median(times) for times in zip(*pairs, strict=True))
    added = statistics.median((b - a) / a for a, b in pairs)
    print(
        f"a step of the guidance: {of_paper:.1f} us in the paper's composition, {of_following:.1f} us in the one that follows a"
        f" plume, {100.0 * added:.0f} % more"
    )


def _flown(scenario: Scenario, setup: VehicleSetup) -> tuple[FlightPlan, Measured]:
    """Return the plan of a flight, and what its guidance measures at each step."""
    work = FlightWork(experiments=(Experiment("bench", scenario),), histories=1, setup=setup, spreads=PredictedSpreads())
    plan, result = work.plan(work.request(Task(number=0))), work.fly(Task(number=0))
    history = pd.read_parquet(io.BytesIO(result.files[time_history_path(result.tables[SUMMARY][0]["flight_id"])]))
    names = ["time_s", "north_m", "east_m", "velocity_north_mps", "velocity_east_mps", "heading_rate_rad_s"]
    motions = history[names].itertuples(index=False, name=None)
    if plan.sensing is None or plan.world is None:
        return plan, [(at, motion) for at, *motion in motions]
    wind = plan.world.weather.wind.at(history["time_s"], history["altitude_m"])
    v_north, v_east = (history[f"velocity_{axis}_mps"] - of_air for axis, of_air in zip(("north", "east"), wind, strict=True))
    air_data = zip(history["airspeed_mps"], np.arctan2(v_east, v_north), history["roll_rad"], strict=True)
    return plan, [(at, (place, *read, rate, 0.0)) for (at, *place, rate), read in zip(motions, air_data, strict=True)]


def _reports(plan: FlightPlan) -> list[Any]:
    return list(reversed((plan.sensing.received if plan.sensing else None) or []))


def _step_time(plan: FlightPlan, measured: Measured) -> float:
    """Return the time of a step of a settled flight [us]."""
    guidance, reports = compose(plan.guidance), _reports(plan)
    first = next(i for i, (at, _) in enumerate(measured) if at >= SETTLED)
    _step_through(guidance, measured[:first], reports)
    began = time.perf_counter()
    _step_through(guidance, measured[first:], reports)
    return 1e6 * (time.perf_counter() - began) / (len(measured) - first)


def _step_through(guidance: Guidance, measured: Measured, reports: list[Any]) -> None:
    target = guidance.target
    for at, measurement in measured:
        while reports and reports[-1][0] <= at and isinstance(target, ReportedTarget):
            target.report(reports.pop()[1])
        guidance.step(at, measurement)
