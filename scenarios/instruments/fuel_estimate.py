"""Estimate the fuel's sulphur from a sniffer's readings: figures of a flight, a table over time,
and data for the report.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from common.columns import Column, described
from common.run_layout import SULPHUR_TABLE
from measurement.errors import MeasurementError
from measurement.sniffer.sniffer import Readings
from measurement.sniffer.spec import SnifferSpec

if TYPE_CHECKING:
    import pandas as pd

    from measurement.estimate.repeated import RepeatedVerdict
    from measurement.estimate.result import FscEstimate
    from measurement.rules import DecisionRule

_INTERVAL = 60.0
"""About the time between estimates of a flight [s]: the time to a verdict is known to that."""

FIGURES = described(
    {
        "sensor": Column("preset of the sniffer, or the title of the user's own", kind="text"),
        "fsc_fuel_percent": Column(
            "sulphur in the fuel, by mass", title="Sulphur in the fuel", digits=4
        ),
        "fsc_expected_percent": Column(
            "fuel sulphur content that a perfect instrument measures",
            title="Sulphur content that a perfect instrument finds",
            digits=4,
        ),
        "sulphur_limit_percent": "limit of the sulphur content on which the verdict is given",
        "fsc_percent": Column(
            "fuel sulphur content by regression", title="Sulphur content found", digits=4
        ),
        "fsc_uncertainty_percent": Column(
            "standard uncertainty of the fuel sulphur content",
            title="Uncertainty of the sulphur content, 1σ",
            digits=4,
            worse="higher",
        ),
        "fsc_noise_percent": Column(
            "part of the uncertainty that a longer measurement reduces",
            title="Part of it by noise",
            digits=4,
            worse="higher",
        ),
        "fsc_common_percent": "part of the uncertainty that a longer measurement does not reduce",
        "fsc_low_percent": "lower end of the 95 % interval",
        "fsc_high_percent": "upper end of the 95 % interval",
        "areas_fsc_percent": "fuel sulphur content by areas",
        "areas_fsc_uncertainty_percent": "standard uncertainty of the fuel sulphur content by"
        " areas",
        "areas_fsc_separate_percent": "fuel sulphur content by areas if passes did not overlap",
        "areas_fsc_noise_percent": "part of that uncertainty that a longer measurement reduces",
        "areas_fsc_low_percent": "lower end of the 95 % interval",
        "areas_fsc_high_percent": "upper end of the 95 % interval",
        "sulphur_quality": Column("class A, B or C of the result", kind="text"),
        "sulphur_reason": Column("reason for a class other than A", kind="text"),
        "sulphur_verdict": Column("above, below or open", kind="text"),
        "probability_above": "probability that the fuel is above the limit",
        "verdict_2min": Column("verdict after two minutes", kind="text"),
        "verdict_time_s": "time from which on the verdict does not change any more",
        "co2_signal_to_noise": "signal-to-noise ratio of the CO2 readings",
        "so2_signal_to_noise": "signal-to-noise ratio of the SO2 readings",
        "sulphur_suspect": Column(
            "whether payload.rule reports the ship as suspect; empty without a rule, or of quality"
            " C",
            title="Reported as suspect",
            kind="truth",
        ),
        "suspect_false_alarm": Column(
            "share of fuels at the rule's limit that it reports, with this uncertainty",
            title="False alarms of the rule",
            digits=3,
        ),
        "suspect_miss": Column(
            "share of fuels of twice that limit that it does not report, with this uncertainty",
            title="Misses of the rule",
            digits=3,
        ),
    }
)
"""Columns of the summary."""

TABLES = {
    SULPHUR_TABLE: described(
        {
            "elapsed_s": "time since settling",
            "fsc_percent": Column(
                "fuel sulphur content from the readings up to then",
                title="Sulphur content found",
                digits=4,
            ),
            "noise_percent": "standard uncertainty by noise",
            "total_percent": "standard uncertainty",
            "low_percent": "lower end of the 95 % interval",
            "high_percent": "upper end of the 95 % interval",
            "quality": Column("class A, B or C", kind="text"),
            "passes": "peaks of CO2 in the readings up to then, each of 5 times its noise or more",
            "verdict": Column("above, below or open", kind="text"),
            "probability_above": "probability that the fuel is above the limit",
        }
    )
}
"""Columns of the table over time."""


@dataclass(frozen=True, kw_only=True)
class FuelEstimate:
    """The estimate of the fuel after a flight.

    Attributes
    ----------
    figures, over_time : of the summary, and rows of ``SULPHUR_TABLE``
    document : record of the analysis, and the signals of its readings
    """

    figures: dict[str, Any]
    over_time: list[dict[str, Any]] = field(default_factory=list)
    document: Mapping[str, Any] | None = None


def fuel_estimate(
    readings: Readings,
    instrument: SnifferSpec,
    *,
    limit: float,
    expected: float,
    rule: "DecisionRule | None" = None,
) -> FuelEstimate:
    """Return the estimate of the fuel from readings, by regression and by areas.

    Parameters
    ----------
    readings : from settling on
    instrument : instrument by its data sheet; the analyst knows nothing else
    limit : limit for the verdict [% m/m]
    expected : sulphur content that a perfect instrument would read [% m/m]
    rule : rule by which the ship is reported, or None
    """
    from measurement.estimate.estimator import time_to_verdict
    from measurement.estimate.verdict import OPEN
    from measurement.log.analysis import analyse

    try:
        found = analyse(
            readings, instrument, limits_percent=(limit,), points=_points(readings), rule=rule
        )
    except MeasurementError as error:
        return FuelEstimate(
            figures={"sulphur_quality": "C", "sulphur_reason": str(error), "sulphur_verdict": OPEN}
        )
    by, verdict = found.estimate, found.estimate.verdicts[0]
    figures = _figures(by, "fsc")
    if found.other:
        separate = found.other.fsc_percent + found.other.overlap_percent
        figures |= _figures(found.other, "areas_fsc") | {"areas_fsc_separate_percent": separate}
    figures |= {
        "fsc_common_percent": math.sqrt(sum(value**2 for value in by.common_percent.values())),
        "sulphur_quality": by.quality,
        "sulphur_reason": "; ".join(by.quality_reasons),
        "sulphur_verdict": verdict.verdict,
        "probability_above": verdict.probability_above,
        "verdict_2min": _verdict_after(found.table, 120.0, f"verdict_{limit:g}"),
        "verdict_time_s": time_to_verdict(found.table, limit),
        "co2_signal_to_noise": by.figures.co2_snr,
        "so2_signal_to_noise": by.figures.so2_snr,
    }
    if found.decision is not None:
        figures |= {
            "sulphur_suspect": found.decision.suspect,
            "suspect_false_alarm": found.decision.false_alarm,
            "suspect_miss": found.decision.miss,
        }
    named = found.table.rename(columns=lambda name: name.removesuffix(f"_{limit:g}"))
    signals = {str(name): np.round(values, 4).tolist() for name, values in by.signals.items()}
    return FuelEstimate(
        figures=figures,
        over_time=[
            {str(name): value for name, value in row.items()} for row in named.to_dict("records")
        ],
        document=found.record(expected) | {"signals": signals},
    )


def repeated_figures(verdict: "RepeatedVerdict", row: Mapping[str, Any]) -> dict[str, Any]:
    """Return the figures of a flight that evaluated its verdict repeatedly; the last look is at its
    end.

    Parameters
    ----------
    verdict : verdict from the looks in flight
    row : figures of the flight, those of ``fuel_estimate`` among them
    """
    from measurement.estimate.verdict import OPEN

    admitted = row.get("sulphur_quality", "C") != "C"
    if admitted:
        verdict.look(
            row["fsc_percent"],
            noise=row["fsc_noise_percent"],
            total=row["fsc_uncertainty_percent"],
            admitted=True,
            last=True,
        )
    return {
        # An earlier verdict is not valid if the whole record is refused.
        "sulphur_verdict": verdict.verdict if admitted else OPEN,
        "verdict_looks": verdict.looks,
        "verdict_guard": verdict.guard if admitted else math.nan,
    }


def with_verdict(document: Mapping[str, Any] | None, verdict: str) -> Mapping[str, Any] | None:
    """Return the record of an analysis with the verdict of a flight that looked repeatedly."""
    if document is None:
        return None
    found = document["estimate"]
    verdicts = [one | {"verdict": verdict} for one in found["verdicts"]]
    return {**document, "estimate": {**found, "verdicts": verdicts}}


def _points(readings: Readings) -> int:
    """Return the number of evenly spaced times at which the estimate is repeated."""
    return (
        max(1, round(float(readings.time[-1] - readings.time[0]) / _INTERVAL))
        if len(readings)
        else 0
    )


def _verdict_after(table: "pd.DataFrame", elapsed: float, name: str) -> str:
    """Return the verdict after some time [s]; open before there is one."""
    from measurement.estimate.verdict import OPEN

    known = table.loc[table["elapsed_s"] <= elapsed, name]
    return str(known.iloc[-1]) if len(known) else OPEN


def _figures(found: "FscEstimate", name: str) -> dict[str, Any]:
    return {
        f"{name}_percent": found.fsc_percent,
        f"{name}_uncertainty_percent": found.total_percent,
        f"{name}_noise_percent": found.noise_percent,
        f"{name}_low_percent": found.low_percent,
        f"{name}_high_percent": found.high_percent,
    }
