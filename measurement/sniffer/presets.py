"""Sniffers by name, and sniffers from a TOML table."""

import math
import tomllib
from collections.abc import Mapping
from dataclasses import fields
from importlib.resources import files
from typing import Any

from measurement.errors import MeasurementError, guess, number
from measurement.gases import GASES
from measurement.sniffer.channel import Channel
from measurement.sniffer.spec import SnifferSpec

_FOLDER = "presets"

_UNKNOWN: dict[str, dict[str, Any]] = {
    "so2": {
        "t90_s": 20.0,
        "t90_sd": math.inf,
        "delay_s": 0.0,
        "delay_sd_s": math.inf,
        "noise": math.nan,
        "gain_sd": 0.05,
        "zero_sd": 10.0,
        "cross": {},
        "cross_sd": {"no": 0.02, "no2": 0.8},
    },
    "co2": {
        "t90_s": 3.0,
        "t90_sd": 0.5,
        "delay_s": 0.0,
        "delay_sd_s": 0.0,
        "noise": math.nan,
        "gain_sd": 0.03,
    },
    "no": {
        "t90_s": 20.0,
        "t90_sd": 0.3,
        "delay_s": 0.0,
        "delay_sd_s": 2.0,
        "noise": math.nan,
        "gain_sd": 0.1,
        "zero_sd": 10.0,
    },
    "no2": {
        "t90_s": 30.0,
        "t90_sd": 0.3,
        "delay_s": 0.0,
        "delay_sd_s": 2.0,
        "noise": math.nan,
        "gain_sd": 0.1,
        "zero_sd": 10.0,
    },
}
"""What is taken of a channel where its table says nothing (assumptions): times of SO2 are then
estimated from the record.

Of the presets' SO2 channels the response to NO is 0 to 3 %, and that to NO2 0, -16 % with a filter,
and -160 % without one.
"""

OWN = "own sniffer"
"""What a sniffer from a table is called that has no title."""

_CROSS_KNOWN = 0.2
"""Relative standard deviation of a response to another gas that is given without one, as of the
electrochemical preset's to NO2.
"""


def sensor_presets() -> tuple[str, ...]:
    """Return the names of the sniffers that come with the program."""
    folder = files("measurement.sniffer") / _FOLDER
    return tuple(
        sorted(
            path.name.removesuffix(".toml")
            for path in folder.iterdir()
            if path.name.endswith(".toml")
        )
    )


def sensor_preset(name: str) -> SnifferSpec:
    """Return a sniffer by its name.

    Raises
    ------
    MeasurementError : there is none of that name
    """
    if name not in (known := sensor_presets()):
        raise MeasurementError(
            f"instrument is {name!r}{guess(name, known)} there are {', '.join(known)}"
        )
    text = (files("measurement.sniffer") / _FOLDER / f"{name}.toml").read_text(encoding="utf-8")
    return read_spec(tomllib.loads(text), name)


def sensor_of(given: str | Mapping[str, Any], name: str = "") -> SnifferSpec:
    """Return a sniffer by its name, or from a table, called ``name`` or else by its title. Errors
    as of the two.
    """
    return (
        sensor_preset(given)
        if isinstance(given, str)
        else read_spec(given, name or str(given.get("title", OWN)))
    )


def read_spec(table: Mapping[str, Any], name: str) -> SnifferSpec:
    """Return a sniffer from a table with ``title``, ``rate_hz``, ``source`` and a table per gas in
    ``channels``.

    Keys of a channel are the fields of ``Channel`` without its gas. Those that are left out are
    taken as not known. Where there is a ``cross`` the channel responds to no other gases than
    those.

    Raises
    ------
    MeasurementError : a key is not known, or a value is not of its kind or range
    """
    known = {"title", "rate_hz", "source", "channels"}
    if unknown := sorted(set(table) - known):
        raise MeasurementError(
            f"instrument '{name}' has the key '{unknown[0]}'{guess(unknown[0], known)} it may have {', '.join(sorted(known))}"
        )
    channels = table.get("channels")
    if not isinstance(channels, dict) or not channels:
        raise MeasurementError(
            f"instrument '{name}' has no channels; give a table [channels.so2], one [channels.co2], and so on"
        )
    return SnifferSpec(
        name=name,
        title=str(table.get("title", name)),
        rate_hz=number(table.get("rate_hz", 1.0), "rate_hz", name),
        channels=tuple(_channel(gas, channels[gas], name) for gas in channels),
        source=str(table.get("source", "")),
    )


def _channel(gas: str, table: Any, name: str) -> Channel:
    where = f"channel '{gas}' of instrument '{name}'"
    if gas not in GASES or not isinstance(table, dict):
        raise MeasurementError(
            f"{where} is not known; channels are tables called {', '.join(GASES)}"
        )
    keys = {field.name for field in fields(Channel)} - {"gas"}
    if unknown := sorted(set(table) - keys):
        raise MeasurementError(
            f"{where} has the key '{unknown[0]}'{guess(unknown[0], keys)} it may have {', '.join(sorted(keys))}"
        )
    given: dict[str, Any] = dict(_UNKNOWN[gas])
    # A time that is given without its deviation is taken to be known to 10 %, a delay to 0.5 s
    # (assumptions).
    given |= {"t90_sd": 0.1} if "t90_s" in table else {}
    given |= {"delay_sd_s": 0.5} if "delay_s" in table else {}
    for key, value in table.items():
        if key in ("cross", "cross_sd"):
            if not isinstance(value, dict):
                raise MeasurementError(
                    f"{key} of {where} is {value!r}; give a table, as in {{ no = 0.015 }}"
                )
            given[key] = {other: number(share, key, where) for other, share in value.items()}
        else:
            given[key] = number(value, key, where)
    if "cross" in table and "cross_sd" not in table:
        given |= {
            "cross_sd": {
                other: _CROSS_KNOWN * abs(share) for other, share in given["cross"].items()
            }
        }
    try:
        return Channel(gas=gas, **given)
    except MeasurementError as error:
        raise MeasurementError(f"{where}: {error}") from None
