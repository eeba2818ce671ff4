"""Patrols as a study: several ships, one UAV with an endurance, and an oracle to compare with."""

from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Any

from common.patrols import PatrolCounts
from common.run_layout import PHASES, SHIPS, SUMMARY
from common.verdict import RunVerdict
from scenarios.engine.journal import Journal
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import Fly, Progress, StudySummary
from scenarios.engine.task import Task
from scenarios.errors import InputError
from scenarios.scenario.scenario import Scenario
from scenarios.studies.base import FlightStudy, study
from scenarios.studies.patrol.ships import sampled_patrol
from scenarios.studies.patrol.tables import PATROL_COLUMNS, PHASE_COLUMNS, SHIP_COLUMNS
from scenarios.studies.patrol.work import SNIFFER, PatrolWork

_PLACES = ("start.aspect_deg", "start.place_m", "start.range_m")
"""Keys of a place to begin at."""


@study("patrol")
class PatrolStudy(FlightStudy):
    """Patrols, each a task: ships that are sampled, and flights beside them one after the other.

    Parameters
    ----------
    scenario, name : the patrols, and their name
    trials : the same by its name
    overrides : overrides that were applied, recorded in the manifest

    Raises
    ------
    InputError : as of ``FlightStudy``; flights that give no verdict, ships that are not steady, a
        place to begin at, ships that are kept clear of by more than the way to them, or are so near
        to one another that a flight beside one enters the area of the other, an endurance too short
        for any ship, or ships that find no room
    """

    what = "patrols"
    chooses_flights = True

    def __init__(
        self,
        scenario: Scenario,
        name: str,
        trials: Mapping[str, Scenario],
        *,
        overrides: Sequence[str] = (),
    ) -> None:
        _check(scenario)
        super().__init__(scenario, name, trials, overrides=overrides)
        ((_, self._patrols),) = self.trials.items()
        sampled_patrol(name, self._patrols, 0)
        self.tables = {SUMMARY: PATROL_COLUMNS, SHIPS: SHIP_COLUMNS, PHASES: PHASE_COLUMNS}

    def work(self, run: RunDirectory) -> PatrolWork:
        """Return the work on its patrols, after writing the aircraft's autopilot into the run
        directory.
        """
        work = super().work(run)
        return PatrolWork(**{field.name: getattr(work, field.name) for field in fields(work)})

    def run(self, fly: Fly, _run: RunDirectory, _journal: Journal) -> None:
        """Fly every patrol."""
        fly(Task(number=number) for number in range(self.planned))

    def postprocess(self, run: RunDirectory, journal: Journal, progress: Progress) -> None:
        """Write nothing more: everything is in the tables."""

    def summary(self, journal: Journal) -> StudySummary:
        """Return the result so far."""
        rows, config = list(journal.rows(SUMMARY)), self._patrols.patrol
        counts = PatrolCounts.of(
            rows,
            planned=self.planned,
            oracle_share_min=config.oracle_share_min,
            wrong_share_max=config.wrong_share_max,
        )
        share = f"{100.0 * counts.correct / counts.oracle:.0f} %" if counts.oracle else "–"
        enough, right = ("meet" if of else "fail" for of in (counts.enough, counts.right))
        judged = (
            f"correct verdicts {enough} patrol.oracle_share_min, wrong ones {right} patrol.wrong_share_max"
            if counts.judged
            else "no ship was served"
            if not counts.served
            else "no verdict, and none of an oracle: give ships more time (patrol.patience_s, flight.after_settling_s)"
        )
        ended = f"exit status {int(not counts.met)}: " if counts.done == self.planned else "so far "
        lines = [
            f"patrols: {self.planned} planned, {counts.done} flown; {counts.served} of {counts.ships} ships served in"
            f" {counts.hours:.3g} h, {counts.per_hour:.2f} an hour",
            f"verdicts: {counts.correct} correct, {counts.wrong} wrong, {counts.open} open; the oracle's: {counts.oracle}"
            f" ({share}, required {100.0 * config.oracle_share_min:g} %)",
            f"keep-out violations: {counts.violations}; patrols that kept out: {counts.kept_out} of {counts.done}",
            *(f"    {row['flight_id']}: {row['message']}" for row in rows if row["message"]),
            f"{ended}{counts.through} of {self.planned} patrols kept out and brought their aircraft through; {judged}",
        ]
        manifest: dict[str, Any] = {
            "patrols_met": counts.through, "ships_served": counts.served, "verdicts": counts.verdicts,
            "verdicts_wrong": counts.wrong, "oracle_verdicts": counts.oracle,
        }  # fmt: skip
        verdict = RunVerdict.of_items(
            self.what,
            planned=self.planned,
            done=counts.done,
            met=counts.through,
            required_met=counts.met,
        )
        return StudySummary(verdict=verdict, lines=lines, manifest=manifest | self._sizes())


def _given(scenario: Scenario, key: str) -> bool:
    """Return whether a key of the section ``start`` has a value."""
    return getattr(scenario.start, key.removeprefix("start.")) is not None


def _check(scenario: Scenario) -> None:
    """Refuse what is no patrol."""
    if scenario.vessel.from_file or scenario.vessel.manoeuvres or scenario.wind.table is not None:
        raise InputError(
            "study is 'patrol' beside vessel.manoeuvres, a vessel.track from a file or wind.table; ships and wind of a patrol are"
            " steady: remove them"
        )
    if scenario.flight.until != "verdict" or SNIFFER not in scenario.payload.instruments:
        raise InputError(
            f"flight.until is '{scenario.flight.until}' and payload.instruments {list(scenario.payload.instruments)}; a patrol goes"
            " on after a verdict: set flight.until to 'verdict', and put 'sniffer' into payload.instruments"
        )
    placed = sorted(
        {draw.key for draw in scenario.draws} & set(_PLACES)
        | {key for key in _PLACES if _given(scenario, key)}
    )
    if placed:
        raise InputError(
            f"study is 'patrol' beside {' and '.join(placed)}; a flight beside a ship begins where the way to her ends,"
            " start.distance_m away: remove them"
        )
    config, reach = scenario.patrol, scenario.start.distance_m[1]
    if scenario.keepout.radius_m + config.clearance_m > reach:
        raise InputError(
            f"keepout.radius_m and patrol.clearance_m are {scenario.keepout.radius_m + config.clearance_m:g} m together, more than"
            f" start.distance_m, whose end is {reach:g} m and where the way to a ship ends: no ship can be served; give less"
        )
    if config.separation_m < (apart := reach + scenario.keepout.radius_m):
        raise InputError(
            f"patrol.separation_m is {config.separation_m:g} m; a flight beside a ship is up to {reach:g} m from her, the end of"
            f" start.distance_m, and may not come within keepout.radius_m, {scenario.keepout.radius_m:g} m, of another: give"
            f" {apart:g} m or more"
        )
    if config.endurance_s < config.service_s:
        raise InputError(
            f"patrol.endurance_s is {config.endurance_s:g} s, too short for any ship, which takes patrol.service_s ="
            f" {config.service_s:g} s; give more"
        )
