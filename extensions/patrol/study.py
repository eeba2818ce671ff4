"""Patrols as a study: several ships, one UAV with an endurance, and an oracle to compare with.

A patrol is a task. Ships are served one after the other, each by a flight of the closed loop. Then
a further flight beside each ship knows the plume's axis; the oracle's order follows from these
flights.
"""

import io
import math
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from common.run_layout import HISTORY_SUFFIX, SUMMARY
from common.verdict import RunVerdict
from extensions.patrol import PHASES, SHIPS
from extensions.patrol.counts import PatrolCounts
from extensions.patrol.keys import PatrolKeys
from extensions.patrol.order import Prospect, best_order, ends_of
from extensions.patrol.route import Air, Leg, Mover, nearest_on, route
from extensions.patrol.ships import Patrol, sampled_patrol
from extensions.patrol.tables import (
    APPROACH,
    LEAVING,
    LOST,
    MEASURING,
    PATROL_COLUMNS,
    PHASE_COLUMNS,
    SEARCHING,
    SHIP_COLUMNS,
    TRANSIT,
    patrol_figures,
    phase_row,
    ship_row,
    verdict_of,
    wind_row,
)
from gnc.mission.mission import Mode
from scenarios.engine.journal import Journal
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import Fly, Progress, StudySummary
from scenarios.engine.task import Result, Row, Task
from scenarios.errors import InputError
from scenarios.experiment.requests import Experiment
from scenarios.flight.ending import failure
from scenarios.flight.outcome import Outcome
from scenarios.flight_runner import FlightRunner
from scenarios.scenario.extension_points import PAYLOADS
from scenarios.scenario.files import with_values
from scenarios.scenario.scenario import Scenario
from scenarios.studies.base import FlightStudy

_PLACES = ("start.aspect_deg", "start.place_m", "start.range_m")
"""Keys of a place at which a flight begins."""


