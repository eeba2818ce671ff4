"""What the record of a design says of turn reversals: the response, and how far aircraft deviate.

The aircraft is flown as modelled, and perturbed as in the checks of the design's margins.
"""

import math
import os
import shutil
import sys
import tempfile
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path

from aircraft.model import Perturbation, perturb, remove_ground_contacts
from aircraft.spec import AircraftSpec
from aircraft.trim import Trim
from common.interrupt import follow_parent
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.flight.reversal_search import (
    ReversalSearch,
    reversals_of_a_design,
    search_reversals,
)
from innerloop.flight.turn_reversal import TurnReversalResponse, measure_turn_reversal
from innerloop.margins import NOMINAL
from innerloop.robustness import CASES
from innerloop.store import Designed, Record

AIRCRAFT = {name: case.by for name, case in CASES.items() if case.periods_late == 0}
"""The aircraft that fly reversals, by name, in the order of ``perturbed_aircraft``."""

PART = 200
"""Reversals of one task of a repeated search [-]: an interruption loses no more of each process."""

_PROCESSES = 2


def perturbed_aircraft(spec: AircraftSpec, root: Path) -> list[AutopilotedAircraft]:
    """Return the aircraft of ``AIRCRAFT``, under the autopilot of a JSBSim root."""
    return [_with_perturbation(spec, root, by) for by in AIRCRAFT.values()]


def aircraft_as_modelled(spec: AircraftSpec, root: Path) -> AutopilotedAircraft:
    """Return the first of ``perturbed_aircraft`` alone."""
    return _with_perturbation(spec, root, AIRCRAFT[NOMINAL])


def _with_perturbation(spec: AircraftSpec, root: Path, by: Perturbation) -> AutopilotedAircraft:
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(shutil.copytree(root, Path(folder) / "root"))
        perturb(copy / "aircraft" / spec.files.model / f"{spec.files.model}.xml", by)
        remove_ground_contacts(spec, copy)
        return AutopilotedAircraft(spec, copy)


def reversal_record(
    spec: AircraftSpec, root: Path, start: Trim, bank: float, slow_lag: float
) -> Record:
    """Return the heading-rate response to a turn reversal, and the deviations that a search found.

    Parameters
    ----------
    spec, root : the aircraft, and a JSBSim root of its autopilot
    start : straight and level equilibrium
    bank : of the turns [rad]
    slow_lag : of the heading rate behind slow commands [s]
    """
    aircraft = perturbed_aircraft(spec, root)
    response = measure_turn_reversal(aircraft[0], start, bank)
    count = reversals_of_a_design(bank, start.airspeed)
    found = search_reversals(
        aircraft, start, bank, response, slow_lag, reversals=count, settled=True
    )
    return {
        "bank_deg": math.degrees(bank),
        "airspeed_mps": start.airspeed,
        "delay_s": response.delay,
        "lag_s": response.lag,
        "reversals": found.reversals,
        "unguided_reversals": found.random_reversals,
        "deviation_99_percent_m": found.p99_deviation,
        "deviation_max_m": found.deviation,
        "worst_command_before": found.command_before,
        "worst_airspeed_before_mps": found.airspeed_before,
        "altitude_error_max_m": found.altitude_error,
        "deviation_of_m": _largest_deviations([found]),
    }


def _largest_deviations(searches: Sequence[ReversalSearch]) -> dict[str, float]:
    """Return the largest deviation [m] of each aircraft that flew a reversal, by its name."""
    found = {
        name: max(search.deviations[i] for search in searches) for i, name in enumerate(AIRCRAFT)
    }
    return {name: deviation for name, deviation in found.items() if math.isfinite(deviation)}


@dataclass(frozen=True, slots=True, kw_only=True)
class _Task:
    """A part of a repeated search, with the parameters of ``search_reversals``."""

    spec: AircraftSpec
    root: Path
    start: Trim
    bank: float
    response: TurnReversalResponse
    slow_lag: float
    reversals: int
    seed: int


def repeat_search(
    found: Designed, root: Path, reversals: int, *, done: Callable[[int, float], None]
) -> Record:
    """Return the largest deviation in a search with other random numbers than the design's own.

    An interrupted search returns the result of its finished tasks, if there are any.

    Parameters
    ----------
    found : the design, whose record contains the response
    root : JSBSim root of its autopilot
    reversals : how many are flown
    done : called after each task with the number of reversals flown, and the largest deviation
        so far [m]
    """
    schedule, recorded = found.design.schedule, found.record["turn_reversal"]
    tasks = [
        # The design's own search has the seed 0.
        _Task(
            spec=schedule.spec,
            root=root,
            start=schedule.level(schedule.middle),
            bank=schedule.envelope.bank,
            response=TurnReversalResponse(delay=recorded["delay_s"], lag=recorded["lag_s"]),
            slow_lag=found.record["heading_rate_lag_s"],
            reversals=min(PART, reversals - first),
            seed=seed,
        )
        for seed, first in enumerate(range(0, reversals, PART), start=1)
    ]
    searches: list[ReversalSearch] = []
    with ProcessPoolExecutor(
        min(_PROCESSES, os.cpu_count() or 1), initializer=follow_parent
    ) as pool:
        running: list[Future[ReversalSearch]] = [pool.submit(_search, task) for task in tasks]
        try:
            for finished in as_completed(running):
                searches.append(finished.result())
                done(
                    sum(search.reversals for search in searches),
                    max(search.deviation for search in searches),
                )
        except KeyboardInterrupt:
            pool.shutdown(cancel_futures=True)
            if not searches:
                raise
            print("interrupted; what was found so far is recorded", file=sys.stderr)
    worst = max(searches, key=lambda search: search.deviation)
    return {
        "reversals": sum(search.reversals for search in searches),
        "deviation_max_m": worst.deviation,
        "worst_command_before": worst.command_before,
        "worst_airspeed_before_mps": worst.airspeed_before,
        "deviation_of_m": _largest_deviations(searches),
    }


def _search(task: _Task) -> ReversalSearch:
    return search_reversals(
        perturbed_aircraft(task.spec, task.root),
        task.start,
        task.bank,
        task.response,
        task.slow_lag,
        reversals=task.reversals,
        seed=task.seed,
    )
