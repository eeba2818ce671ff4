"""A sniffer: its channels and its rate, presets, and the instrument of one flight."""

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from importlib.resources import files
from importlib.resources.abc import Traversable
from typing import Any

import numpy as np

from common.text import did_you_mean
from measurement.errors import MeasurementError, check_keys, check_range, number
from measurement.gases import GASES, UNITS
from measurement.sniffer.channel import Channel
from measurement.species import SLOT, SPECIES, Species

UNTITLED_SNIFFER = "own sniffer"
"""Name of a sniffer from an inline table without a title."""

_SHARE_MIN = 0.2
"""Least share of a stated response time, and of a gain, in the instrument of one flight [-]."""

_UNKNOWN: dict[str, dict[str, Any]] = {
    "so2": {
        "t90_s": 20.0,
        "t90_sd": math.inf,
        "delay_sd_s": math.inf,
        "noise": math.nan,
        "gain_sd": 0.05,
        "zero_sd": 10.0,
        "cross_sd": {"no": 0.02, "no2": 0.8},
    },
    "co2": {
        "t90_s": 3.0,
        "t90_sd": 0.5,
        "noise": math.nan,
        "gain_sd": 0.03,
    },
    "no": {
        "t90_s": 20.0,
        "t90_sd": 0.3,
        "delay_sd_s": 2.0,
        "noise": math.nan,
        "gain_sd": 0.1,
        "zero_sd": 10.0,
    },
    "no2": {
        "t90_s": 30.0,
        "t90_sd": 0.3,
        "delay_sd_s": 2.0,
        "noise": math.nan,
        "gain_sd": 0.1,
        "zero_sd": 10.0,
    },
}
"""Properties of a channel that its table leaves out (assumptions).

t90 and delay of SO2 are then estimated from the record. The SO2 channels of the presets respond to
NO by 0 to 3 %, and to NO2 by 0, by -16 % with a filter, and by -160 % without one.
"""

_T90_KNOWN = 0.1
"""Relative standard deviation of a t90 that is given without one [-]; an assumption."""

UNDECLARED_GAIN_SD = 0.1
"""Standard deviation of the gain of another gas than SO2 that does not state it [-]: that of SO2 of
the instrument that is not specified."""

_DELAY_KNOWN_S = 0.5
"""Standard deviation of a delay that is given without one [s]; an assumption."""

_CROSS_KNOWN = 0.2
"""Relative standard deviation of a cross response given without one [-]; an assumption."""


@dataclass(frozen=True, kw_only=True)
class SnifferSpec:
    """A sniffer by its data sheet and its calibration.

    Attributes
    ----------
    name : in files
    title : in reports
    rate_hz : readings per second [1/s]
    channels : one per gas at most; SO2 and CO2 are needed for an estimate, not for reading
    source : where the figures come from
    compared : what its channel of SO2 reads; another gas may take that place for an estimate
    """

    name: str
    title: str
    rate_hz: float
    channels: tuple[Channel, ...]
    source: str = ""
    compared: Species = SPECIES[SLOT]

    def __post_init__(self) -> None:
        check_range(f"rate of '{self.name}'", self.rate_hz, 0.01, 1000.0, " Hz")
        gases = [channel.gas for channel in self.channels]
        if not gases or len(set(gases)) < len(gases):
            raise MeasurementError(
                f"channels of '{self.name}' are {gases}; it must have one, and one per gas at most"
            )

    def channel(self, gas: str) -> Channel | None:
        """Return the channel of a gas, or None."""
        return next((channel for channel in self.channels if channel.gas == gas), None)

    def known(self, gas: str) -> Channel:
        """Return the channel of a gas.

        Raises
        ------
        MeasurementError : there is none
        """
        channel = self.channel(gas)
        if channel is None:
            raise MeasurementError(
                f"'{self.name}' has no {gas.upper()} channel; it has {', '.join(self.gases)}"
            )
        return channel

    def name_of(self, gas: str) -> str:
        """Return the name of the gas that a channel reads, in words."""
        return self.compared.title if gas == SLOT else gas.upper()

    def unit_of(self, gas: str) -> str:
        """Return the unit of a channel's readings."""
        if gas != SLOT:
            return UNITS[gas]
        step, unit = self.compared.step, self.compared.unit
        return unit if step == 1.0 else f"{step:g} x {unit}"

    @property
    def gases(self) -> tuple[str, ...]:
        """Gases of its channels, in the order of ``GASES``."""
        return tuple(gas for gas in GASES if self.channel(gas))

    def with_channel(self, channel: Channel) -> "SnifferSpec":
        """Return the sniffer with the channel of the same gas replaced."""
        channels = tuple(channel if channel.gas == old.gas else old for old in self.channels)
        return replace(self, channels=channels)

    def check_known(self) -> None:
        """Refuse a sniffer that cannot be flown.

        Raises
        ------
        MeasurementError : response, delay or noise of a channel is not known
        """
        for channel in self.channels:
            if not math.isfinite(channel.t90_sd + channel.delay_sd_s + channel.noise):
                raise MeasurementError(
                    f"t90, delay or noise of {channel.gas} is not known; "
                    "give its t90_s, delay_s and noise to fly it"
                )

    def drawn(self, generator: np.random.Generator) -> "SnifferSpec":
        """Return the instrument of one flight, with sampled properties that are known exactly.

        Raises
        ------
        MeasurementError : response, delay or noise of a channel is not known
        """
        self.check_known()
        return replace(
            self, channels=tuple(_drawn(channel, generator) for channel in self.channels)
        )


