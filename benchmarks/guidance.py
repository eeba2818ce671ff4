"""Computing time of a step of the guidance, in both compositions, with the search for a plume, and
beside other ships.

Flights are flown and recorded at the rate of the guidance: one beside a steady vessel in still air,
which has the paper's composition, one that follows a plume in wind, by sensors and reports, and
that one again as it searches for its plume, beside a slow and a fast ship. What the guidance was
given in each is then sent to another one, step by step, all in turn for several rounds: it commands
what was flown. A search is compared with a flight that is given its plume, and a flight beside
other ships with one that is alone with its own.
"""

import io
import statistics
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from unittest import mock

import pandas as pd

from benchmarks.vehicle import x8_setup
from common.run_layout import SUMMARY, time_history_path
from gnc.estimation.navigation import MeasuredMotion
from gnc.estimation.vessel import ReportedTarget
from gnc.guidance import Guidance
from gnc.mission.axis import SearchedAxis
from scenarios.engine.task import Task
from scenarios.experiment.requests import Experiment
from scenarios.flight.onboard import OnboardSensing, axis_of
from scenarios.flight_runner import FlightRunner
from scenarios.planning.flight_plan import FlightPlan
from scenarios.planning.spreads import PredictedSpreads
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.equipment import PayloadConfig, VesselReportsConfig
from scenarios.scenario.sections.flight import FlightConfig, StartConfig
from scenarios.scenario.sections.guidance import FollowingConfig
from scenarios.scenario.sections.traffic import TrafficConfig
from scenarios.scenario.sections.world import EmissionConfig, PlumeConfig, VesselConfig, WindConfig
from scenarios.vehicles.vehicle_setup import VehicleSetup

ROUNDS = 9
"""Rounds of the benchmark alone."""

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

_FAR = tuple(
    TrafficConfig(place_m=(1500.0 * (i - 5), side * 5000.0), speed_mps=7.0)
    for side in (-1.0, 1.0)
    for i in range(10)
)
"""Twenty ships, beyond where any of them counts as near."""

BUSY = {
    "all of them far": FOLLOWING.model_copy(update={"traffic": _FAR}),
    "one of them 900 m abeam": FOLLOWING.model_copy(
        update={"traffic": (*_FAR[1:], TrafficConfig(place_m=(0.0, 900.0), speed_mps=7.0))}
    ),
    "one of them 650 m abeam, kept off together with the measured one": FOLLOWING.model_copy(
        update={"traffic": (*_FAR[1:], TrafficConfig(place_m=(-200.0, 650.0), speed_mps=7.0))}
    ),
}

_EVERY = 2
"""Steps between those at which the search gets a position: of a flight that is recorded 10 times a
second [-].
"""

_INTERVAL, _PARCEL = 4, 2
"""Steps between the readings of the fast sniffer, and readings that are passed on together [-]."""

_MOTION = [
    "time_s",
    "north_m",
    "east_m",
    "velocity_north_mps",
    "velocity_east_mps",
    "heading_rate_rad_s",
]
"""Time, and what a guidance that knows its motion exactly is given."""

Measured = Sequence[tuple[float, Any]]
"""Time, and what is measured then, in the form that the guidance takes."""

PlumeReadings = Sequence[tuple[float, tuple[tuple[float, float], ...]] | None]
"""For each step the altitude [m], and times [s] and CO2 [ppm] of the readings that have come; None
where it gets nothing.
"""


def report_guidance(rounds: int, setup: VehicleSetup) -> None:
    """Print the benchmark: medians over rounds, and ratios within a round.

    Parameters
    ----------
    rounds : number of rounds
    setup : of the aircraft
    """
    paper, following = (_flown(scenario, setup)[:2] for scenario in (TRACKING, FOLLOWING))
    pairs = [(_step_time(*paper), _step_time(*following)) for _ in range(rounds)]
    of_paper, of_following = (statistics.median(times) for times in zip(*pairs, strict=True))
    added = statistics.median((b - a) / a for a, b in pairs)
    print(
        f"a step of the guidance: {of_paper:.1f} us in the paper's composition,"
        f" {of_following:.1f} us in the one that follows a"
        f" plume, {100.0 * added:.0f} % more"
    )
    for name, speed in (("slow", 3.0), ("fast", 12.0)):
        predicted, estimated = (
            _flown(searching(speed, plume), setup) for plume in ("predicted", "estimated")
        )
        pairs = [(_step_time(*predicted), _step_time(*estimated)) for _ in range(rounds)]
        without, with_it = (statistics.median(times) for times in zip(*pairs, strict=True))
        ratio = statistics.median(b / a for a, b in pairs)
        print(
            f"  beside a {name} ship: {without:.1f} us without a search, {with_it:.1f} us with"
            f" one, {ratio:.2f} times as long"
        )
    for name, scenario in BUSY.items():
        busy = _flown(scenario, setup)[:2]
        pairs = [(_step_time(*following), _step_time(*busy)) for _ in range(rounds)]
        alone, beside = (statistics.median(times) for times in zip(*pairs, strict=True))
        ratio = statistics.median(b / a for a, b in pairs)
        print(
            f"  beside twenty ships, {name}: {beside:.1f} us, {alone:.1f} us without them,"
            f" {ratio:.2f} times as long"
        )


