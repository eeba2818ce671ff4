"""How soon a plume is found, how well its height is known then, and what that costs, over cases
that are drawn at random.

``python -m benchmarks.plume.estimator`` flies a point that oscillates across simulated plumes, at
the heights that a search demands, and prints the table of docs/finding_the_plume.md.
"""

import argparse
import math
import statistics
import time
from collections.abc import Callable

import numpy as np

from benchmarks.plume.flight import CLIMB_RATE, HIGHEST, LOWEST, Flight, draw_case, fly
from benchmarks.plume.particles import ParticleEstimator
from gnc.estimation.plume.estimator import PlumeEstimator
from gnc.mission.axis import HeightSearch, LadderSearch, Search
from measurement.sniffer.spec import SnifferSpec, sensor_preset

SEARCHES: dict[str, Callable[[], Search]] = {
    "information": lambda: HeightSearch(lowest=LOWEST, highest=HIGHEST, climb_rate=CLIMB_RATE),
    "ladder": lambda: LadderSearch(lowest=LOWEST, highest=HIGHEST),
}

ESTIMATORS = {"grid": PlumeEstimator, "particles": ParticleEstimator}

HIT = 0.6
"""Peak of a pass over the plume's centre from which it counts as a hit [-]."""


def figures(flights: list[Flight], at: float = 180.0) -> dict[str, float]:
    """Return the figures of some flights; those of the estimate are at a time [s]."""
    found = np.array([flight.estimator.found_at for flight in flights])
    times = np.nan_to_num(found, nan=math.inf)
    errors, limits, inside, within = [], [], [], []
    for flight in flights:
        i = next(i for i, row in enumerate(flight.passes) if row[0] >= at)
        _, _, height, deviation, truth, _ = flight.passes[i]
        low, high = flight.intervals[i]
        errors.append(height - truth)
        limits.append(max(5.0, 0.5 * flight.spread))
        inside.append(low <= truth <= high)
        within.append(((height - truth) / deviation) ** 2)
    error, limit = np.array(errors), np.array(limits)
    return {
        "found within 5 min [%]": 100.0 * float(np.mean(np.isfinite(found))),
        "time to find, median [s]": float(np.median(times)),
        "time to find, 95 % [s]": float(np.quantile(times, 0.95, method="higher")),
        "height error rms [m]": float(np.sqrt(np.mean(error**2))),
        "height error over its limit, rms [-]": float(np.sqrt(np.mean((error / limit) ** 2))),
        "95 % interval holds the height [%]": 100.0 * float(np.mean(inside)),
        "error over stated deviation, rms [-]": math.sqrt(float(np.mean(within))),
        "hits after found [%]": 100.0 * _hits(flights, 0.0),
        "hits from a minute after [%]": 100.0 * _hits(flights, 60.0),
    }


def _hits(flights: list[Flight], after: float) -> float:
    rows = [
        row[5] > HIT
        for flight in flights
        for row in flight.passes
        if row[0] > flight.estimator.found_at + after
    ]
    return float(np.mean(rows))


def cost(spec: SnifferSpec) -> tuple[float, float]:
    """Return the computing time of a reading, and of a pass with its decision [us], medians of a
    few flights.
    """
    single: list[float] = []
    passes: list[float] = []

    class Timed(PlumeEstimator):
        def update(
            self,
            along: float,
            across: float,
            altitude: float,
            reading: float,
            *,
            apparent_wind: float | None = None,
        ) -> bool:
            began = time.thread_time()
            done = super().update(along, across, altitude, reading, apparent_wind=apparent_wind)
            (passes if done else single).append(1e6 * (time.thread_time() - began))
            return done

    for seed in range(4):
        fly(draw_case(seed), spec, SEARCHES["information"], estimator=Timed)
    return statistics.median(single), statistics.median(passes)


def main() -> None:
    """Fly the cases and print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=200)
    parser.add_argument("--first", type=int, default=0, help="seed of the first case")
    parser.add_argument("--sensor", default="fast")
    parser.add_argument("--search", choices=SEARCHES, default="information")
    parser.add_argument("--estimator", choices=ESTIMATORS, default="grid")
    parser.add_argument("--knowing", action="store_true", help="fly on the true axis")
    given = parser.parse_args()
    spec = sensor_preset(given.sensor)
    flights = [
        fly(
            draw_case(seed),
            spec,
            SEARCHES[given.search],
            estimator=ESTIMATORS[given.estimator],
            knowing=given.knowing,
        )
        for seed in range(given.first, given.first + given.cases)
    ]
    print(
        f"{given.cases} cases, {given.sensor}, {given.search},"
        f" {given.estimator}{', knowing the axis' if given.knowing else ''}"
    )
    for name, value in figures(flights).items():
        print(f"  {name:40s} {value:8.2f}")
    print("  a reading takes {:.1f} us, a pass {:.0f} us".format(*cost(spec)))


if __name__ == "__main__":
    main()
