"""When, where, on which ship and with what the fuel was measured: what page 1 says before any
figure.
"""

from typing import Any

import numpy as np
import pandas as pd

from common.text import moment, span_words
from measurement.log.analysis import Gaps
from measurement.log.read import FROM_LOG
from measurement.sniffer.spec import sensor_preset, sensor_presets
from reports.document.blocks import Fact
from reports.measurement.data import Record
from reports.run.columns import column, flights_flown
from reports.run.run_data import RunData

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
    """Return what an inspector has to know of a logged flight; of what nobody has told, that it is
    missing.
    """
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
    told = flight["details"]["place"]
    place = f"{told}{_CONFIGURED}; " if told else ""
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
