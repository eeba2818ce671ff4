"""The content of ``statistics.json`` of a study by subset simulation."""

import math
from collections.abc import Sequence
from dataclasses import asdict

import pandas as pd

from common.intervals import upper_bound
from scenarios.statistics.estimates import Json, counted, named, share, without_nan
from scenarios.statistics.subset_estimates import (
    InputShift,
    RareProbability,
    curve,
    noise_floor,
    rare_probability,
)
from scenarios.statistics.subset_levels import Level, Simulation
from scenarios.statistics.violations import count_violations


def subset_statistics(
    rows: pd.DataFrame,
    simulations: Sequence[Simulation],
    shifts: Sequence[InputShift],
    *,
    confidence: float,
) -> Json:
    """Return the content of ``statistics.json``; values that are not a number become None.

    Flights of the first levels are a plain random sample, which gives a bound by itself. Of those
    that have no measurement, or were lost without a violation, nobody knows where they would have
    gone: the pessimistic bound takes their probability as that of violations, too.

    Parameters
    ----------
    rows : columns ``COLUMNS`` of the summary, a row per flight in the order in which they were
        flown
    simulations : the repeats, at least three
    shifts : of the inputs
    confidence : of each interval, between 0 and 1
    """
    plain = count_violations(
        rows.head(sum(len(simulation.levels[0].values) for simulation in simulations))
    )
    every = count_violations(rows)
    found = rare_probability(simulations, confidence)
    content: Json = without_nan(
        {
            "method": "subset",
            "confidence": confidence,
            "flights": {"done": every.flights, "measured": every.measured, "unknown": named(every)},
            "outcomes": counted(rows["outcome"]),
            "modes_at_end": counted(rows["mode_at_end"]),
            "violation": {
                **asdict(found),
                "repeats": len(simulations),
                "events": every.events,
                "pessimistic": {
                    "upper": pessimistic_upper(
                        simulations,
                        found,
                        plain.events_at_most - plain.events,
                        plain.flights,
                        confidence,
                    )
                },
                "first_levels": share(plain.events, plain.measured, confidence),
                "first_levels_unknown": plain.events_at_most - plain.events,
            },
            "simulations": [_simulation(simulation) for simulation in simulations],
            "curve": [
                {"clearance_m": value, **asdict(point)}
                for value, point in curve(simulations, confidence)
            ],
            "inputs": [asdict(shift) for shift in shifts],
            "noise_floor": noise_floor(simulations),
        }
    )
    return content


def pessimistic_upper(
    simulations: Sequence[Simulation],
    found: RareProbability,
    unknown: int,
    flights: int,
    confidence: float,
) -> float:
    """Return the bound if flights of unknown end were violations; what may go wrong is shared
    equally between the two.
    """
    if not unknown:
        return found.upper
    half = 0.5 + 0.5 * confidence
    return min(1.0, rare_probability(simulations, half).upper + upper_bound(unknown, flights, half))


def _simulation(simulation: Simulation) -> Json:
    probability, variation = simulation.below(0.0)
    return {
        "probability": probability,
        "variation": variation,
        "stalled": simulation.stalled,
        "levels": [_level(level) for level in simulation.levels],
    }


def _level(level: Level) -> Json:
    counts = asdict(level.counts)
    flights = counts.pop("evaluated")
    return {
        "below_m": level.below,
        "threshold_m": level.threshold,
        "probability": level.probability,
        "variation": level.variation,
        "flights": flights,
        "nearest_m": float(level.values.min()),
        "without_measurement": int(sum(math.isinf(value) for value in level.values)),
        **counts,
        "scale": level.scale,
        "noise_scale": level.noise_scale,
    }
