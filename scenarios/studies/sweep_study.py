"""Scenarios of flights as a study: a sweep of speed ratios with its comparisons, or a list of cases."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from aircraft.spec import AircraftSpec, Envelope
from common.run_layout import COMPARISON, CROSSINGS, SUMMARY
from scenarios.engine.journal import Journal
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import Fly, Progress, StudySummary, write_tables
from scenarios.engine.task import Task
from scenarios.errors import InputError
from scenarios.flights import STUDY, FlightRequest, FlightWork, flight_requests, guidance_lag
from scenarios.metrics.figures import SUMMARY_COLUMNS
from scenarios.planning.limits import check_flyable
from scenarios.planning.scaling import fitted
from scenarios.schema.config import Scenario
from scenarios.studies.manifest import initial_manifest
from scenarios.studies.paper_bounds import bounds_record
from scenarios.studies.summary import FlightCounts
from scenarios.vehicles.six_dof import design_of, six_dof_of, spec_flown

CROSSING_COLUMNS = ("flight_id", "variant", "nu", "crossing", "time_s", "axis_distance_m", "distance_m", "angle_deg", "height_m")


class SweepStudy:
    """The flights of a scenario.

    Parameters
    ----------
    scenario, name : what to fly, and what it is called
    overrides : how the scenario differs from the one of that name, for the record

    Raises
    ------
    InputError : unknown aircraft, or one that cannot fly what is asked of it
    """

    what = "flights"

    def __init__(self, scenario: Scenario, name: str, *, overrides: Sequence[str] = ()) -> None:
        spec = spec_flown(scenario)
        self._design, refusal = design_of(spec, scenario.plume.source_height_m) if spec else (None, "")
        schedule = self._design.design.schedule if self._design else None
        envelope = schedule.envelope if schedule else spec and spec.envelope
        self._scenario = fitted(scenario, envelope) if envelope else scenario
        # A kinematic flight needs only an envelope to be fitted to; where the spec has none, that too comes from the design.
        self._requests = [
            replace(request, refusal=refusal) if request.scenario.fidelity == "six_dof" or not envelope else request
            for request in flight_requests(self._scenario)
        ]
        if schedule:
            _check_flights(self._requests, schedule.spec, schedule.envelope)
        self._manifest = initial_manifest(self._scenario, name, overrides) | {
            "seeds": {request.flight_id: request.seed for request in self._requests},
            "variants": {request.flight_id: request.variant for request in self._requests},
        }
        self.planned = sum(request.variant == STUDY for request in self._requests)
        self.config_hash = str(self._manifest["config_hash"])
        self.tables = {SUMMARY: SUMMARY_COLUMNS, CROSSINGS: CROSSING_COLUMNS}
        if self.planned < len(self._requests):
            self.tables[COMPARISON] = SUMMARY_COLUMNS

    def initial_manifest(self) -> dict[str, Any]:
        """Return what the manifest says before anything has been flown."""
        return self._manifest | {"flights_planned": self.planned}

    def work(self, run: RunDirectory) -> FlightWork:
        """Return the flying of its flights, with the aircraft's autopilot written into the run directory."""
        g, height = self._scenario.guidance, self._scenario.plume.source_height_m
        # A kinematic flight is only fitted to the aircraft: it has none of its autopilot, nor its lag.
        flown = self._design if self._scenario.fidelity != "kinematic" else None
        six_dof = six_dof_of(flown, airspeed=g.airspeed_mps, altitude=height, run=run) if flown else None
        self._manifest["guidance_lag_s"] = guidance_lag(self._scenario, six_dof)
        return FlightWork(
            requests=tuple(self._requests),
            histories=self._scenario.histories,
            six_dof=six_dof,
            model=run.model if six_dof else None,
        )

    def run(self, fly: Fly, _run: RunDirectory, _journal: Journal) -> None:
        """Have every flight flown."""
        fly(Task(number=i) for i in range(len(self._requests)))

    def postprocess(self, run: RunDirectory, _journal: Journal, progress: Progress) -> None:
        """Bound the commands of the paper's flights."""
        if self._scenario.study == "paper":
            progress("bounding commands", self.planned, self.planned)
            run.write_json(run.bounds, bounds_record(self._requests, self._scenario.seed))

    def export(self, run: RunDirectory, journal: Journal) -> None:
        """Write its tables."""
        write_tables(run, journal, self.tables)

    def summary(self, journal: Journal) -> StudySummary:
        """Return what the flights have come to."""
        counts = FlightCounts.of(journal.rows(SUMMARY), self.planned)
        head = (
            f"{self.planned} flights planned, {counts.done} done: {counts.completed} completed, {counts.met} met every criterion;"
            f" {counts.keepout_violations} keep-out violations"
        )
        manifest = counts.manifest() | {"guidance_lag_s": self._manifest.get("guidance_lag_s")}
        return StudySummary(
            done=counts.done, met=counts.met == self.planned, lines=[head, *counts.failed_lines("  ")], manifest=manifest
        )


def _check_flights(requests: Sequence[FlightRequest], spec: AircraftSpec, envelope: Envelope) -> None:
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
