"""Orders of ships by insertion beside the best of all orders: how often they expect as many
verdicts, and how much later they end.

Run with ``python -m benchmarks.patrol_orders [--patrols N] [--ships N]``. Nothing is flown.
"""

import argparse
import time

import numpy as np

from extensions.patrol.keys import PatrolKeys
from extensions.patrol.order import Order, Prospect, exact_order, inserted_order
from extensions.patrol.ships import Patrol, sampled_patrol
from scenarios.scenario.files import load_study
from scenarios.scenario.scenario import Scenario

_ALIKE = 0.02
"""Expected verdicts that make no difference [-]."""


def main() -> None:
    """Print the comparison."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--patrols", type=int, default=50, help="number of patrols")
    parser.add_argument("--ships", type=int, default=6, help="ships of each")
    given = parser.parse_args()
    scenario = load_study("patrol", [f"patrol.ships={given.ships}"])
    if not isinstance(scenario, Scenario):
        raise SystemExit("the catalog's patrol is no scenario of flights")
    pairs, seconds = [], np.zeros(2)
    for number in range(given.patrols):
        prospect = expected(sampled_patrol("patrol", scenario, number), scenario)
        began = time.perf_counter()
        inserted = inserted_order(prospect, 0j, 0.0, range(given.ships))
        between = time.perf_counter()
        exact = exact_order(prospect, 0j, 0.0, range(given.ships))
        seconds += between - began, time.perf_counter() - between
        pairs.append((inserted, exact))
    print(compared(pairs))
    print(
        f"{1e3 * seconds[0] / given.patrols:.1f} ms by insertion,"
        f" {1e3 * seconds[1] / given.patrols:.1f} ms exact, a patrol"
    )


def expected(patrol: Patrol, scenario: Scenario) -> Prospect:
    """Return what a patrol expects before it begins."""
    config, count = PatrolKeys.of(scenario).patrol, len(patrol.ships)
    return Prospect(
        ships=patrol.movers,
        service=[config.service_s] * count,
        deviation=config.service_deviation_s,
        chance=[1.0] * count,
        radius=scenario.start.distance_m[1],
        air=patrol.air,
        endurance=config.endurance_s,
    )


def compared(pairs: list[tuple[Order, Order]]) -> str:
    """Return how orders by insertion compare with exact ones, in a sentence."""
    less = np.array([exact.verdicts - inserted.verdicts for inserted, exact in pairs])
    alike = [
        (inserted, exact)
        for inserted, exact in pairs
        if exact.verdicts - inserted.verdicts < _ALIKE
    ]
    later = np.array([inserted.ends - exact.ends for inserted, exact in alike])
    return (
        f"as many expected verdicts in {len(alike)} of {len(pairs)} patrols,"
        f" {np.mean(less):.3f} fewer in the mean,"
        f" {np.max(less):.2f} at most; where as many, {np.mean(later):.1f} s later in the mean,"
        f" {np.max(later):.0f} s at most"
    )


if __name__ == "__main__":
    main()