def _drawn(channel: Channel, generator: np.random.Generator) -> Channel:
    t90, delay, gain, zero = generator.standard_normal(4)
    cross = {}
    for gas in GASES:
        if gas in channel.cross or gas in channel.cross_sd:
            deviation = channel.cross_sd.get(gas, 0.0) * float(generator.standard_normal())
            cross[gas] = channel.cross.get(gas, 0.0) + deviation
    return replace(
        channel,
        t90_s=channel.t90_s * max(1.0 + channel.t90_sd * t90, _SHARE_MIN),
        delay_s=max(channel.delay_s + channel.delay_sd_s * delay, 0.0),
        gain=channel.gain * max(1.0 + channel.gain_sd * gain, _SHARE_MIN),
        zero=channel.zero + channel.zero_sd * zero,
        cross=cross,
        t90_sd=0.0,
        delay_sd_s=0.0,
        gain_sd=0.0,
        zero_sd=0.0,
        cross_sd={},
    )


def _folder() -> Traversable:
    return files("measurement.sniffer") / "presets"


def sensor_presets() -> tuple[str, ...]:
    """Return the names of the sniffers that come with the program."""
    names = (path.name for path in _folder().iterdir())
    return tuple(sorted(name.removesuffix(".toml") for name in names if name.endswith(".toml")))


def sensor_preset(name: str) -> SnifferSpec:
    """Return a sniffer by its name.

    Raises
    ------
    MeasurementError : there is no instrument of that name
    """
    known = sensor_presets()
    if name not in known:
        raise MeasurementError(
            f"instrument is {name!r}{did_you_mean(name, known) or ';'} there are {', '.join(known)}"
        )
    return sensor_of(tomllib.loads((_folder() / f"{name}.toml").read_text(encoding="utf-8")), name)


def sensor_of(given: str | Mapping[str, Any], name: str = "") -> SnifferSpec:
    """Return a sniffer by the name of a preset, or from an inline table.

    Parameters
    ----------
    given : name, or a table of ``title``, ``rate_hz``, ``source`` and ``channels``, a table of
        tables by gas. Keys of a channel are the fields of ``Channel`` without its gas; those that
        are left out are taken as not known. With a ``cross`` it responds to no other gases.
    name : of a sniffer from a table; its title if empty

    Raises
    ------
    MeasurementError : the name or a key is not known, or a value is not of its kind or range
    """
    if isinstance(given, str):
        return sensor_preset(given)
    name = name or str(given.get("title", UNTITLED_SNIFFER))
    check_keys(given, ("channels", "rate_hz", "source", "title"), f"instrument '{name}'")
    channels = given.get("channels")
    if not isinstance(channels, dict) or not channels:
        raise MeasurementError(
            f"instrument '{name}' has no channels; "
            "give a table [channels.so2], one [channels.co2], and so on"
        )
    return SnifferSpec(
        name=name,
        title=str(given.get("title", name)),
        rate_hz=number(given.get("rate_hz", 1.0), "rate_hz", name),
        channels=tuple(_channel(gas, channels[gas], name) for gas in channels),
        source=str(given.get("source", "")),
    )


def channel_of(gas: str, table: Any = ()) -> Channel:
    """Return the channel of a gas that is compared with CO2, in the place of that of SO2.

    What its table leaves out is not known, like that of SO2, but for a gain that is known to
    ``UNDECLARED_GAIN_SD``; it responds to no other gas.

    Raises
    ------
    MeasurementError : a key is not known, or a value is not of its kind or range
    """
    where = f"channel '{gas}'"
    if not isinstance(table or {}, dict):
        raise MeasurementError(f"{where} is {table!r}; give a table [channels.{gas}]")
    values = dict(table)
    if values.get("cross"):
        raise MeasurementError(f"{where} has a cross; only SO2, NO and NO2 may have one")
    return _channel_of("so2", {"gain_sd": UNDECLARED_GAIN_SD, **values, "cross": {}}, where)


def _channel(gas: str, table: Any, name: str) -> Channel:
    where = f"channel '{gas}' of instrument '{name}'"
    if gas not in GASES or not isinstance(table, dict):
        raise MeasurementError(
            f"{where} is not known; channels are tables called {', '.join(GASES)}"
        )
    return _channel_of(gas, table, where)


def _channel_of(gas: str, table: Mapping[str, Any], where: str) -> Channel:
    """Return the channel in a table; ``where`` names it in errors."""
    check_keys(table, sorted({field.name for field in fields(Channel)} - {"gas"}), where)
    given: dict[str, Any] = dict(_UNKNOWN[gas])
    if "t90_s" in table:
        given["t90_sd"] = _T90_KNOWN
    if "delay_s" in table:
        given["delay_sd_s"] = _DELAY_KNOWN_S
    for key, value in table.items():
        if key not in ("cross", "cross_sd"):
            given[key] = number(value, key, where)
        elif isinstance(value, dict):
            given[key] = {other: number(share, key, where) for other, share in value.items()}
        else:
            raise MeasurementError(
                f"{key} of {where} is {value!r}; it must be a table, as in {{ no = 0.015 }}"
            )
    if "cross" in table and "cross_sd" not in table:
        given["cross_sd"] = {
            other: _CROSS_KNOWN * abs(share) for other, share in given["cross"].items()
        }
    try:
        return Channel(gas=gas, **given)
    except MeasurementError as error:
        raise MeasurementError(f"{where}: {error}") from None
