"""Statistics of flights with a sniffer: bias, spread, coverage, and calls of ships.

Flights with the same seed, such as those at the points of a sweep, have the same sniffer in the
same air. Each seed therefore counts as one sample, with the mean over its flights.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from common.intervals import shared_interval

METHODS = {"regression": "fsc", "areas": "areas_fsc"}
"""Evaluation methods, with the prefix of their columns."""

_FIGURES = ("", "low_", "high_", "uncertainty_", "noise_", "separate_")
"""Column prefixes of a result: estimate, bounds, parts of the uncertainty, separate passes."""

COLUMNS = (
    "flight_id",
    "seed",
    "sensor",
    "fsc_fuel_percent",
    "fsc_expected_percent",
    "sulphur_limit_percent",
    "sulphur_verdict",
    "verdict_2min",
    "areas_fsc_separate_percent",
    *(
        f"{method}_{figure}percent"
        for method in METHODS.values()
        for figure in _FIGURES
        if figure != "separate_"
    ),
)
"""Columns of the summary that these statistics use."""

_CALLED_BY = ["sensor", "sulphur_limit_percent", "fsc_fuel_percent"]
"""Columns that define a point of the operating curve."""

Array = npt.NDArray[np.float64]
Json = dict[str, Any]


def sulphur_statistics(rows: pd.DataFrame, *, confidence: float) -> Json:
    """Return the content of ``sulphur.json``.

    Parameters
    ----------
    rows : columns ``COLUMNS`` of the summary, a row per flight
    confidence : confidence of each interval, between 0 and 1
    """
    rows = rows.reset_index(drop=True)
    return {
        "confidence": confidence,
        "accuracy": [
            _accuracy(group, confidence) | named for named, group in _accuracy_groups(rows)
        ],
        "operating_curve": [
            _calls(group, confidence) | {"sensor": str(group["sensor"].iloc[0])}
            for _, group in rows.dropna(subset="fsc_fuel_percent").groupby(_CALLED_BY)
        ],
    }


def _accuracy_groups(rows: pd.DataFrame) -> Iterator[tuple[Json, pd.DataFrame]]:
    """Yield flights by sensor and method, and by sulphur content that several flights share."""
    for sensor, of_sensor in rows.groupby("sensor"):
        for method, prefix in METHODS.items():
            figures = {f"{prefix}_{of}percent": f"{of}percent" for of in _FIGURES}
            known = [
                name
                for name in ("fsc_fuel_percent", "fsc_expected_percent", *figures)
                if name in of_sensor
            ]
            # A flight without a result or its uncertainty is left out.
            named = (
                of_sensor[known]
                .rename(columns=figures)
                .astype(np.float64)
                .dropna()
                .join(of_sensor["seed"])
            )
            if len(named):
                yield {"sensor": str(sensor), "method": method, "fsc_fuel_percent": None}, named
            for _, group in named.groupby("fsc_fuel_percent"):
                if 1 < len(group) < len(named):
                    yield (
                        {"sensor": str(sensor), "method": method, "fsc_fuel_percent": _fuel(group)},
                        group,
                    )


def _accuracy(flights: pd.DataFrame, confidence: float) -> Json:
    expected = flights["fsc_expected_percent"].to_numpy(dtype=np.float64)
    found = flights["percent"].to_numpy(dtype=np.float64)
    error = found - expected
    inside = (flights["low_percent"] <= expected) & (expected <= flights["high_percent"])
    n, errors = len(flights), _by_seed(pd.Series(error, flights.index), flights)
    return {
        "flights": n,
        "bias_percent": float(np.mean(error)),
        "bias_relative": _share(error, expected),
        "bias_standard_error_percent": float(np.std(errors, ddof=1) / np.sqrt(len(errors)))
        if len(errors) > 1
        else None,
        "spread_percent": float(np.std(error, ddof=1)) if n > 1 else None,
        "stated_percent": float(
            np.sqrt(np.mean(flights["uncertainty_percent"].to_numpy(dtype=np.float64) ** 2))
        ),
        "stated_noise_percent": float(
            np.sqrt(np.mean(flights["noise_percent"].to_numpy(dtype=np.float64) ** 2))
        ),
        "coverage": float(inside.mean()),
        "coverage_interval": _interval(inside, flights, confidence),
        "share_read": _share(found, expected),
        "share_predicted": _share(found, flights["separate_percent"].to_numpy())
        if "separate_percent" in flights
        else 1.0,
    }


def _by_seed(values: "pd.Series[Any]", flights: pd.DataFrame) -> Array:
    """Return the mean of a figure over the flights of each seed."""
    means: Array = values.groupby(flights["seed"]).mean().to_numpy(dtype=np.float64)
    return means


def _interval(events: "pd.Series[bool]", flights: pd.DataFrame, confidence: float) -> list[float]:
    """Return the interval of an event's probability; flights of one seed count as one."""
    found = shared_interval(events.to_numpy(dtype=np.bool_), flights["seed"].to_numpy(), confidence)
    return [found.low, found.high]


def _share(part: Array, whole: Array) -> float | None:
    """Return the ratio of two means, or None if the denominator is 0, as without sulphur."""
    return float(np.mean(part) / np.mean(whole)) if np.mean(whole) > 0.0 else None


def _calls(flights: pd.DataFrame, confidence: float) -> Json:
    """Return how often ships with one fuel were called above a limit, finally and after 2 min."""
    called: Json = {}
    for name, column in (("above", "sulphur_verdict"), ("above_2min", "verdict_2min")):
        above = flights[column] == "above"
        called[name] = float(above.mean())
        called[f"{name}_interval"] = _interval(above, flights, confidence)
    open_share = float((flights["sulphur_verdict"] == "open").mean())
    limit = float(flights["sulphur_limit_percent"].iloc[0])
    return {
        "flights": len(flights),
        "fsc_fuel_percent": _fuel(flights),
        "limit_percent": limit,
        "open": open_share,
    } | called


def _fuel(flights: pd.DataFrame) -> float:
    """Return the common sulphur content of flights [% m/m]."""
    return float(flights["fsc_fuel_percent"].iloc[0])
