"""What flights with a sniffer show of the fuel, one flight as a client reads it; how many are
judged is in ``reports.measurement.method``.
"""

from typing import Any

import numpy as np
import pandas as pd

from measurement.estimate.verdict import (
    ABOVE,
    BELOW,
    OPEN,
    REJECTED,
    content_words,
    probability,
    repeated_words,
    suspect_words,
    verdict_words,
)
from measurement.gases import MASS_PERCENT, limit_words
from reports.document.blocks import Block, Card, Section, Text
from reports.document.chart import Chart
from reports.document.tables import number
from reports.measurement.charts import (
    budget_chart,
    channels_chart,
    over_time_chart,
    regression_chart,
)
from reports.measurement.content import gas_blocks
from reports.measurement.data import Record, share_read
from reports.measurement.method import (
    interval_words,
    measured_flights,
    method_blocks,
    method_cards,
    method_headline,
    sulphur_track_chart,
)
from reports.measurement.tables import result_table
from reports.measurement.verdict import CONTENT_NAME, fuel_card
from reports.run.columns import column, flights_flown
from reports.run.flight_config import flight_config
from reports.run.run_data import RunData
from reports.run.surroundings import surroundings
from reports.run.time_history import keepout_distance
from reports.run.trials import Name

_LARGEST = "Measurement of the flight with the largest relative error"
"""Title of the section on it: only flights whose signals were kept count."""

_TRUTH = (
    "The simulated fuel holds {fuel:.3f} %; a perfect instrument would read {expected:.3f} %,"
    " because some sulphur leaves as sulphate."
)
_CALLED = {ABOVE: "Above the limit", BELOW: "Below the limit", OPEN: "Inconclusive"}
_ONE_RESULT = (
    "{called}: fuel sulphur {content} % ({low} to {high}), limit {limit}; {chance} chance of being"
    " above"
)
_WITHOUT_VERDICT = (
    "No verdict, as quality C gives none: fuel sulphur {content} % ({low} to {high}), limit {limit}"
)


def sulphur_sections(run: RunData, name: Name) -> list[Section]:
    """Return the sections of a run whose flights measured the fuel, and none of any other; ``name``
    is that of a flight.
    """
    measured = measured_flights(run)
    if not len(measured):
        return []
    shown = _flight(run, measured, name)
    if shown is not None and len(measured) == 1:
        return [shown]
    whole = Section(anchor="sulphur", title="Fuel sulphur content", blocks=method_blocks(run, name))
    return [whole, shown] if shown is not None else [whole]


def sulphur_cards(run: RunData) -> list[Card]:
    """Return what was measured of the fuel; nothing of a run without."""
    measured = measured_flights(run)
    if not len(measured):
        return []
    if len(measured) == 1:
        row = measured.iloc[0]
        return [
            Card(
                CONTENT_NAME,
                number(row["fsc_percent"], f"{{:z.3f}} {MASS_PERCENT}"),
                note=f"95 % interval {interval_words(row)} %",
            ),
            fuel_card(
                float(row["sulphur_limit_percent"]),
                str(row["sulphur_verdict"]),
                float(row["probability_above"]),
                str(row["sulphur_quality"]),
            ),
        ]
    return method_cards(run)


def sulphur_below(run: RunData) -> bool:
    """Return whether nothing is left to be said of the fuel: the only flight that measured it
    called it below its limit.

    Flights of a study are judged as a method, not by what their ships burn. Where all of them
    measured nothing, all is left.
    """
    if "fsc_percent" not in run.summary:
        return True
    measured = measured_flights(run)
    return len(measured) > 1 or (
        len(measured) == 1 and measured.iloc[0]["sulphur_verdict"] == "below"
    )


def sulphur_remarks(run: RunData) -> list[str]:
    """Return why the only flight that measured the fuel says no more of it, in a line."""
    measured = measured_flights(run)
    if len(measured) != 1 or "sulphur_reason" not in measured:
        return []
    row = measured.iloc[0]
    reason = row["sulphur_reason"]
    is_known = isinstance(reason, str) and bool(reason)
    return [f"Fuel sulphur, quality {row['sulphur_quality']}: {reason}"] if is_known else []


def sulphur_headline(run: RunData) -> str:
    """Return the verdict on the fuel, with its content and interval, in a sentence; no word of a
    run without a sniffer.
    """
    measured, sniffed = measured_flights(run), flights_flown(run.summary)
    if "fsc_percent" not in run.summary:
        return ""
    if not len(measured):
        why = set(sniffed["sulphur_reason"].dropna()) if "sulphur_reason" in sniffed else set()
        reason = f": {why.pop()}" if len(why) == 1 else ""
        return f"No fuel sulphur content from {_flights(len(sniffed))} with a sniffer{reason}"
    if len(measured) == 1:
        row = measured.iloc[0]
        rejected = row["sulphur_quality"] == REJECTED
        words = _WITHOUT_VERDICT if rejected else _ONE_RESULT
        return words.format(
            called=_CALLED.get(row["sulphur_verdict"], ""),
            content=number(row["fsc_percent"], "{:z.3f}"),
            low=number(row["fsc_low_percent"], "{:z.3f}"),
            high=number(row["fsc_high_percent"], "{:z.3f}"),
            limit=limit_words(float(row["sulphur_limit_percent"])),
            chance=probability(float(row["probability_above"])),
        )
    return method_headline(run)


