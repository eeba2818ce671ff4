"""Estimates of simulated logs, and what they are worth: one line for each regime."""

import math
import time
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
import pandas as pd

from measurement.errors import MeasurementError
from measurement.estimate import FscEstimate, estimate
from measurement.gases import GASES
from measurement.sniffer.sniffer import Readings
from measurement.sniffer.spec import sensor_of
from tests.measurement.simulator.log import Log, simulate
from tests.measurement.simulator.regimes import Regime

KEY = ["row", "seed", "log"]
"""Columns that name a log."""


def readings_of(log: Log) -> Readings:
    """Return the readings of a log in the form of ``measurement``."""
    missing = np.full(len(log.time), np.nan)
    return Readings(log.time, np.stack([log.values.get(gas, missing) for gas in GASES], axis=1))


def estimated(log: Log) -> dict[str, Any]:
    """Return the estimate of a log beside its truth, as a row of a table.

    ``given`` says whether it has quality A or B, ``verdicts`` and ``wrong`` count verdicts, of
    which one is wrong if it does not hold for every fuel of the log.
    """
    instrument = sensor_of(log.config["instrument"])
    began = time.perf_counter()
    found: FscEstimate | None
    try:
        found, refusal = estimate(readings_of(log), instrument), ""
    except MeasurementError as error:
        found, refusal = None, str(error)
    seconds = time.perf_counter() - began
    contents = log.truth.contents_percent
    row: dict[str, Any] = {
        "true_percent": contents[0],
        "last_percent": contents[-1],
        "fsc_percent": math.nan if found is None else found.fsc_percent,
        "low_percent": math.nan if found is None else found.low_percent,
        "high_percent": math.nan if found is None else found.high_percent,
        "total_percent": math.nan if found is None else found.total_percent,
        "quality": "C" if found is None else found.quality,
        "verdicts": 0,
        "wrong": 0,
        "passes": 0 if found is None else found.figures.passes,
        "agreement": math.nan if found is None else found.agreement,
        "seconds": seconds,
        "reasons": refusal if found is None else "; ".join(found.quality_reasons),
    }
    row["given"] = row["quality"] != "C"
    for verdict in () if found is None else found.verdicts:
        if verdict.verdict != "open" and row["given"]:
            above = [content > verdict.limit_percent for content in contents]
            row["verdicts"] += 1
            row["wrong"] += not all(side == (verdict.verdict == "above") for side in above)
    return row


def run(regime: Regime, numbers: Iterable[int], seed: int) -> pd.DataFrame:
    """Return the estimates of a regime's logs, a row for each number."""
    rows = []
    for number in numbers:
        key = dict(zip(KEY, (regime.name, seed, number), strict=True))
        rows.append(key | estimated(simulate(regime, seed, number)))
    return pd.DataFrame(rows)


def summary(table: pd.DataFrame, reference: pd.DataFrame | None = None) -> pd.DataFrame:
    """Return the figures of each regime, in the table's order.

    Parameters
    ----------
    table : of ``run``
    reference : another estimate of the same logs; ``width_ratio`` is the median ratio of the
        interval's length to that of the reference, over logs for which both are given
    """
    rows = []
    for name, logs in table.groupby("row", sort=False):
        given = logs[logs["given"]]
        content = given["true_percent"]
        held = (given["low_percent"] <= content) & (content <= given["high_percent"])
        rows.append(
            {
                "row": name,
                "logs": len(logs),
                "given": len(given),
                "coverage": held.mean() if len(given) else math.nan,
                "bias": (given["fsc_percent"] / content - 1.0).median(),
                "width_ratio": math.nan if reference is None else _width_ratio(given, reference),
                "wrong": int(logs["wrong"].sum()),
                "verdicts": int(logs["verdicts"].sum()),
                "open": 1.0 - logs["verdicts"].sum() / (2.0 * len(logs)),
                "refused": len(logs) - len(given),
                "seconds": logs["seconds"].mean(),
            }
        )
    return pd.DataFrame(rows)


def _width_ratio(given: pd.DataFrame, reference: pd.DataFrame) -> float:
    """Return the median ratio of the lengths of intervals that both tables have."""
    both = given.merge(reference[reference["given"]], on=KEY, suffixes=("", "_before"))
    before = both["high_percent_before"] - both["low_percent_before"]
    return float(((both["high_percent"] - both["low_percent"]) / before).median())


HEADER = (
    f"{'row':22} {'logs':>5} {'given':>5} {'coverage':>8} {'bias %':>7} {'width':>6}"
    f" {'wrong/verdicts':>14} {'open':>5} {'class C':>7} {'s/log':>6}"
)
"""Titles of ``lines``."""


def lines(figures: pd.DataFrame) -> Iterator[str]:
    """Yield a line of text for each row of a summary."""
    for row in figures.itertuples():
        yield (
            f"{row.row:22} {row.logs:5d} {row.given:5d} {row.coverage:8.3f} {100 * row.bias:7.1f}"
            f" {row.width_ratio:6.3f} {f'{row.wrong}/{row.verdicts}':>14} {row.open:5.2f}"
            f" {row.refused:7d} {row.seconds:6.3f}"
        )