class PatrolStudy(FlightStudy):
    """Patrols, each a task: ships that are sampled, and flights beside them one after the other.

    Parameters
    ----------
    scenario, name : the patrols, and their name
    trials : the same by its name
    overrides : overrides that were applied, recorded in the manifest

    Raises
    ------
    InputError : same as ``FlightStudy``; flights that give no verdict, ships that are not steady, a
        place at which a flight begins, a distance to keep from ships that exceeds the way to them,
        ships so near to one another that a flight beside one enters the area of the other, an
        endurance too short for any ship, or ships that find no room
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

    def initial_manifest(self) -> dict[str, Any]:
        """Return the manifest as written before the first patrol."""
        reason = "whose rows are patrols of several ships and not single flights"
        return super().initial_manifest() | {"not_compared": reason}

    def work(self, run: RunDirectory) -> "PatrolWork":
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
        rows, config = list(journal.rows(SUMMARY)), PatrolKeys.of(self._patrols).patrol
        counts = PatrolCounts.of(
            rows,
            planned=self.planned,
            oracle_share_min=config.oracle_share_min,
            wrong_share_max=config.wrong_share_max,
        )
        share = f"{100.0 * counts.correct / counts.oracle:.0f} %" if counts.oracle else "–"
        enough, right = ("meet" if of else "fail" for of in (counts.enough, counts.right))
        judged = (
            f"correct verdicts {enough} patrol.oracle_share_min, wrong ones {right}"
            " patrol.wrong_share_max"
            if counts.judged
            else "no ship was served"
            if not counts.served
            else "no verdict, and none of an oracle: give ships more time (patrol.patience_s,"
            " flight.after_settling_s)"
        )
        ended = f"exit status {int(not counts.met)}: " if counts.done == self.planned else "so far "
        lines = [
            f"patrols: {self.planned} planned, {counts.done} flown; {counts.served} of"
            f" {counts.ships} ships served in {counts.hours:.3g} h, {counts.per_hour:.2f} an hour",
            f"verdicts: {counts.correct} correct, {counts.wrong} wrong, {counts.open} open; the"
            f" oracle's: {counts.oracle} ({share}, required {100.0 * config.oracle_share_min:g}"
            " %)",
            f"keep-out violations: {counts.violations}; patrols that kept out: {counts.kept_out}"
            f" of {counts.done}",
            *(f"    {row['flight_id']}: {row['message']}" for row in rows if row["message"]),
            f"{ended}{counts.through} of {self.planned} patrols kept out and brought their"
            f" aircraft through; {judged}",
        ]
        manifest: dict[str, Any] = {
            "patrols_met": counts.through,
            "ships_served": counts.served,
            "verdicts": counts.verdicts,
            "verdicts_wrong": counts.wrong,
            "oracle_verdicts": counts.oracle,
        }
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
    """Refuse a scenario that is not a patrol."""
    if scenario.vessel.from_file or scenario.vessel.manoeuvres or scenario.wind.table is not None:
        raise InputError(
            "study is 'patrol' beside vessel.manoeuvres, a vessel.track from a file or"
            " wind.table; ships and wind of a patrol are steady: remove them"
        )
    if scenario.flight.until != "verdict" or SNIFFER not in scenario.payload.instruments:
        raise InputError(
            f"flight.until is '{scenario.flight.until}' and payload.instruments"
            f" {list(scenario.payload.instruments)}; a patrol goes on after a verdict: set"
            " flight.until to 'verdict', and put 'sniffer' into payload.instruments"
        )
    placed = sorted(
        {draw.key for draw in scenario.draws} & set(_PLACES)
        | {key for key in _PLACES if _given(scenario, key)}
    )
    if placed:
        raise InputError(
            f"study is 'patrol' beside {' and '.join(placed)}; a flight beside a ship begins where"
            " the way to it ends, start.distance_m away: remove them"
        )
    config, reach = PatrolKeys.of(scenario).patrol, scenario.start.distance_m[1]
    if scenario.keepout.radius_m + config.clearance_m > reach:
        raise InputError(
            "keepout.radius_m and patrol.clearance_m are"
            f" {scenario.keepout.radius_m + config.clearance_m:g} m together, more than"
            f" start.distance_m, whose end is {reach:g} m and where the way to a ship ends: no"
            " ship can be served; give less"
        )
    if config.separation_m < (apart := reach + scenario.keepout.radius_m):
        raise InputError(
            f"patrol.separation_m is {config.separation_m:g} m; a flight beside a ship is up to"
            f" {reach:g} m from it, the end of start.distance_m, and may not come within"
            f" keepout.radius_m, {scenario.keepout.radius_m:g} m, of another: give {apart:g} m or"
            " more"
        )
    if config.endurance_s < config.service_s:
        raise InputError(
            f"patrol.endurance_s is {config.endurance_s:g} s, too short for any ship, which takes"
            f" patrol.service_s = {config.service_s:g} s; give more"
        )


# ---------------------------------------------------------------- Flying a patrol

SNIFFER = "sniffer"
"""The instrument that gives verdicts."""

_SHORTEST = 30.0
"""Shortest time left for which a flight beside a ship begins [s]."""


class _Flown(NamedTuple):
    """A flight beside a ship: its row, and its time history if it has one."""

    row: Row
    history: pd.DataFrame | None


class _Uav:
    """Place of the UAV [m] and time [s], its way so far, and whether it is lost."""

    def __init__(self) -> None:
        self.place, self.time = 0j, 0.0
        self.stretches: list[Row] = []
        self.lost = False

    def go(self, leg: Leg, named: Row, phase: str) -> None:
        """Fly a leg."""
        self.stretches.append(phase_row(named, phase, leg))
        self.place, self.time = leg.end, leg.ends


@dataclass(frozen=True, kw_only=True)
class PatrolWork(FlightRunner):
    """Flies patrols; attributes are those of ``FlightRunner``, with one experiment of as many
    flights as there are patrols.
    """

    def run(self, task: Task) -> Result:
        """Fly a patrol, then a flight beside each of its ships with the true axis of its plume, and
        find the oracle's order.
        """
        began = time.perf_counter()
        experiment = self.experiments[0]
        row: Row = {"flight_id": experiment.named(task.number)[0], "criteria_met": False}
        ships: list[Row] = []
        stretches: list[Row] = []
        try:
            patrol = sampled_patrol(experiment.name, experiment.scenario, task.number)
            row |= {"seed": patrol.seed} | wind_row(patrol)
            ships = [
                ship_row(patrol, i, _limit_percent(self._scenario))
                for i in range(len(patrol.ships))
            ]
            stretches = self._patrolled(patrol, ships).stretches
            row |= self._oracle(patrol, ships)
            keepout = self._scenario.keepout
            radius = keepout.other_radius_m or keepout.radius_m
            row |= patrol_figures(
                ships, stretches, endurance=self._endurance, keepout_radius=radius
            )
        except Exception as error:  # noqa: BLE001 - a row with its reason; the study goes on
            row |= failure(error)
        row["wall_time_s"] = time.perf_counter() - began
        return Result(task=task, tables={SUMMARY: [row], SHIPS: ships, PHASES: stretches})

    def lost(self, task: Task, reason: str) -> Result:
        """Return the result of a patrol whose process was lost."""
        row = {
            "flight_id": self.experiments[0].named(task.number)[0],
            "outcome": Outcome.FAILED.value,
            "message": reason,
        }
        return Result(task=task, tables={SUMMARY: [row | {"criteria_met": False}]}, lost=True)

    @property
    def _scenario(self) -> Scenario:
        return self.experiments[0].scenario

    @property
    def _endurance(self) -> float:
        return PatrolKeys.of(self._scenario).patrol.endurance_s

    @property
    def _reach(self) -> float:
        """Distance from a ship at which the way to it ends [m]."""
        return self._scenario.start.distance_m[1]

    def _prospect(
        self,
        patrol: Patrol,
        service: Sequence[float],
        chance: Sequence[float],
        *,
        deviation: float = 0.0,
    ) -> Prospect:
        """Return the expectations for serving the ships, given the time for each and the
        probability of a verdict.
        """
        return Prospect(
            ships=patrol.movers,
            service=service,
            deviation=deviation,
            chance=chance,
            radius=self._reach,
            air=patrol.air,
            endurance=self._endurance,
        )

    def _patrolled(self, patrol: Patrol, ships: list[Row]) -> _Uav:
        """Serve ships until no further ship can be served; their rows are completed."""
        config = PatrolKeys.of(self._scenario).patrol
        uav, left = _Uav(), list(range(len(ships)))
        count = len(ships)
        prospect = self._prospect(
            patrol, [config.service_s] * count, [1.0] * count, deviation=config.service_deviation_s
        )
        clearance = self._scenario.keepout.radius_m + config.clearance_m
        while left and not uav.lost:
            order = best_order(prospect, uav.place, uav.time, left).ships
            if not order:
                break
            ship = order[0]
            left.remove(ship)
            goal = patrol.movers[ship]
            legs = route(
                uav.place,
                uav.time,
                goal,
                self._reach,
                air=patrol.air,
                ships=patrol.movers,
                clearance=clearance,
            )
            if not legs or legs[-1].ends + _SHORTEST > self._endurance:
                continue
            self._serve(patrol, ship, legs, uav, ships)
        return uav

    def _serve(
        self, patrol: Patrol, ship: int, legs: Sequence[Leg], uav: _Uav, ships: list[Row]
    ) -> None:
        """Go to a ship, and fly beside it; its row is completed."""
        row, target = ships[ship], patrol.movers[ship]
        named = {name: row[name] for name in ("flight_id", "patrol", "ship")}
        others = [mover for mover in patrol.movers if mover is not target]
        row |= {
            "position": sum("position" in other for other in ships),
            "leaves_s": uav.time,
            "reached_s": legs[-1].ends,
        }
        for leg in legs:
            uav.go(leg, named, TRANSIT)
        near = [leg.distance(other) for leg in legs for other in others]
        start = _start_beside(target, patrol.ships[ship].course, legs[-1], patrol.air)
        duration = min(PatrolKeys.of(self._scenario).patrol.patience_s, self._endurance - uav.time)
        flown = self._flown(
            patrol,
            ship,
            row["flight_id"],
            start
            | {
                "flight.duration_max_s": duration,
                "traffic": _traffic(patrol, ship, uav.time),
            },
        )
        row |= _taken(flown.row)
        row["correct"] = row["verdict"] == row["truth"]
        if flown.history is not None:
            time, north, east = (
                flown.history[name].to_numpy(np.float64) for name in ("time_s", "north_m", "east_m")
            )
            time, origin = time + uav.time, target.at(uav.time)
            track = north + origin.real + 1j * (east + origin.imag)
            near += [nearest_on(time, track, other) for other in others]
            for phase, first, last in _phases(flown.row, flown.history):
                uav.go(
                    Leg(
                        float(time[first]),
                        float(time[last]),
                        complex(track[first]),
                        complex(track[last]),
                    ),
                    named,
                    phase,
                )
        row["ended_s"] = uav.time
        if near:
            row["others_distance_min_m"] = min(near)
        uav.lost = flown.row["outcome"] in LOST

    def _flown(self, patrol: Patrol, ship: int, name: str, values: dict[str, object]) -> _Flown:
        """Fly beside a ship in the same way as any other flight."""
        scenario = with_values(patrol.ships[ship].scenario, values)
        work = FlightRunner(
            experiments=(Experiment(name, scenario),),
            histories=1,
            setup=self.setup,
            spreads=self.spreads,
            refusal=self.refusal,
        )
        result = work.run(Task(number=0))
        (row,) = result.tables[SUMMARY]
        histories = [
            content for file, content in result.files.items() if file.endswith(HISTORY_SUFFIX)
        ]
        return _Flown(row, pd.read_parquet(io.BytesIO(histories[0])) if histories else None)

    def _oracle(self, patrol: Patrol, ships: list[Row]) -> Row:
        """Complete the ships' rows by the oracle's order: the oracle knows the time for each ship,
        with and without the true axis.
        """
        service, chance = [], []
        known_axis = {
            "following.plume": "told",
            "flight.duration_max_s": PatrolKeys.of(self._scenario).patrol.patience_s,
            "start.range_m": self._reach,
        }
        for ship, row in enumerate(ships):
            flown = self._flown(patrol, ship, f"{row['flight_id']}_known_axis", known_axis).row
            verdict = verdict_of(flown)
            row |= {"known_axis_verdict": verdict, "known_axis_service_s": flown.get("duration_s")}
            known = [flown["duration_s"]] if verdict == row["truth"] else []
            # The oracle also knows the patrol's own flight, if that is shorter.
            known += [row["ended_s"] - row["reached_s"]] if row.get("correct") else []
            service.append(min(known, default=math.inf))
            chance.append(float(bool(known)))
        prospect = self._prospect(patrol, service, chance)
        best = best_order(prospect, 0j, 0.0, [ship for ship, worth in enumerate(chance) if worth])
        for position, (ship, ends) in enumerate(
            zip(best.ships, ends_of(prospect, 0j, 0.0, best.ships), strict=True)
        ):
            ships[ship] |= {"oracle_position": position, "oracle_ended_s": ends}
        return {
            "oracle_verdicts": round(best.verdicts),
            "known_axis_verdicts": sum(row["known_axis_verdict"] == row["truth"] for row in ships),
        }


def _limit_percent(scenario: Scenario) -> float:
    """Return the limit of the sulphur content for the verdicts [% m/m]."""
    limit: float = scenario.payload.settings(PAYLOADS.get(SNIFFER)).limit_percent
    return limit


# ---------------------------------------------------------------- One flight beside a ship

_TAKEN = (
    "fsc_percent",
    "orbit_at_s",
    "time_to_find_s",
    "settling_time_s",
    "enough",
    "outcome",
    "message",
    "keepout_violations",
    "min_distance_m",
    "altitude_outside_s",
    "kept_out",
)
"""Columns of a flight's row that a ship's has, too."""


def _start_beside(ship: Mover, course: float, last: Leg, air: Air) -> dict[str, object]:
    """Return the start of a flight beside a ship on a course [rad], as keys of its scenario: the
    end of the way to the ship.
    """
    place = (last.end - ship.at(last.ends)) * complex(math.cos(course), -math.sin(course))
    return {
        "start.place_m": (place.real, place.imag),
        "start.course_deg": math.degrees(last.course(air)),
    }


def _traffic(patrol: Patrol, ship: int, time: float) -> list[dict[str, object]]:
    """Return the other ships of a patrol at a time [s], as ``traffic`` of a flight beside one of
    them that begins then: the guard keeps off them as well.
    """
    target = patrol.ships[ship]
    ahead = complex(math.cos(target.course), -math.sin(target.course))
    others = []
    for number, other in enumerate(patrol.ships):
        if number != ship:
            place = (other.mover.at(time) - target.mover.at(time)) * ahead
            others.append(
                {
                    "name": f"ship_{number}",
                    "place_m": [place.real, place.imag],
                    "speed_mps": abs(other.mover.velocity),
                    "course_deg": other.scenario.vessel.course_deg,
                }
            )
    return others


def _taken(row: Row) -> Row:
    """Return the values of a ship's row that come from the flight beside it."""
    taken = {name: row[name] for name in _TAKEN if name in row} | {"verdict": verdict_of(row)}
    if "keepout_violations" in taken:
        # Violations of other ships are counted with the way to this one.
        taken["keepout_violations"] -= row.get("others_violations", 0)
    return taken


def _phases(row: Row, history: pd.DataFrame) -> Iterator[tuple[str, int, int]]:
    """Yield the phases of a flight, each with the numbers of its first and its last sample."""
    time = history["time_s"].to_numpy(np.float64)
    leaving = np.flatnonzero(history["mode"].to_numpy() == Mode.DEPARTING.number)
    end = len(time) - 1
    orbit = _sample(time, row.get("orbit_at_s", math.inf))
    found = _sample(time, row.get("orbit_at_s", math.inf) + row.get("time_to_find_s", math.inf))
    left = int(leaving[0]) if len(leaving) else end
    edges = np.minimum.accumulate([end, left, found, orbit, 0])[::-1].tolist()
    for i, phase in enumerate((APPROACH, SEARCHING, MEASURING, LEAVING)):
        if edges[i + 1] > edges[i]:
            yield phase, edges[i], edges[i + 1]


def _sample(time: np.ndarray[tuple[int], np.dtype[np.float64]], at: float) -> int:
    """Return the number of the sample at a time, the last one's if it is later [s]."""
    return min(int(np.searchsorted(time, at)), len(time) - 1)
