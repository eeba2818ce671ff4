"""What a sniffer's readings say of the fuel: figures of a flight, a table over time, and what a report draws."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pandas as pd

from common.run_layout import SULPHUR_TABLE
from measurement.errors import MeasurementError
from measurement.estimate import FscEstimate, estimate, over_time, time_to_verdict
from measurement.sniffer.sniffer import Readings
from measurement.sniffer.spec import SnifferSpec

ELAPSED = (30.0, 60.0, 90.0, 120.0, 180.0, 240.0, 300.0, 450.0, 600.0, 900.0, 1200.0)
"""Times after settling at which the estimate is made anew [s]."""

_SHOWN = ("fsc_percent", "noise_percent", "total_percent", "low_percent", "high_percent")

FIGURES = (
    "sensor", "fsc_fuel_percent", "fsc_expected_percent", "sulphur_limit_percent", "fsc_percent", "fsc_uncertainty_percent",
    "fsc_noise_percent", "fsc_common_percent", "fsc_low_percent", "fsc_high_percent", "areas_fsc_percent",
    "areas_fsc_uncertainty_percent", "areas_fsc_noise_percent", "areas_fsc_low_percent", "areas_fsc_high_percent",
    "sulphur_quality", "sulphur_reason", "sulphur_verdict", "probability_above", "verdict_2min", "verdict_time_s",
    "co2_signal_to_noise", "so2_signal_to_noise",
)  # fmt: skip
"""Columns of the summary."""

TABLES = {SULPHUR_TABLE: ("elapsed_s", *_SHOWN, "quality", "passes", "verdict", "probability_above")}
"""Columns of the table over time."""


@dataclass(frozen=True, kw_only=True)
class FuelEstimate:
    """What is known of the fuel after a flight.

    Attributes
    ----------
    figures, over_time : of the summary, and rows of ``SULPHUR_TABLE``
    document : the estimates by method, their signals, and how the first one came about over time
    """

    figures: dict[str, Any]
    over_time: list[dict[str, Any]] = field(default_factory=list)
    document: Mapping[str, Any] | None = None


def fuel_estimate(readings: Readings, instrument: SnifferSpec, *, limit: float) -> FuelEstimate:
    """Return what readings say of the fuel, by regression and by areas.

    Parameters
    ----------
    readings : from settling on
    instrument : as its data sheet says, which is all that the analyst knows
    limit : that the verdict is on [% m/m]
    """
    try:
        found = estimate(readings, instrument, limits_percent=(limit,))
        areas = estimate(readings, instrument, method="areas", limits_percent=(limit,))
    except MeasurementError as error:
        return FuelEstimate(figures={"sulphur_quality": "C", "sulphur_reason": str(error), "sulphur_verdict": "open"})
    end = float(readings.time[-1] - readings.time[0])
    table = over_time(readings, instrument, elapsed_s=[*(t for t in ELAPSED if t < end), end], limits_percent=(limit,))
    table = table.rename(columns={f"verdict_{limit:g}": "verdict", f"probability_above_{limit:g}": "probability_above"})
    verdict = found.verdicts[0]
    figures = _figures(found, "fsc") | _figures(areas, "areas_fsc")
    figures |= {
        "fsc_common_percent": math.sqrt(sum(value**2 for value in found.common_percent.values())),
        "sulphur_quality": found.quality,
        "sulphur_reason": "; ".join(found.quality_reasons),
        "sulphur_verdict": verdict.verdict,
        "probability_above": verdict.probability_above,
        "verdict_2min": _verdict_after(table, 120.0),
        "verdict_time_s": time_to_verdict(table.rename(columns={"verdict": f"verdict_{limit:g}"}), limit),
        "co2_signal_to_noise": found.figures.co2_snr,
        "so2_signal_to_noise": found.figures.so2_snr,
    }
    document = {"estimate": found.record(), "areas": areas.record(), "over_time": table.to_dict("list")}
    rows = [{str(name): value for name, value in row.items()} for row in table.to_dict("records")]
    signals = {name: np.round(values, 4).tolist() for name, values in found.signals.items()}
    return FuelEstimate(figures=figures, over_time=rows, document=document | {"signals": signals})


def _verdict_after(table: pd.DataFrame, elapsed: float) -> str:
    """Return the verdict after some time [s]; open before there is one."""
    known = table.loc[table["elapsed_s"] <= elapsed, "verdict"]
    return str(known.iloc[-1]) if len(known) else "open"


def _figures(found: FscEstimate, name: str) -> dict[str, Any]:
    return {
        f"{name}_percent": found.fsc_percent,
        f"{name}_uncertainty_percent": found.total_percent,
        f"{name}_noise_percent": found.noise_percent,
        f"{name}_low_percent": found.low_percent,
        f"{name}_high_percent": found.high_percent,
    }
