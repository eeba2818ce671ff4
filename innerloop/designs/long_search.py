"""The search over reversals of a design, repeated with thousands of them in several processes."""

import os
import signal
import sys
from collections.abc import Callable
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from pathlib import Path

from aircraft.dynamics.equilibrium import Trim
from aircraft.spec import AircraftSpec
from innerloop.designs.cache import Designed
from innerloop.designs.record import Record
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.flight.reversal_search import ReversalSearch, search_reversals
from innerloop.flight.turn_reversal import TurnReversalResponse

PART = 100
"""Reversals that one flight consists of [-]: so many are lost at most where a search is interrupted."""

_PROCESSES = 2

Done = Callable[[int, float], None]
"""Is told how many reversals are flown, and the largest deviation so far [m]."""


def repeat_search(found: Designed, root: Path, reversals: int, *, done: Done) -> Record:
    """Return the largest deviation that a search over so many reversals finds, of other random numbers than the design's own.

    An interrupted search returns what it has found, if there is any.

    Parameters
    ----------
    found : the design, whose record says with which response
    root : JSBSim root of its autopilot
    reversals : how many are flown
    done : told after each part
    """
    schedule, own = found.design.schedule, found.record["turn_reversal"]
    response = TurnReversalResponse(delay=own["delay_s"], lag=own["lag_s"])
    slow_lag = found.record["heading_rate_lag_s"]
    counts = [min(PART, reversals - first) for first in range(0, reversals, PART)]
    searches: list[ReversalSearch] = []
    with ProcessPoolExecutor(min(_PROCESSES, os.cpu_count() or 1), initializer=_leave_interrupts_alone) as pool:
        parts: list[Future[ReversalSearch]] = [
            # The design's own search has the seed 0.
            pool.submit(
                _search,
                schedule.spec,
                root,
                schedule.level(schedule.middle),
                schedule.envelope.bank,
                response,
                slow_lag,
                count,
                seed,
            )
            for seed, count in enumerate(counts, start=1)
        ]
        try:
            for part in as_completed(parts):
                searches.append(part.result())
                done(sum(search.reversals for search in searches), max(search.deviation for search in searches))
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
    }


def _search(
    spec: AircraftSpec,
    root: Path,
    start: Trim,
    bank: float,
    response: TurnReversalResponse,
    slow_lag: float,
    reversals: int,
    seed: int,
) -> ReversalSearch:
    return search_reversals(AutopilotedAircraft(spec, root), start, bank, response, slow_lag, reversals=reversals, seed=seed)


def _leave_interrupts_alone() -> None:
    """Let the process that started this one decide."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
