"""The work of a patrol: ships are served one after the other, each by a flight of the closed loop;
then what an oracle would do.
"""

import io
import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pandas as pd

from common.run_layout import HISTORY_SUFFIX, PHASES, SHIPS, SUMMARY
from scenarios.engine.task import Result, Row, Task
from scenarios.experiment.requests import Experiment
from scenarios.flight.ending import failure
from scenarios.flight.outcome import Outcome
from scenarios.flight_runner import FlightRunner
from scenarios.scenario.extension_points import PAYLOADS
from scenarios.scenario.files import with_values
from scenarios.scenario.scenario import Scenario
from scenarios.studies.patrol.beside import phases, start_beside, taken
from scenarios.studies.patrol.legs import Leg, nearest_on, route
from scenarios.studies.patrol.order import Prospect, best_order, ends_of
from scenarios.studies.patrol.ships import Patrol, sampled_patrol
from scenarios.studies.patrol.tables import (
    LOST,
    TRANSIT,
    patrol_figures,
    phase_row,
    ship_row,
    verdict_of,
    wind_row,
)

SNIFFER = "sniffer"
"""The instrument that gives verdicts."""

_SHORTEST = 30.0
"""Shortest flight beside a ship that is begun [s]."""


class _Flown(NamedTuple):
    """A flight beside a ship: its row, and its time history if it has one."""

    row: Row
    history: pd.DataFrame | None


class _Uav:
    """Where the UAV is [m] and when [s], its way so far, and whether it is lost."""

    def __init__(self) -> None:
        self.place, self.time = 0j, 0.0
        self.stretches: list[Row] = []
        self.lost = False

    def go(self, leg: Leg, named: Row, phase: str) -> None:
        """Go on along a leg."""
        self.stretches.append(phase_row(named, phase, leg))
        self.place, self.time = leg.end, leg.ends


@dataclass(frozen=True, kw_only=True)
class PatrolWork(FlightRunner):
    """Flies patrols; attributes are those of ``FlightRunner``, with one experiment of as many flights
    as there are patrols.
    """

    def run(self, task: Task) -> Result:
        """Fly a patrol, then a flight beside each of its ships with the true axis of her plume, and
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
                ship_row(patrol, i, limit_percent(self._scenario)) for i in range(len(patrol.ships))
            ]
            stretches = self._patrolled(patrol, ships).stretches
            row |= self._oracle(patrol, ships)
            radius = self._scenario.keepout.radius_m
            row |= patrol_figures(
                ships, stretches, endurance=self._endurance, keepout_radius=radius
            )
        except Exception as error:  # noqa: BLE001 - a patrol that fails is a row with its reason, and the study goes on
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
        return self._scenario.patrol.endurance_s

    @property
    def _reach(self) -> float:
        """Distance from a ship at which the way to her ends [m]."""
        return self._scenario.start.distance_m[1]

    def _prospect(
        self,
        patrol: Patrol,
        service: Sequence[float],
        chance: Sequence[float],
        *,
        deviation: float = 0.0,
    ) -> Prospect:
        """Return what is expected of serving the ships, given how long each takes, and how likely a
        verdict is.
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
        """Serve ships until none can be served any more; their rows are completed."""
        config = self._scenario.patrol
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
        """Go to a ship, and fly beside her; her row is completed."""
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
        start = start_beside(target, patrol.ships[ship].course, legs[-1], patrol.air)
        duration = min(self._scenario.patrol.patience_s, self._endurance - uav.time)
        flown = self._flown(
            patrol, ship, row["flight_id"], start | {"flight.duration_max_s": duration}
        )
        row |= taken(flown.row)
        row["correct"] = row["verdict"] == row["truth"]
        if flown.history is not None:
            time, north, east = (
                flown.history[name].to_numpy(np.float64) for name in ("time_s", "north_m", "east_m")
            )
            time, origin = time + uav.time, target.at(uav.time)
            track = north + origin.real + 1j * (east + origin.imag)
            near += [nearest_on(time, track, other) for other in others]
            for phase, first, last in phases(flown.row, flown.history):
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
        """Fly beside a ship, by the work of any flight."""
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
        """Complete the ships' rows by the oracle's order: it knows how long each ship takes, with
        and without the true axis.
        """
        service, chance = [], []
        told = {
            "following.plume": "told",
            "flight.duration_max_s": self._scenario.patrol.patience_s,
            "start.range_m": self._reach,
        }
        for ship, row in enumerate(ships):
            flown = self._flown(patrol, ship, f"{row['flight_id']}_told", told).row
            verdict = verdict_of(flown)
            row |= {"told_verdict": verdict, "told_service_s": flown.get("duration_s")}
            known = [flown["duration_s"]] if verdict == row["truth"] else []
            # Where the flight of the patrol took less time, the oracle knows that, too.
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
            "told_verdicts": sum(row["told_verdict"] == row["truth"] for row in ships),
        }


def limit_percent(scenario: Scenario) -> float:
    """Return the sulphur content that verdicts are on [% m/m]."""
    limit: float = scenario.payload.settings(PAYLOADS.get(SNIFFER)).limit_percent
    return limit
