"""Run a scenario: design the autopilot, fly every flight in parallel, keep what is done after each."""

import math
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path

from aircraft.errors import AircraftError
from aircraft.spec import AircraftSpec, find_spec
from gnc.oscillation import bank_for_heading_rate
from innerloop.jsbsim_root import write_root
from innerloop.record import design_record
from innerloop.responses import level_trim
from innerloop.schedule import design_schedule
from scenarios.bounds_record import bounds_record
from scenarios.closed_loop import Outcome
from scenarios.config import Scenario
from scenarios.errors import InputError
from scenarios.flights import (
    STUDY,
    FlightRequest,
    FlightResult,
    SixDof,
    failed,
    flight_requests,
    fly_request,
    guidance_lag,
    ignore_interrupt,
)
from scenarios.manifest import opening_manifest
from scenarios.metrics import SUMMARY_COLUMNS, Row
from scenarios.plan import heading_rate_max
from scenarios.run_directory import RunDirectory

CROSSING_COLUMNS = ("flight_id", "variant", "nu", "crossing", "time_s", "axis_distance_m", "distance_m", "angle_deg", "height_m")

Progress = Callable[[str, int, int], None]
"""Called with what is being done, how many flights are done and how many there are."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunResult:
    """How a run ended.

    Attributes
    ----------
    directory : the run directory
    rows : of the study's flights that are done
    planned : number of the study's flights
    interrupted : whether it was stopped before all flights were done
    """

    directory: Path
    rows: list[Row]
    planned: int
    interrupted: bool

    what = "flights"

    @property
    def done(self) -> int:
        """Number of flights that are done."""
        return len(self.rows)

    @property
    def met(self) -> int:
        """Number of flights that completed and met every criterion."""
        return sum(bool(row["criteria_met"]) for row in self.rows)

    @property
    def all_met(self) -> bool:
        """Whether every planned flight did."""
        return self.met == self.planned

    def lines(self) -> list[str]:
        """Return what happened, in lines of text."""
        completed = sum(row["outcome"] == Outcome.COMPLETED.value for row in self.rows)
        entries = sum(int(row.get("keepout_violations", 0)) for row in self.rows)
        return [
            f"{self.planned} flights planned, {len(self.rows)} done: {completed} completed, {self.met} met every criterion;"
            f" {entries} entries into the keep-out area",
            *(f"  {row['flight_id']}: {row['outcome']}: {row['message']}" for row in self.rows if not row["criteria_met"]),
        ]


def run_scenario(
    scenario: Scenario,
    name: str,
    directory: Path,
    *,
    jobs: int,
    resume: bool,
    progress: Progress,
    overrides: Sequence[str] = (),
) -> RunResult:
    """Fly a scenario into ``directory``.

    Parameters
    ----------
    scenario, name : what to fly, and what it is called
    directory : the run directory
    jobs : number of processes
    resume : go on with the unfinished run in ``directory``
    progress : told what happens
    overrides : how the scenario differs from the one of that name, for the record

    Raises
    ------
    InputError : unknown aircraft, or a directory that cannot be used
    """
    requests = flight_requests(scenario)
    spec = _check_aircraft(requests)
    run = RunDirectory(directory)
    manifest = opening_manifest(scenario, name, overrides)
    run.open(manifest["config_hash"], resume=resume)
    ledger = _Ledger(run, requests)
    manifest |= {
        "seeds": {request.flight_id: request.seed for request in requests},
        "variants": {request.flight_id: request.variant for request in requests},
        "flights_planned": sum(request.variant == STUDY for request in requests),
    }
    run.write_json(run.manifest, manifest)
    began = time.perf_counter()
    progress("designing the autopilot" if spec else "flying", len(ledger.done), len(requests))
    interrupted = False
    try:
        six_dof = None
        try:
            six_dof = _design(spec, scenario, run) if spec else None
        except AircraftError as error:
            for request in requests:
                if request.scenario.fidelity == "six_dof" and request.flight_id not in ledger.done:
                    ledger.add(failed(request, Outcome.TRIM_FAILED, str(error)))
        manifest["guidance_lag_s"] = guidance_lag(scenario, six_dof)
        _fly_all([r for r in requests if r.flight_id not in ledger.done], ledger, run.path, six_dof, jobs, progress)
        if scenario.study == "paper":
            progress("bounding commands", len(ledger.done), len(requests))
            run.write_json(run.bounds, bounds_record(requests, scenario.seed))
    except KeyboardInterrupt:
        interrupted = True
    result = RunResult(
        directory=directory,
        rows=ledger.study_rows(),
        planned=manifest["flights_planned"],
        interrupted=interrupted,
    )
    manifest |= {
        "state": "interrupted" if interrupted else "complete",
        "wall_time_s": time.perf_counter() - began,
        "outcomes": {outcome.value: sum(row["outcome"] == outcome.value for row in result.rows) for outcome in Outcome},
        "flights_met_criteria": result.met,
    }
    run.write_json(run.manifest, manifest)
    return result


def _check_aircraft(requests: list[FlightRequest]) -> AircraftSpec | None:
    """Return the aircraft of the flights in six degrees of freedom, if there are any, having checked that it can fly them.

    Raises
    ------
    InputError : unknown aircraft, an airspeed or bank it cannot fly, or flights that differ in what the autopilot is designed for
    """
    flown = [request.scenario for request in requests if request.scenario.fidelity == "six_dof"]
    designs = {(s.aircraft, s.guidance.airspeed_mps, s.plume.source_height_m) for s in flown}
    if not designs:
        return None
    if len(designs) > 1:
        raise InputError("flights differ in aircraft, guidance.airspeed_mps or plume.source_height_m; give each a run of its own")
    scenario = flown[0]
    try:
        spec = find_spec(scenario.aircraft)
    except AircraftError as error:
        raise InputError(f"aircraft: {error}") from None
    envelope, airspeed = spec.envelope, scenario.guidance.airspeed_mps
    if not envelope.airspeed_min <= airspeed <= envelope.airspeed_max:
        raise InputError(
            f"guidance.airspeed_mps is {airspeed:g}; {spec.title} flies {envelope.airspeed_min:g} to {envelope.airspeed_max:g} m/s"
        )
    bank = max(bank_for_heading_rate(heading_rate_max(s), airspeed) for s in flown)
    if bank > envelope.bank_max:
        raise InputError(
            f"guidance asks for {math.degrees(bank):.1f} deg of bank; the autopilot of {spec.title} stops at"
            f" {math.degrees(envelope.bank_max):.0f}: lower guidance.bank_deg or guidance.heading_rate_max_rad_s"
        )
    return spec


def _design(spec: AircraftSpec, scenario: Scenario, run: RunDirectory) -> SixDof:
    """Design the autopilot into the run directory, and return what flights need of it."""
    schedule = design_schedule(spec, altitude=scenario.plume.source_height_m)
    write_root(schedule, run.model)
    design = design_record(schedule, run.model)
    run.write_json(run.innerloop, design)
    start = level_trim(spec, scenario.guidance.airspeed_mps, scenario.plume.source_height_m)
    return SixDof(start=start, lag=float(design["heading_rate_lag_s"]))


class _Ledger:
    """What is done, on disk after every flight."""

    def __init__(self, run: RunDirectory, requests: list[FlightRequest]) -> None:
        self._run = run
        self._order = {request.flight_id: i for i, request in enumerate(requests)}
        self._study = {request.flight_id for request in requests if request.variant == STUDY}
        found = [*run.read_rows("summary.csv"), *run.read_rows("comparison.csv")]
        self._rows = {row["flight_id"]: row for row in found if row.get("flight_id") in self._order}
        self._crossings = [row for row in run.read_rows("crossings.csv") if row.get("flight_id") in self._rows]

    @property
    def done(self) -> set[str]:
        return set(self._rows)

    def study_rows(self) -> list[Row]:
        return self._sorted(study=True)

    def add(self, result: FlightResult) -> None:
        self._rows[result.request.flight_id] = result.row
        self._crossings += result.crossings
        self._crossings.sort(key=lambda row: (self._order[row["flight_id"]], row["crossing"]))
        # The summary last: a flight counts as done when it is in there, and its crossings are on disk by then.
        self._run.write_rows("crossings.csv", self._crossings, CROSSING_COLUMNS)
        if result.request.flight_id in self._study:
            self._run.write_rows("summary.csv", self._sorted(study=True), SUMMARY_COLUMNS)
        else:
            self._run.write_rows("comparison.csv", self._sorted(study=False), SUMMARY_COLUMNS)

    def _sorted(self, *, study: bool) -> list[Row]:
        rows = [row for row in self._rows.values() if (row["flight_id"] in self._study) == study]
        return sorted(rows, key=lambda row: self._order[row["flight_id"]])


def _fly_all(
    requests: list[FlightRequest], ledger: _Ledger, directory: Path, six_dof: SixDof | None, jobs: int, progress: Progress
) -> None:
    total = len(requests) + len(ledger.done)
    pool = ProcessPoolExecutor(max_workers=min(jobs, max(1, len(requests))), initializer=ignore_interrupt)
    futures: dict[Future[FlightResult], FlightRequest] = {}
    try:
        for request in requests:
            needed = six_dof if request.scenario.fidelity == "six_dof" else None
            futures[pool.submit(fly_request, request, directory, needed)] = request
        for future in as_completed(futures):
            ledger.add(_result(future, futures[future]))
            progress("flying", len(ledger.done), total)
    except KeyboardInterrupt:
        pool.shutdown(wait=True, cancel_futures=True)
        for future, request in futures.items():
            if future.done() and not future.cancelled() and request.flight_id not in ledger.done:
                ledger.add(_result(future, request))
        raise
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _result(future: Future[FlightResult], request: FlightRequest) -> FlightResult:
    try:
        return future.result()
    except BrokenProcessPool:
        return failed(request, Outcome.FAILED, "the process that flew it died; run again with --resume and --jobs 1")
