"""Patrols as a study: several ships, one UAV with an endurance, and an oracle to compare with."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, Self

from common.physics.units import SECONDS_PER_HOUR
from common.run_layout import PHASES, SHIPS, SUMMARY
from scenarios.engine.journal import Journal
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import Fly, Progress, StudySummary
from scenarios.engine.task import Row, Task
from scenarios.errors import InputError
from scenarios.schema.scenario import Scenario
from scenarios.studies.flight_study import FlightStudy
from scenarios.studies.patrol.ships import sampled_patrol
from scenarios.studies.patrol.tables import PATROL_COLUMNS, PHASE_COLUMNS, SHIP_COLUMNS
from scenarios.studies.patrol.work import SNIFFER, PatrolWork
from scenarios.studies.study import study

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
    InputError : as of ``FlightStudy``; flights that give no verdict, ships that are not steady, a place to begin at, ships that are
        kept clear of by more than the way to them, or are so near to one another that a flight beside one enters the area of the
        other, an endurance too short for any ship, or ships that find no room
    """

    what = "patrols"
    chooses_flights = True

    def __init__(self, scenario: Scenario, name: str, trials: Mapping[str, Scenario], *, overrides: Sequence[str] = ()) -> None:
        _check(scenario)
        super().__init__(scenario, name, trials, overrides=overrides)
        ((_, self._patrols),) = self.trials.items()
        sampled_patrol(name, self._patrols, 0)
        self.tables = {SUMMARY: PATROL_COLUMNS, SHIPS: SHIP_COLUMNS, PHASES: PHASE_COLUMNS}

    def work(self, run: RunDirectory) -> PatrolWork:
        """Return the work on its patrols, after writing the aircraft's autopilot into the run directory."""
        work = super().work(run)
        return PatrolWork(**{field.name: getattr(work, field.name) for field in fields(work)})

    def run(self, fly: Fly, _run: RunDirectory, _journal: Journal) -> None:
        """Fly every patrol."""
        fly(Task(number=number) for number in range(self.planned))

    def postprocess(self, run: RunDirectory, journal: Journal, progress: Progress) -> None:
        """Write nothing more: everything is in the tables."""

    def summary(self, journal: Journal) -> StudySummary:
        """Return the result so far."""
        counts = PatrolCounts.of(list(journal.rows(SUMMARY)))
        config = self._patrols.patrol
        enough = counts.correct >= config.oracle_share_min * counts.oracle
        right = counts.wrong <= config.wrong_share_max * counts.verdicts
        met = counts.met == self.planned and enough and right and counts.judged
        share = f"{100.0 * counts.correct / counts.oracle:.0f} %" if counts.oracle else "–"
        judged = (
            f"correct verdicts {'meet' if enough else 'fail'} patrol.oracle_share_min, wrong ones {'meet' if right else 'fail'}"
            " patrol.wrong_share_max"
            if counts.judged
            else "no ship was served"
            if not counts.served
            else "no verdict, and none of an oracle: give ships more time (patrol.patience_s, flight.after_settling_s)"
        )
        lines = [
            f"patrols: {self.planned} planned, {counts.done} flown; {counts.served} of {counts.ships} ships served in"
            f" {counts.hours:.3g} h, {counts.per_hour:.2f} an hour",
            f"verdicts: {counts.correct} correct, {counts.wrong} wrong, {counts.open} open; the oracle's: {counts.oracle}"
            f" ({share}, required {100.0 * config.oracle_share_min:g} %)",
            f"keep-out violations: {counts.violations}; patrols that kept out: {counts.kept_out} of {counts.done}",
            *(f"    {row['flight_id']}: {row['message']}" for row in counts.failed),
            f"{f'exit status {int(not met)}: ' if counts.done == self.planned else 'so far '}{counts.met} of {self.planned} patrols"
            f" kept out and brought their aircraft through; {judged}",
        ]
        manifest: dict[str, Any] = {
            "patrols_met": counts.met, "ships_served": counts.served, "verdicts": counts.verdicts, "verdicts_wrong": counts.wrong,
            "oracle_verdicts": counts.oracle,
        }  # fmt: skip
        return StudySummary(done=counts.done, met=met, lines=lines, manifest=manifest | self._sizes())


@dataclass(frozen=True, slots=True, kw_only=True)
class PatrolCounts:
    """Sums over patrols.

    Attributes
    ----------
    done, met, kept_out : patrols that are done, those that kept out with their aircraft, those that kept out
    ships, served, verdicts, correct, wrong, open : ships, those flown beside, and how these flights ended
    oracle : verdicts of an oracle that knows everything
    violations : of keep-out areas
    hours : of all patrols [h]
    failed : rows of patrols that served no ship, did not keep out, or did not come through
    """

    done: int
    met: int
    kept_out: int
    ships: int
    served: int
    verdicts: int
    correct: int
    wrong: int
    open: int
    oracle: int
    violations: int
    hours: float
    failed: Sequence[Row]

    @classmethod
    def of(cls, rows: Sequence[Row]) -> Self:
        """Return the sums over the rows of a summary."""

        def total(name: str) -> int:
            return int(sum(row.get(name, 0) for row in rows))

        return cls(
            done=len(rows),
            met=total("criteria_met"),
            kept_out=total("kept_out"),
            ships=total("ships"),
            served=total("served"),
            verdicts=total("verdicts"),
            correct=total("correct"),
            wrong=total("wrong"),
            open=total("open"),
            oracle=total("oracle_verdicts"),
            violations=total("keepout_violations"),
            hours=sum(row.get("duration_s", 0.0) for row in rows) / SECONDS_PER_HOUR,
            failed=[row for row in rows if row["message"]],
        )

    @property
    def judged(self) -> bool:
        """Whether there is a ship that was served, and a verdict to judge: its own or an oracle's."""
        return self.served > 0 and self.verdicts + self.oracle > 0

    @property
    def per_hour(self) -> float:
        """Return ships served an hour [1/h]."""
        return self.served / self.hours if self.hours else 0.0


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
    placed = sorted({draw.key for draw in scenario.draws} & set(_PLACES) | {key for key in _PLACES if _given(scenario, key)})
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
