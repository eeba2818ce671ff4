"""What flights with a sniffer show of the fuel, and of the method: one flight as a client reads it,
many as a method is judged.
"""

from typing import Any

import numpy as np
import pandas as pd

from common.intervals import percent
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
from reports.document.blocks import Block, Card, Fold, Heading, Section, Text
from reports.document.chart import Chart
from reports.document.tables import number
from reports.measurement.charts import (
    budget_chart,
    channels_chart,
    over_time_chart,
    regression_chart,
)
from reports.measurement.data import Record
from reports.measurement.flight_charts import (
    error_chart,
    operating_curve,
    sulphur_track_chart,
    trajectory_chart,
)
from reports.measurement.flight_tables import (
    accuracy_table,
    best_table,
    calls_table,
    flight_table,
    hit_table,
    interval_words,
)
from reports.measurement.tables import over_time_table, result_table
from reports.measurement.verdict import CONTENT_NAME, fuel_card
from reports.run.columns import column, flights_flown
from reports.run.flight_config import flight_config
from reports.run.run_data import RunData
from reports.run.surroundings import surroundings
from reports.run.time_history import keepout_distance
from reports.run.trials import Name

_CALLED = {ABOVE: "Above the limit", BELOW: "Below the limit", OPEN: "Inconclusive"}
_ONE_RESULT = (
    "{called}: fuel sulphur {content} % ({low} to {high}), limit {limit}; {chance} chance of being"
    " above"
)
_WITHOUT_VERDICT = (
    "No verdict, as quality C gives none: fuel sulphur {content} % ({low} to {high}), limit {limit}"
)
_TRUTH = (
    "The simulated fuel holds {fuel:.3f} %; a perfect instrument would read {expected:.3f} %,"
    " because some sulphur leaves as sulphate."
)

_FEW = 8
"""Flights of which figures are not spread: of so few there are no statistics."""


def sulphur_sections(run: RunData, name: Name) -> list[Section]:
    """Return the sections of a run whose flights measured the fuel, and none of any other; ``name``
    is that of a flight.
    """
    measured = _measured(run)
    if not len(measured):
        return []
    shown = _flight(run, measured, name)
    if shown is not None and len(measured) == 1:
        return [shown]
    whole = Section(
        anchor="sulphur", title="Fuel sulphur content", blocks=_blocks(run, measured, name)
    )
    return [whole, shown] if shown is not None else [whole]


def sulphur_cards(run: RunData) -> list[Card]:
    """Return what was measured of the fuel; nothing of a run without."""
    measured = _measured(run)
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
    bias, inside = _bias_and_coverage(measured)
    return [
        Card(
            "Bias of the sulphur content, mean of flights",
            number(bias, f"{{:+.4f}} {MASS_PERCENT}"),
        ),
        Card("Flights whose 95 % interval holds what a perfect instrument reads", percent(inside)),
    ]


def sulphur_below(run: RunData) -> bool:
    """Return whether nothing is left to be said of the fuel: the only flight that measured it
    called it below its limit.

    Flights of a study are judged as a method, not by what their ships burn. Where all of them
    measured nothing, all is left.
    """
    if "fsc_percent" not in run.summary:
        return True
    measured = _measured(run)
    return len(measured) > 1 or (
        len(measured) == 1 and measured.iloc[0]["sulphur_verdict"] == "below"
    )


def sulphur_headline(run: RunData) -> str:
    """Return the verdict on the fuel, with its content and interval, in a sentence; no word of a run
    without a sniffer.
    """
    measured, sniffed = _measured(run), flights_flown(run.summary)
    if "fsc_percent" not in run.summary:
        return ""
    if not len(measured):
        why = set(sniffed["sulphur_reason"].dropna()) if "sulphur_reason" in sniffed else set()
        told = f": {why.pop()}" if len(why) == 1 else ""
        return f"No fuel sulphur content from {_flights(len(sniffed))} with a sniffer{told}"
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
    return (
        "Verdicts on the sulphur limit from {flights:,} flights: {right:,} right, {wrong:,} wrong, {open:,} open"
        ", {without:,} without a result".format(**sulphur_verdicts(run))
    )


