"""Run a scenario: design the autopilot, fly every flight in parallel, keep what is done after each."""

import math
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path

from aircraft.errors import AircraftError
from aircraft.find import find_spec
from aircraft.spec import AircraftSpec, Envelope
from gnc.oscillation import bank_for_heading_rate
from innerloop.cache import Designed, designed
from innerloop.flight import AutopilotedAircraft
from innerloop.jsbsim_root import write_root
from innerloop.responses import level_trim
from innerloop.reversal import measure_reversal
from reports.interrupt import ignore_interrupt
from scenarios.bounds_record import bounds_record
from scenarios.closed_loop import Outcome
from scenarios.config import Scenario
from scenarios.errors import InputError
from scenarios.fitting import fitted
from scenarios.flights import (
    STUDY,
    FlightRequest,
    FlightResult,
    SixDof,
    failed,
    flight_requests,
    fly_request,
    guidance_lag,
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
    run = RunDirectory(directory)
    if not resume:
        run.refuse_taken()
    spec = _aircraft(scenario)
    design, refusal = None, ""
    if spec is not None:
        progress("designing the autopilot", 0, len(scenario.sweep.nu))
        design, refusal = _design(spec, scenario)
        envelope = design.design.schedule.envelope if design else spec.envelope
        scenario = fitted(scenario, envelope) if envelope else scenario
    requests = flight_requests(scenario)
    if design is not None:
        _check_flights(requests, design.design.schedule.spec, design.design.schedule.envelope)
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
    progress("flying", len(ledger.done), len(requests))
    interrupted = False
    try:
        # A kinematic flight is only fitted to the aircraft: it has none of its autopilot, nor its lag.
        six_dof = _six_dof(design, scenario, run) if design and scenario.fidelity != "kinematic" else None
        if refusal and spec is not None:
            _fail_without_design(spec, refusal, requests, ledger)
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


def _aircraft(scenario: Scenario) -> AircraftSpec | None:
    """Return the aircraft that flies the scenario, or that a kinematic flight of it is fitted to; none where there is neither.

    Raises
    ------
    InputError : there is no such aircraft, or it is none for an autopilot
    """
    kinematic_alone = scenario.fidelity == "kinematic"
    if kinematic_alone and scenario.aircraft == Scenario.model_fields["aircraft"].default:
        return None
    try:
        return find_spec(scenario.aircraft)
    except AircraftError as error:
        raise InputError(f"aircraft: {error}") from None


def _design(spec: AircraftSpec, scenario: Scenario) -> tuple[Designed | None, str]:
    """Return the autopilot for a scenario, or nothing and why there is none."""
    try:
        return designed(spec, scenario.plume.source_height_m), ""
    except AircraftError as error:
        return None, str(error)


def _fail_without_design(spec: AircraftSpec, refusal: str, requests: list[FlightRequest], ledger: "_Ledger") -> None:
    """Make a row with the reason of every flight that a refused design keeps on the ground.

    A kinematic flight needs only an envelope to be fitted to; where the spec has none, that too comes from the design.
    """
    for request in requests:
        lacking = request.scenario.fidelity == "six_dof" or spec.envelope is None
        if lacking and request.flight_id not in ledger.done:
            ledger.add(failed(request, Outcome.TRIM_FAILED, refusal))


def _check_flights(requests: list[FlightRequest], spec: AircraftSpec, envelope: Envelope) -> None:
    """Check that the aircraft can fly the flights in six degrees of freedom.

    Raises
    ------
    InputError : an airspeed or bank it cannot fly, or flights that differ in what the autopilot is designed for
    """
    flown = [request.scenario for request in requests if request.scenario.fidelity == "six_dof"]
    if not flown:
        return
    if len({(s.aircraft, s.guidance.airspeed_mps, s.plume.source_height_m) for s in flown}) > 1 or flown[0].aircraft != spec.name:
        raise InputError("flights differ in aircraft, guidance.airspeed_mps or plume.source_height_m; give each a run of its own")
    airspeed = flown[0].guidance.airspeed_mps
    if not envelope.airspeed_min <= airspeed <= envelope.airspeed_max:
        raise InputError(
            f"guidance.airspeed_mps is {airspeed:g}; {spec.title} flies {envelope.airspeed_min:.1f} to"
            f" {envelope.airspeed_max:.1f} m/s: choose an airspeed in between, or leave it out"
        )
    bank = max(bank_for_heading_rate(heading_rate_max(s), airspeed) for s in flown)
    if bank > envelope.bank_max:
        raise InputError(
            f"guidance asks for {math.degrees(bank):.1f} deg of bank; the autopilot of {spec.title} stops at"
            f" {math.degrees(envelope.bank_max):.0f}: lower guidance.bank_deg or guidance.heading_rate_max_rad_s"
        )


def _six_dof(found: Designed, scenario: Scenario, run: RunDirectory) -> SixDof:
    """Write the autopilot into the run directory, and return what flights need of it."""
    schedule = found.design.schedule
    write_root(schedule, run.model)
    run.write_json(run.innerloop, found.record)
    near = schedule.level(schedule.middle)
    start = level_trim(schedule.spec, scenario.guidance.airspeed_mps, scenario.plume.source_height_m, near)
    aircraft = AutopilotedAircraft(schedule.spec, run.model)
    return SixDof(
        start=start,
        lag=float(found.record["heading_rate_lag_s"]),
        reversal=measure_reversal(aircraft, start, schedule.envelope.bank),
        envelope=schedule.envelope,
    )


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
