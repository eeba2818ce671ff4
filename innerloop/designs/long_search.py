"""The search over reversals of a design, repeated with thousands of them in several processes."""

import os
import sys
from collections.abc import Callable
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path

from aircraft.spec import AircraftSpec
from aircraft.trim import Trim
from common.interrupt import follow_parent
from innerloop.designs.designed import Designed, Record
from innerloop.flight.perturbed_aircraft import deviations_by_case, perturbed_aircraft
from innerloop.flight.reversal_search import ReversalSearch, search_reversals
from innerloop.flight.turn_reversal import TurnReversalResponse

PART = 200
"""Reversals that one flight consists of [-]: so many are lost at most where a search is
interrupted.
"""

_PROCESSES = 2

Done = Callable[[int, float], None]
"""Called with the number of reversals flown, and the largest deviation so far [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Part:
    """A part of the search: with which aircraft and from where, how many reversals, and the seed of
    their random numbers.
    """

    spec: AircraftSpec
    root: Path
    start: Trim
    bank: float
    response: TurnReversalResponse
    slow_lag: float
    reversals: int
    seed: int


def repeat_search(found: Designed, root: Path, reversals: int, *, done: Done) -> Record:
    """Return the largest deviation that a search over so many reversals finds, of other random
    numbers than the design's own.

    An interrupted search returns what it has found, if there is any.

    Parameters
    ----------
    found : the design, whose record says with which response
    root : JSBSim root of its autopilot
    reversals : how many are flown
    done : called after each part
    """
    schedule, own = found.design.schedule, found.record["turn_reversal"]
    parts = [
        # The design's own search has the seed 0.
        _Part(
            spec=schedule.spec,
            root=root,
            start=schedule.level(schedule.middle),
            bank=schedule.envelope.bank,
            response=TurnReversalResponse(delay=own["delay_s"], lag=own["lag_s"]),
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
        running: list[Future[ReversalSearch]] = [pool.submit(_search, part) for part in parts]
        try:
            for part in as_completed(running):
                searches.append(part.result())
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
        "deviation_of_m": deviations_by_case(searches),
    }


def _search(part: _Part) -> ReversalSearch:
    aircraft = perturbed_aircraft(part.spec, part.root)
    return search_reversals(
        aircraft,
        part.start,
        part.bank,
        part.response,
        part.slow_lag,
        reversals=part.reversals,
        seed=part.seed,
    )
