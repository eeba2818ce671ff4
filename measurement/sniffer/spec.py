"""A sniffer: its channels, its rate, and the instrument that one flight has."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from measurement.errors import MeasurementError
from measurement.gases import GASES
from measurement.sniffer.channel import Channel

_SHORTEST = 0.2
"""Least share of a stated response time, and of a gain, that an instrument of one flight has."""


@dataclass(frozen=True, kw_only=True)
class SnifferSpec:
    """A sniffer by its data sheet and its calibration.

    Attributes
    ----------
    name : what it is called in files
    title : what it is called in reports
    rate_hz : readings in a second [1/s]
    channels : one per gas at most; SO2 and CO2 are needed for an estimate, not for reading
    source : where the figures come from
    """

    name: str
    title: str
    rate_hz: float
    channels: tuple[Channel, ...]
    source: str = ""

    def __post_init__(self) -> None:
        if not 0.01 <= self.rate_hz <= 1000.0:
            raise MeasurementError(
                f"rate of '{self.name}' is {self.rate_hz:g} Hz; it must be 0.01 to 1000"
            )
        gases = [channel.gas for channel in self.channels]
        if not gases or len(set(gases)) < len(gases):
            raise MeasurementError(
                f"channels of '{self.name}' are {gases}; it must have one, and one per gas at most"
            )

    def channel(self, gas: str) -> Channel | None:
        """Return the channel of a gas, or none."""
        for channel in self.channels:
            if channel.gas == gas:
                return channel
        return None

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

    @property
    def gases(self) -> tuple[str, ...]:
        """Gases that it reads, in the order of ``GASES``."""
        return tuple(gas for gas in GASES if self.channel(gas))

    def with_channel(self, channel: Channel) -> "SnifferSpec":
        """Return the sniffer with the channel of the same gas replaced."""
        return replace(
            self,
            channels=tuple(channel if channel.gas == old.gas else old for old in self.channels),
        )

    def check_known(self) -> None:
        """Refuse a sniffer that cannot be flown.

        Raises
        ------
        MeasurementError : response, delay or noise of a channel is not known
        """
        for of in self.channels:
            if not math.isfinite(of.t90_sd + of.delay_sd_s + of.noise):
                raise MeasurementError(
                    f"t90, delay or noise of {of.gas} is not known; give its t90_s, delay_s and noise to fly it"
                )

    def drawn(self, generator: np.random.Generator) -> "SnifferSpec":
        """Return the instrument of one flight: each property sampled within its standard deviation,
        and then known exactly.

        Raises
        ------
        MeasurementError : a property has an infinite standard deviation, from which nothing can be
            sampled
        """
        self.check_known()
        return replace(
            self, channels=tuple(_drawn(channel, generator) for channel in self.channels)
        )


def _drawn(channel: Channel, generator: np.random.Generator) -> Channel:
    t90, delay, gain, zero = generator.standard_normal(4)
    cross = {
        gas: channel.cross.get(gas, 0.0) + sd * float(generator.standard_normal())
        for gas, sd in _deviations(channel).items()
    }
    return replace(
        channel,
        t90_s=channel.t90_s * max(1.0 + channel.t90_sd * t90, _SHORTEST),
        delay_s=max(channel.delay_s + channel.delay_sd_s * delay, 0.0),
        gain=channel.gain * max(1.0 + channel.gain_sd * gain, _SHORTEST),
        zero=channel.zero + channel.zero_sd * zero,
        cross=cross,
        t90_sd=0.0,
        delay_sd_s=0.0,
        gain_sd=0.0,
        zero_sd=0.0,
        cross_sd={},
    )


def _deviations(channel: Channel) -> Mapping[str, float]:
    return {
        gas: channel.cross_sd.get(gas, 0.0)
        for gas in GASES
        if gas in channel.cross or gas in channel.cross_sd
    }
