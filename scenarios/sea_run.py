"""Run trials over the real sea: design the autopilot, draw and fly every flight in parallel, keep what is done as it goes."""

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from aircraft.faults import fault_names
from aircraft.fdm import Fdm
from aircraft.find import find_spec
from aircraft.spec import AircraftSpec, Envelope
from aircraft.turbulence import TURBULENCE
from aircraft.units import METRES_PER_FOOT
from gnc.sea_parameters import Mode
from innerloop.cache import Designed
from innerloop.dryden import low_altitude_turbulence
from scenarios.closed_loop import Outcome
from scenarios.errors import InputError
from scenarios.fitting import fitted
from scenarios.flyable import check_flyable
from scenarios.keepout_margin import tracking_spread
from scenarios.ledger import Ledger, Row, Table
from scenarios.load import load_study
from scenarios.manifest import config_hash, opening_manifest, parameters
from scenarios.pool import DIED, Progress, fly_all
from scenarios.run_directory import RunDirectory
from scenarios.sea_airframe import Airframe, airframe_of, design_for
from scenarios.sea_config import SeaScenario, SeaTrial
from scenarios.sea_draws import check_draws
from scenarios.sea_flights import DETAILS, SeaRequest, SeaResult, fly_sea_request, sea_failed
from scenarios.sea_margin import SpreadTable
from scenarios.sea_metrics import SEA_SUMMARY_COLUMNS
from scenarios.sea_parameters import oscillation_at, speed_hold, tracking_parameters
from scenarios.sea_world import SATELLITES, VESSEL_DATA


@dataclass(frozen=True, slots=True, kw_only=True)
class SeaRunResult:
    """How a run ended.

    Attributes
    ----------
    directory : the run directory
    rows : of the flights that are done
    trials : number of planned flights, by trial
    interrupted : whether it was stopped before all flights were done
    """

    directory: Path
    rows: list[Row]
    trials: dict[str, int]
    interrupted: bool

    what = "flights"

    @property
    def planned(self) -> int:
        """Number of flights that were planned."""
        return sum(self.trials.values())

    @property
    def done(self) -> int:
        """Number of flights that are done."""
        return len(self.rows)

    @property
    def all_met(self) -> bool:
        """Whether every planned flight met what its trial asks for."""
        return sum(bool(row["criteria_met"]) for row in self.rows) == self.planned

    def lines(self) -> list[str]:
        """Return what happened, in lines of text."""
        lines = [f"{self.planned} flights planned, {self.done} done"]
        for trial, planned in self.trials.items():
            rows = [row for row in self.rows if row["trial"] == trial]
            met = sum(bool(row["criteria_met"]) for row in rows)
            entries = sum(int(row.get("keepout_violations") or 0) for row in rows)
            nearest = min((float(row["min_distance_m"]) for row in rows if "min_distance_m" in row), default=math.nan)
            kept = f"{entries} entries into the keep-out area" + ("" if math.isnan(nearest) else f", nearest {nearest:.1f} m")
            lines.append(f"  {trial}: {met} of {planned} met every criterion; {kept}")
        unmet = [row for row in self.rows if not row["criteria_met"]]
        lines += [f"    {row['flight_id']}: {row['outcome']}: {row['message']}" for row in unmet[:_SHOWN]]
        if len(unmet) > _SHOWN:
            lines.append(f"    and {len(unmet) - _SHOWN} more, in summary.csv")
        return lines


SPREAD_RATIOS = (0.1, 0.3, 0.5, 0.7, 0.9)
"""Speed ratios at which the spread is predicted [-]; it hardly depends on them."""

_SHOWN = 20
"""Flights that are named on the console, at most."""


def run_sea(
    study: SeaScenario | SeaTrial,
    name: str,
    directory: Path,
    *,
    jobs: int,
    resume: bool,
    progress: Progress,
    overrides: Sequence[str] = (),
) -> SeaRunResult:
    """Fly a trial, or a list of them, into ``directory``.

    Parameters
    ----------
    study, name : what to fly, and what it is called
    directory : the run directory
    jobs : number of processes
    resume : go on with the unfinished run in ``directory``
    progress : told what happens
    overrides : how the study differs from the one of that name, for the record

    Raises
    ------
    InputError : an unknown trial, aircraft or fault, a key that cannot be drawn, or a directory that cannot be used
    """
    run = RunDirectory(directory)
    if not resume:
        run.refuse_taken()
    trials = _trials(study, name)
    first = next(iter(trials.values()))
    progress("designing the autopilot", 0, sum(scenario.flights for scenario in trials.values()))
    design, refusal = design_for(first)
    envelope = design.design.schedule.envelope if design else None
    if envelope is not None:
        trials = {trial: fitted(scenario, envelope) for trial, scenario in trials.items()}
    _check(trials, envelope)
    manifest = opening_manifest(study, name, overrides)
    # A list of trials does not change with what it lists.
    manifest |= {
        "config_hash": config_hash(study, *trials.values()),
        "study": "sea",
        "trials": {trial: scenario.model_dump(mode="json") for trial, scenario in trials.items()},
        "modes": [mode.value for mode in Mode],
        "trial_parameters": {trial: parameters(scenario) for trial, scenario in trials.items()},
    }
    run.open(manifest["config_hash"], resume=resume)
    every = [_flight_id(trial, i) for trial, scenario in trials.items() for i in range(scenario.flights)]
    table = Table(name="summary.csv", columns=SEA_SUMMARY_COLUMNS, flights=frozenset(every))
    ledger = Ledger(run, every, tables=[table], details=DETAILS)
    manifest["flights_planned"] = len(every)
    run.write_json(run.manifest, manifest)
    began = time.perf_counter()
    progress("flying", len(ledger.done), len(every))
    interrupted = False
    try:
        # Of a trial that has been fitted to the aircraft: its airspeed is where flights start.
        airframe = airframe_of(next(iter(trials.values())), design, run)
        requests = _requests(trials, {trial: _spreads(scenario, design, airframe) for trial, scenario in trials.items()})
        for request in requests:
            if refusal and request.flight_id not in ledger.done:
                _add(ledger, sea_failed(request, Outcome.TRIM_FAILED, refusal))
        _fly_rest(requests, ledger, run.path, airframe, jobs, progress)
    except KeyboardInterrupt:
        interrupted = True
    finally:
        ledger.flush()
    rows = ledger.rows(table)
    result = SeaRunResult(
        directory=directory,
        rows=rows,
        trials={trial: scenario.flights for trial, scenario in trials.items()},
        interrupted=interrupted,
    )
    manifest |= {
        "state": "interrupted" if interrupted else "complete",
        "wall_time_s": time.perf_counter() - began,
        "outcomes": {outcome.value: sum(row["outcome"] == outcome.value for row in rows) for outcome in Outcome},
        "flights_met_criteria": sum(bool(row["criteria_met"]) for row in rows),
    }
    run.write_json(run.manifest, manifest)
    return result