def searching(vessel_speed: float, plume: str) -> Scenario:
    """Return a flight beside a ship with exhaust, in wind from abeam, whose plume is ``estimated``
    or ``predicted``.
    """
    return FOLLOWING.model_copy(
        update={
            "vessel": VesselConfig(speed_mps=vessel_speed),
            "plume": PlumeConfig(model="fluctuating", source_height_m=35.0),
            "emission": EmissionConfig(ship="container", load=0.6),
            "payload": PayloadConfig.model_validate(
                {"instruments": ("sniffer",), "sensor": "fast"}
            ),
            "following": FollowingConfig.model_validate(
                {"plume": plume, "source_height_m": (20.0, 60.0), "load": (0.2, 0.9)}
            ),
            "flight": FlightConfig.model_validate(
                {**_FLIGHT.model_dump(exclude_unset=True), "altitude_m": 60.0}
            ),
        }
    )


def _flown(scenario: Scenario, setup: VehicleSetup) -> tuple[FlightPlan, Measured, PlumeReadings]:
    """Return the plan of a flight, what its guidance measures at each step, and what a search would
    get.
    """
    work = FlightRunner(
        experiments=(Experiment("bench", scenario),),
        histories=1,
        setup=setup,
        spreads=PredictedSpreads(),
    )
    measured: list[tuple[float, Any]] = []
    read = OnboardSensing.read

    def noted(sensing: OnboardSensing, step: int, at: float, motion: MeasuredMotion) -> Any:
        measured.append((at, read(sensing, step, at, motion)))
        return measured[-1][1]

    with mock.patch.object(OnboardSensing, "read", noted):
        result = work.run(Task(number=0))
    history = pd.read_parquet(
        io.BytesIO(result.files[time_history_path(result.tables[SUMMARY][0]["flight_id"])])
    )
    if not measured:
        # It knows its motion exactly.
        measured = [
            (at, MeasuredMotion(*motion))
            for at, *motion in history[_MOTION].itertuples(index=False, name=None)
        ]
    return work.plan(work.request(Task(number=0))), measured, _plume_readings(history)


def _plume_readings(history: pd.DataFrame) -> PlumeReadings:
    """Return what a search gets at each step of a flight, in parcels as the sniffer passes them."""
    if "co2_reading_ppm" not in history:
        return []
    result: list[tuple[float, tuple[tuple[float, float], ...]] | None] = []
    waiting: list[tuple[float, float]] = []
    for i, (at, altitude, co2) in enumerate(
        history[["time_s", "altitude_m", "co2_reading_ppm"]].itertuples(index=False, name=None)
    ):
        if i % _INTERVAL == 0:
            waiting.append((at, co2))
        parcel = tuple(waiting) if len(waiting) == _PARCEL else ()
        waiting = [] if parcel else waiting
        result.append((altitude, parcel) if i % _EVERY == 0 or parcel else None)
    return result


Reports = list[Any]
"""Reports and the times at which they are received [s], the last one first."""


def _reports(plan: FlightPlan) -> tuple[Reports, list[Reports]]:
    """Return the reports of the measured ship, and those of each of the others."""
    received = [plan.sensing.received, *plan.sensing.traffic] if plan.sensing else [None]
    measured, *others = (list(reversed(of or [])) for of in received)
    return measured, others


def _step_time(plan: FlightPlan, measured: Measured, passed_on: PlumeReadings = ()) -> float:
    """Return the CPU time of a step of a settled flight [us]."""
    guidance, reports = Guidance(plan.guidance), _reports(plan)
    first = next(i for i, (at, _) in enumerate(measured) if at >= SETTLED)
    _step_through(guidance, measured[:first], reports, passed_on[:first])
    began = time.process_time()
    _step_through(guidance, measured[first:], reports, passed_on[first:])
    return 1e6 * (time.process_time() - began) / (len(measured) - first)


def _step_through(
    guidance: Guidance,
    measured: Measured,
    reports: tuple[Reports, list[Reports]],
    passed_on: PlumeReadings,
) -> None:
    target, axis, traffic = guidance.target, axis_of(guidance), guidance.traffic
    own, others = reports
    for i, (at, measurement) in enumerate(measured):
        while own and own[-1][0] <= at and isinstance(target, ReportedTarget):
            target.report(own.pop()[1])
        if traffic is not None and i % guidance.plan_interval == 0:
            for number, received in enumerate(others):
                while received and received[-1][0] <= at:
                    traffic.report(number, received.pop()[1])
        guidance.step(at, measurement)
        passed = passed_on[i] if passed_on else None
        if passed is not None and isinstance(axis, SearchedAxis):
            axis.flown = passed[0]
            axis.take_readings(at, passed[1])


def main() -> None:
    """Print the benchmark alone."""
    with tempfile.TemporaryDirectory() as folder:
        report_guidance(ROUNDS, x8_setup(FOLLOWING, Path(folder))[1])


if __name__ == "__main__":
    main()
