"""Run a scenario: design the autopilot, fly every flight in parallel, keep what is done after each."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from aircraft.errors import AircraftError
from aircraft.find import find_spec
from aircraft.spec import AircraftSpec, Envelope
from innerloop.cache import Designed, designed
from innerloop.flight import AutopilotedAircraft
from innerloop.jsbsim_root import write_root
from innerloop.responses import level_trim
from innerloop.reversal import measure_reversal
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
from scenarios.flyable import check_flyable
from scenarios.ledger import Ledger, Table
from scenarios.manifest import opening_manifest
from scenarios.metrics import SUMMARY_COLUMNS, Row
from scenarios.pool import DIED, Progress, fly_all
from scenarios.run_directory import RunDirectory

CROSSING_COLUMNS = ("flight_id", "variant", "nu", "crossing", "time_s", "axis_distance_m", "distance_m", "angle_deg", "height_m")


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
    study = Table(
        name="summary.csv",
        columns=SUMMARY_COLUMNS,
        flights=frozenset(request.flight_id for request in requests if request.variant == STUDY),
    )
    every = [request.flight_id for request in requests]
    others = Table(name="comparison.csv", columns=SUMMARY_COLUMNS, flights=frozenset(every) - study.flights)
    ledger = Ledger(run, every, tables=[study, others], details={"crossings.csv": CROSSING_COLUMNS})
    manifest |= {
        "seeds": {request.flight_id: request.seed for request in requests},
        "variants": {request.flight_id: request.variant for request in requests},
        "flights_planned": len(study.flights),
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
        _fly_rest(requests, ledger, run.path, six_dof, jobs, progress)
        if scenario.study == "paper":
            progress("bounding commands", len(ledger.done), len(requests))
            run.write_json(run.bounds, bounds_record(requests, scenario.seed))
    except KeyboardInterrupt:
        interrupted = True
    finally:
        ledger.flush()
    result = RunResult(
        directory=directory,
        rows=ledger.rows(study),
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


def _fail_without_design(spec: AircraftSpec, refusal: str, requests: list[FlightRequest], ledger: Ledger) -> None:
    """Make a row with the reason of every flight that a refused design keeps on the ground.

    A kinematic flight needs only an envelope to be fitted to; where the spec has none, that too comes from the design.
    """
    for request in requests:
        lacking = request.scenario.fidelity == "six_dof" or spec.envelope is None
        if lacking and request.flight_id not in ledger.done:
            _add(ledger, failed(request, Outcome.TRIM_FAILED, refusal))


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
    for scenario in flown:
        check_flyable(scenario.guidance, spec.title, envelope)


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


def _fly_rest(
    requests: list[FlightRequest], ledger: Ledger, directory: Path, six_dof: SixDof | None, jobs: int, progress: Progress
) -> None:
    """Fly what is not done yet."""

    def done(result: FlightResult) -> None:
        _add(ledger, result)
        progress("flying", len(ledger.done), len(requests))

    fly_all(
        [request for request in requests if request.flight_id not in ledger.done],
        partial(fly_request, directory=directory, six_dof=six_dof),
        died=lambda request: failed(request, Outcome.FAILED, DIED),
        done=done,
        jobs=jobs,
    )


def _add(ledger: Ledger, result: FlightResult) -> None:
    ledger.add(result.request.flight_id, result.row, {"crossings.csv": result.crossings})