def _trials(study: SeaScenario | SeaTrial, name: str) -> dict[str, SeaScenario]:
    """Return the trials of a study by name.

    Raises
    ------
    InputError : a listed one does not exist, or is none, or two have one name
    """
    if isinstance(study, SeaScenario):
        return {name: study}
    seed = [] if study.seed is None else [f"seed={study.seed}"]
    trials = {}
    for listed in study.trials:
        trial = load_study(listed, [*study.set, *seed])
        if not isinstance(trial, SeaScenario):
            raise InputError(f"trials: '{listed}' is a study of {trial.study}; list trials over the real sea")
        if Path(listed).stem in trials:
            raise InputError(f"trials: two are called '{Path(listed).stem}'; list each once, and give files names of their own")
        flights = math.ceil(study.share * trial.flights)
        trials[Path(listed).stem] = trial.model_copy(update={"flights": flights})
    return trials


def _flight_id(trial: str, number: int) -> str:
    return f"{trial}_{number:05d}"


def _requests(trials: dict[str, SeaScenario], spreads: dict[str, SpreadTable | None]) -> list[SeaRequest]:
    return [
        SeaRequest(flight_id=_flight_id(trial, i), trial=trial, scenario=scenario, number=i, spreads=spreads[trial])
        for trial, scenario in trials.items()
        for i in range(scenario.flights)
    ]


def _check(trials: dict[str, SeaScenario], envelope: Envelope | None) -> None:
    """Check what can be checked before anything is flown.

    Raises
    ------
    InputError : trials that differ in what the autopilot is designed for, an airspeed or a bank that the aircraft cannot fly, a
        fault that it cannot have, a key that cannot be drawn
    """
    apart = {(s.aircraft, s.fidelity, s.guidance.airspeed_mps, s.plume.source_height_m) for s in trials.values()}
    if len(apart) > 1:
        raise InputError(
            "trials differ in aircraft, fidelity, guidance.airspeed_mps or plume.source_height_m; give each a run of its own"
        )
    for trial, scenario in trials.items():
        if envelope is not None and scenario.fidelity == "six_dof":
            check_flyable(scenario.guidance, scenario.aircraft, envelope)
        kinds = {scenario.fault.kind}
        for draw in scenario.draws:
            kinds |= {str(kind) for kind in draw.choice or ()} if draw.key == "fault.kind" else set()
        known = {"none", VESSEL_DATA, SATELLITES}
        if scenario.fidelity == "six_dof":
            known |= set(fault_names(find_spec(scenario.aircraft)))
        for kind in sorted(kinds - known):
            raise InputError(f"fault.kind is '{kind}'; what can fail is {', '.join(sorted(known))}")
        check_draws(trial, scenario)


def _spreads(scenario: SeaScenario, found: Designed | None, airframe: Airframe) -> SpreadTable | None:
    """Return the predicted spread of the tracking error in a trial's turbulence, if it has any."""
    level = scenario.turbulence.level
    if level == "none" or found is None or scenario.fidelity == "kinematic":
        return None
    schedule = found.design.schedule
    air = low_altitude_turbulence(scenario.plume.source_height_m, TURBULENCE[level].wind_at_20ft)
    guidance, hold = tracking_parameters(scenario, airframe), speed_hold(scenario, airframe)
    spreads = [
        tracking_spread(schedule, air, oscillation_at(scenario, nu), guidance, hold, span=_span(schedule.spec))
        for nu in SPREAD_RATIOS
    ]
    return SpreadTable(speed_ratios=SPREAD_RATIOS, spreads=tuple(spreads))


def _span(spec: AircraftSpec) -> float:
    """Return the wing's span [m]."""
    return Fdm(spec).read("metrics/bw-ft") * METRES_PER_FOOT


def _fly_rest(
    requests: list[SeaRequest], ledger: Ledger, directory: Path, airframe: Airframe, jobs: int, progress: Progress
) -> None:
    """Fly what is not done yet."""

    def done(result: SeaResult) -> None:
        _add(ledger, result)
        progress("flying", len(ledger.done), len(requests))

    fly_all(
        [request for request in requests if request.flight_id not in ledger.done],
        partial(fly_sea_request, directory=directory, airframe=airframe),
        died=lambda request: sea_failed(request, Outcome.FAILED, DIED),
        done=done,
        jobs=jobs,
    )


def _add(ledger: Ledger, result: SeaResult) -> None:
    ledger.add(result.flight_id, result.row, result.details)