def _flights(count: int) -> str:
    return f"{count:,} flight{'s' * (count != 1)}"


def _content(row: "pd.Series[Any]") -> str:
    return content_words(
        float(row["fsc_percent"]), float(row["fsc_low_percent"]), float(row["fsc_high_percent"])
    )


def _flight(run: RunData, measured: pd.DataFrame, name: Name) -> Section | None:
    """Return the section on the flight with the largest relative error of those whose signals were
    kept.
    """
    shares = share_read(*(column(measured, f"fsc_{of}percent") for of in ("", "expected_")))
    order = np.argsort(-np.nan_to_num(np.abs(shares - 1.0), nan=-1.0), kind="stable")
    for _, row in measured.iloc[order].iterrows():
        flight_id = str(row["flight_id"])
        record, history = run.evaluation(flight_id), run.history(flight_id)
        if record is not None and history is not None:
            samples, since = _samples(record, history), _since(run, row)
            blocks: list[Block | None] = [
                Text(
                    _result_words(row)
                    if len(measured) == 1
                    else f"{name(row)}. {_result_words(row)}"
                ),
                result_table(record),
                _track(run, row, history),
                over_time_chart(record, since),
                budget_chart(record),
                channels_chart(samples, "Time since the start of the flight [s]"),
                regression_chart(samples, record),
                *gas_blocks(record),
            ]
            title = "Fuel sulphur content" if len(measured) == 1 else _LARGEST
            shown = [block for block in blocks if block is not None]
            return Section(anchor="measurement", title=title, blocks=shown)
    return None


def _since(run: RunData, row: "pd.Series[Any]") -> str:
    """Return what the time of an estimate is counted from: where evaluation begins."""
    window = flight_config(run, row).get("flight", {}).get("measured_s")
    return "the flight settled" if window is None else "the evaluation began"


def _track(run: RunData, row: "pd.Series[Any]", history: pd.DataFrame) -> Chart | None:
    """Return the track of a flight once it had settled; None where it never had."""
    settled = history[history["time_s"] >= row["settling_time_s"]]
    if len(settled) < 2:
        return None
    config = flight_config(run, row)
    nearest = int(np.nanargmin(keepout_distance(settled, config)))
    return sulphur_track_chart(settled, surroundings(config, row, settled, nearest))


def _verdict_words(row: "pd.Series[Any]") -> str:
    limit, chance = float(row["sulphur_limit_percent"]), float(row["probability_above"])
    words = verdict_words(str(row["sulphur_verdict"]), limit, chance, str(row["sulphur_quality"]))
    looks, guard = (float(row.get(name, np.nan)) for name in ("verdict_looks", "verdict_guard"))
    return f"{words}{repeated_words(looks, guard)}"


def _result_words(row: "pd.Series[Any]") -> str:
    """Return result and verdict in words, with probability and limit."""
    verdict = f"The fuel's sulphur content is {_content(row)}: {_verdict_words(row)}."
    reason = row["sulphur_reason"]
    quality = f"Quality {row['sulphur_quality']}"
    if reason and pd.notna(reason):
        quality += f": {reason}"
    return f"{verdict} {quality}.{_suspect(row)} " + _TRUTH.format(
        fuel=row["fsc_fuel_percent"], expected=row["fsc_expected_percent"]
    )


def _suspect(row: "pd.Series[Any]") -> str:
    """Return what the rule of the flight makes of the ship, in a sentence; empty without one."""
    names = ("sulphur_suspect", "suspect_false_alarm", "suspect_miss")
    values = [row.get(name) for name in names]
    words = suspect_words(*(float(value) if pd.notna(value) else np.nan for value in values))
    return f" {words[0].upper()}{words[1:]}." if words else ""


def _samples(record: Record, history: pd.DataFrame) -> pd.DataFrame:
    """Return the signals of a flight, with the truth at the times of its readings."""
    samples = pd.DataFrame(record["signals"])
    time = column(samples, "time_s")
    names = {
        "north_m": "north_m",
        "east_m": "east_m",
        "height_m": "altitude_m",
        "co2_true_ppm": "co2_ppm",
        "so2_true_ppb": "so2_ppb",
    }
    known = {
        name: np.interp(time, column(history, "time_s"), column(history, of))
        for name, of in names.items()
    }
    return samples.assign(**known)