def sulphur_verdicts(run: RunData) -> dict[str, int]:
    """Return the numbers of flights of a study whose verdict on the fuel is ``right``, ``wrong`` or
    ``open``, of those ``without`` a result, and of all with a sniffer (``flights``); nothing of a
    run in which fewer than two flights measured the fuel.

    A fuel at the limit is not above it.
    """
    measured = _measured(run)
    if len(measured) < 2:
        return {}
    called = measured["sulphur_verdict"]
    is_above = measured["fsc_fuel_percent"] > measured["sulphur_limit_percent"]
    decided, sniffed = called != OPEN, len(flights_flown(run.summary))
    right = decided & ((called == ABOVE) == is_above)
    return {
        "flights": sniffed,
        "right": int(right.sum()),
        "wrong": int((decided & ~right).sum()),
        "open": int((~decided).sum()),
        "without": sniffed - len(measured),
    }


def _flights(count: int) -> str:
    return f"{count:,} flight{'s' * (count != 1)}"


def _content(row: "pd.Series[Any]") -> str:
    return content_words(
        float(row["fsc_percent"]), float(row["fsc_low_percent"]), float(row["fsc_high_percent"])
    )


def _bias_and_coverage(measured: pd.DataFrame) -> tuple[float, float]:
    """Return the mean error [% m/m], and the fraction of flights whose stated interval holds what a
    perfect instrument reads.
    """
    expected, found = (column(measured, name) for name in ("fsc_expected_percent", "fsc_percent"))
    inside = (column(measured, "fsc_low_percent") <= expected) & (
        expected <= column(measured, "fsc_high_percent")
    )
    return float(np.mean(found - expected)), float(np.mean(inside))


def _measured(run: RunData) -> pd.DataFrame:
    """Return the rows of the flights that have a result."""
    rows = run.summary
    return rows[rows["fsc_percent"].notna()] if "fsc_percent" in rows else rows.iloc[:0]


def _blocks(run: RunData, measured: pd.DataFrame, name: Name) -> list[Block]:
    statistics = run.sulphur
    if len(measured) < _FEW or statistics is None:
        return [flight_table(measured, name)]
    trajectories = trajectory_chart(run, measured)
    designed: list[Block] = (
        []
        if trajectories is None
        else [Heading("Trajectories"), trajectories, best_table(run, measured)]
    )
    curve = operating_curve(statistics)
    return [
        Text(
            "Each result is compared with what a perfect instrument would read. That differs from the fuel's own content by the"
            " sulphur that leaves as sulphate, and by the carbon content that the method assumes. Share read: mean of the"
            " results over mean of that. Predicted: by the closed form of passes that overlap in the slow channel. Covered: the"
            " stated 95 % interval holds it."
        ),
        accuracy_table(statistics),
        error_chart(measured),
        *designed,
        Heading("Ships called above the limit"),
        *([curve] if curve is not None else []),
        calls_table(statistics),
        Heading("How well the plume was hit"),
        hit_table(measured),
    ]


def _flight(run: RunData, measured: pd.DataFrame, name: Name) -> Section | None:
    """Return the section on the first flight whose signals were kept."""
    for _, row in measured.iterrows():
        flight_id = str(row["flight_id"])
        record, history = run.evaluation(flight_id), run.history(flight_id)
        if record is not None and history is not None:
            samples, since = _samples(record, history), _since(run, row)
            table = over_time_table(record, since)
            blocks: list[Block | None] = [
                Text(_told(row) if len(measured) == 1 else f"{name(row)}. {_told(row)}"),
                result_table(record),
                _track(run, row, history),
                over_time_chart(record, since),
                Fold(title="The same as a table", blocks=[table]) if table else None,
                budget_chart(record),
                channels_chart(samples, "Time since the start of the flight [s]"),
                regression_chart(samples, record),
            ]
            title = "Fuel sulphur content" if len(measured) == 1 else "Measurement of one flight"
            shown = [block for block in blocks if block is not None]
            return Section(anchor="measurement", title=title, blocks=shown)
    return None


def _since(run: RunData, row: "pd.Series[Any]") -> str:
    """Return what the time of an estimate is counted from: it begins where readings are evaluated."""
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


def _told(row: "pd.Series[Any]") -> str:
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
