"""The command ``python -m tests.measurement.simulator ROW``: estimates of simulated logs.

Without a row it does all. It prints a line for each: logs, those with quality A or B, the share of
their 95 % intervals that hold the content, median bias, median length of the interval over that of
a reference, wrong verdicts of those given, share of open verdicts, logs of quality C, and the mean
time of an estimate.
"""

import argparse
from pathlib import Path

import pandas as pd

from tests.measurement.simulator.log import simulate, write_logs
from tests.measurement.simulator.regimes import REGIMES
from tests.measurement.simulator.runner import HEADER, lines, run, summary


def main() -> None:
    """Estimate the logs of the rows that were asked for."""
    parser = argparse.ArgumentParser(prog="python -m tests.measurement.simulator")
    parser.add_argument("row", nargs="*", metavar="ROW", help=", ".join(REGIMES))
    parser.add_argument("--logs", type=int, default=100, help="logs of a row")
    parser.add_argument("--first", type=int, default=0, help="number of the first")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--save", type=Path, metavar="CSV", help="keeps the estimates, log by log")
    parser.add_argument("--reference", type=Path, metavar="CSV", help="saved estimates to compare")
    parser.add_argument(
        "--write", type=Path, metavar="DIR", help="writes the logs there, and estimates nothing"
    )
    given = parser.parse_args()
    unknown = sorted(set(given.row) - set(REGIMES))
    if unknown:
        parser.error(f"row is {unknown[0]!r}; it must be one of {', '.join(REGIMES)}")
    rows = [REGIMES[name] for name in given.row or REGIMES]
    numbers = range(given.first, given.first + given.logs)
    if given.write:
        logs = (simulate(regime, given.seed, number) for regime in rows for number in numbers)
        write_logs(logs, given.write)
        return
    reference = pd.read_csv(given.reference) if given.reference else None
    print(HEADER)
    tables = []
    for regime in rows:
        tables.append(run(regime, numbers, given.seed))
        if given.save:
            pd.concat(tables).to_csv(given.save, index=False)
        print(*lines(summary(tables[-1], reference)), sep="\n", flush=True)


if __name__ == "__main__":
    main()
