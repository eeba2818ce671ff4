"""What a measured flight's directory holds, and when, where and with what it was measured."""

import json
from typing import Any

import numpy as np
import pandas as pd

from common.files import is_file
from common.run_layout import ESTIMATE, SAMPLES
from common.text import moment, span_words
from measurement.log.analysis import Gaps
from measurement.log.read import FROM_LOG
from measurement.sniffer.spec import sensor_preset, sensor_presets
from reports.document.blocks import Fact
from reports.errors import ReportError
from reports.run.columns import Array, Mask, column, flights_flown
from reports.run.flight_config import flight_configs
from reports.run.run_data import RunData

Record = dict[str, Any]
"""What ``estimate.json`` holds: ``estimate``, ``other``, ``over_time``, ``time_to_verdict_s``,
``instrument``, ``true_percent``, and of a logged flight ``flight``."""

METHODS = {"regression": "equalise and regress", "areas": "areas of passes"}
"""Methods of an estimate, in words."""

_APART = 1.5
"""Samples that are farther apart, over their period, have a gap between them: shorter ones are
bridged.
"""

SINCE = "the record began"
"""What the time of an estimate is counted from, where nothing else is said."""


def read_estimate(run: RunData) -> Record:
    """Return the estimate of a measured flight.

    Raises
    ------
    ReportError : there is none that can be read, without which there is nothing to report
    """
    try:
        record = json.loads((run.path / ESTIMATE).read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise ReportError(
            f"'{run.path}': {ESTIMATE} cannot be read: {error}; measure the flight again"
        ) from None
    if not (
        isinstance(record, dict)
        and (isinstance(record.get("estimate"), dict) or record.get("gases"))
    ):
        raise ReportError(f"'{run.path}': {ESTIMATE} holds no estimate; measure the flight again")
    return record


def read_samples(run: RunData) -> pd.DataFrame | None:
    """Return readings and signals by time, or None if there are none that can be read."""
    if not is_file(run.path / SAMPLES):
        return None
    try:
        table = pd.read_csv(run.path / SAMPLES)
        return table.astype(np.float64) if "time_s" in table else None
    except (ValueError, OSError):
        run.unread.add(SAMPLES)
        return None


def value(record: Record, name: str) -> float:
    """Return a figure of an estimate; not a number where it is not known."""
    found = record.get(name)
    return float("nan") if found is None else float(found)


def over_time(record: Record) -> pd.DataFrame:
    """Return the estimate over time, a row per elapsed time at which there is one."""
    table = pd.DataFrame(record["over_time"])
    return table[column(table, "total_percent") > 0.0] if len(table) else table


def errors(record: Record) -> list[tuple[str, float]]:
    """Return the parts of the uncertainty by their words, the largest first, noise among them
    [% m/m].
    """
    found = record["estimate"]
    parts = {"noise": value(found, "noise_percent"), **found["common_percent"]}
    named = [
        (WORDS.get(name, name), float(part))
        for name, part in parts.items()
        if part is not None and np.isfinite(part)
    ]
    return sorted(named, key=lambda item: -item[1])


WORDS = {
    "noise": "noise",
    "calibration": "calibration of SO2, CO2",
    "no": "correction for NO",
    "no2": "correction for NO2",
    "response": "response and delay",
    "carbon": "carbon content",
    "overlap": "overlapping passes",
    "sampling": "time between readings",
}
"""Parts of the uncertainty."""


def share_read(found: Array, expected: Array) -> Array:
    """Return what was found over what a perfect instrument reads [-]; not a number for a fuel
    without sulphur.
    """
    return found / np.where(expected > 0.0, expected, np.nan)


def measured_minutes(run: RunData, rows: pd.DataFrame) -> Array:
    """Return for how long each flight's readings were evaluated [min]: its last
    ``flight.measured_s``, or since it had settled.
    """
    duration = column(rows, "duration_s")
    windows = [config.get("flight", {}).get("measured_s") for config in flight_configs(run, rows)]
    window = np.array([np.nan if seconds is None else float(seconds) for seconds in windows])
    measured = np.where(
        np.isnan(window), duration - column(rows, "settling_time_s"), np.fmin(window, duration)
    )
    minutes: Array = measured / 60.0
    return minutes


def after_gap(samples: pd.DataFrame) -> Mask:
    """Return which samples follow a gap of the log: they are farther than others from the one
    before.
    """
    steps = np.diff(column(samples, "time_s"))
    return (
        np.concatenate([[False], steps > _APART * np.median(steps)])
        if len(steps)
        else np.zeros(len(samples), dtype=np.bool_)
    )


def in_parts(samples: pd.DataFrame) -> pd.DataFrame:
    """Return samples with an empty row in each gap of the log, where a line through them ends."""
    order = np.arange(len(samples), dtype=np.float64)
    return samples.set_axis(order).reindex(
        np.sort(np.concatenate([order, order[after_gap(samples)] - 0.5]))
    )


def finite(*columns: Array) -> bool:
    """Return whether each column has a number."""
    return all(bool(np.isfinite(values).any()) for values in columns)


_TIMES = "Time (UTC)"

_CONFIGURED = " (by the configuration)"


def position_words(latitude: float, longitude: float) -> str:
    """Return a place [deg] to a metre: 57.20000° N, 11.30000° E."""
    longitude = (longitude + 180.0) % 360.0 - 180.0
    return (
        f"{abs(latitude):.5f}° {'N' if latitude >= 0.0 else 'S'}, {abs(longitude):.5f}°"
        f" {'E' if longitude >= 0.0 else 'W'}"
    )


def logged_facts(run: RunData, record: Record) -> list[Fact]:
    """Return what an inspector has to know of a logged flight, and what is missing of that."""
    flight, manifest = record["flight"], run.manifest
    details = flight["details"]
    operator = [Fact("Operator", details["operator"] + _CONFIGURED)] if details["operator"] else []
    version = f"plume-flight-study {manifest.get('version', 'of a version that is not recorded')}"
    return [
        Fact(_TIMES, _time_words(flight)),
        Fact("Place", _place_words(flight)),
        Fact("Ship", "; ".join([_ship_words(details), *flight.get("ships", ())])),
        *operator,
        Fact(
            "Instrument",
            record["instrument"]["title"]
            + "; its figures are in “Instrument and assumptions”"
            * (record["estimate"] is not None),
        ),
        Fact(
            "Log",
            f"{manifest['source']}, {flight['readings']:,} rows, SHA-256 {manifest['source_hash']}",
        ),
        *(Fact(*remark) for remark in Gaps(**record["gaps"]).remarks.items()),
        Fact("Program", f"{version}, source revision {manifest['git_revision']}"),
    ]


def _time_words(flight: dict[str, Any]) -> str:
    first, last = moment(flight["first_utc"]), moment(flight["last_utc"])
    if first is None or last is None:
        if day := flight["details"]["day"]:
            return f"{day}{_CONFIGURED}; the time of day is not in the log, whose times are seconds"
        return "not in the log, whose times are seconds, and not in the configuration"
    if flight["utc_from"] != FROM_LOG:
        return f"{span_words(first, last)} (start by the configuration; the log counts seconds)"
    return (
        f"{span_words(first, last)} (by the"
        f" log{'' if flight['offset'] else ', whose times have no offset: taken as UTC'})"
    )


def _place_words(flight: dict[str, Any]) -> str:
    named = flight["details"]["place"]
    place = f"{named}{_CONFIGURED}; " if named else ""
    remark = f"; {flight['place_remark']}" if flight["place_remark"] else ""
    if flight["first_position"] is None:
        return f"{place}latitude and longitude are not in the log{remark}"
    first, last = (position_words(*flight[f"{end}_position"]) for end in ("first", "last"))
    return f"{place}from {first} to {last} (first and last of the log){remark}"


def _ship_words(details: dict[str, Any]) -> str:
    numbers = [
        f"{name.upper()} {details[name]}" for name in ("imo", "mmsi") if details[name] is not None
    ]
    named = ", ".join(part for part in (details["vessel"], *numbers) if part)
    return named + _CONFIGURED if named else "not named in the configuration"


def flown_facts(run: RunData) -> list[Fact]:
    """Return which instruments simulated flights measured with, if any, and place and time where
    their scenario has them.
    """
    rows, facts = flights_flown(run.summary), list[Fact]()
    if "sensor" in rows and len(measured := rows[rows["sensor"].notna()]):
        rows, sensors = measured, [_sensor_words(str(name)) for name in measured["sensor"].unique()]
        facts.append(Fact("Instrument" if len(sensors) == 1 else "Instruments", "; ".join(sensors)))
    if place := _places(rows):
        facts.append(Fact("Place", place))
    if times := _times(rows):
        facts.append(Fact(_TIMES, times))
    return facts


def _sensor_words(name: str) -> str:
    return f"{sensor_preset(name).title} ({name})" if name in sensor_presets() else name


def _places(rows: pd.DataFrame) -> str:
    """Return where the ship was at time 0."""
    known = (
        pd.DataFrame(
            {name: column(rows, f"place_{name}_deg") for name in ("latitude", "longitude")}
        )
        .dropna()
        .drop_duplicates()
    )
    if not len(known):
        return ""
    words = [
        position_words(latitude, longitude) for latitude, longitude in known.itertuples(index=False)
    ]
    more = f", and {len(words) - 1:,} more" if len(words) > 1 else ""
    return f"{words[0]}{more} (the ship at time 0, by the scenario)"


def _times(rows: pd.DataFrame) -> str:
    """Return when the flights were, from the first one's start to the last one's end."""
    starts = [moment(text) for text in rows["start_utc"]] if "start_utc" in rows else []
    spans = [
        (start, start + pd.Timedelta(seconds=float(seconds)))
        for start, seconds in zip(starts, np.nan_to_num(column(rows, "duration_s")), strict=False)
        if start is not None
    ]
    if not spans:
        return ""
    return (
        f"{span_words(min(first for first, _ in spans), max(last for _, last in spans))} (by the"
        " scenario)"
    )
