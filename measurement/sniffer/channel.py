"""One gas channel of a sniffer: its response, and how well it is known."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from measurement.errors import MeasurementError, check_range
from measurement.gases import GASES, UNITS
from measurement.sniffer.lag import time_constants


@dataclass(frozen=True, kw_only=True)
class Channel:
    """A gas channel. Concentrations are in the unit of its gas: ppm of CO2, ppb of the others.

    It reads ``gain (c + sum of cross k c_k) (1 + pressure_effect dp) + zero``, delayed, through its
    lag, with white noise and a random walk, rounded and cut at its range. A name that ends in
    ``_sd`` is the standard deviation with which the analyst knows a property. It is infinite for a
    t90 and a delay of SO2 that are not known at all: they are estimated from the record.

    Attributes
    ----------
    gas : one of ``GASES``
    t90_s : time to 90 % of a step [s]
    t90_sd : relative standard deviation of that time [-]
    second_pole : second time constant over the first, 0 for a response with one pole [-]
    delay_s : delay of tube and pump [s]
    delay_sd_s : standard deviation of the delay [s]
    noise : standard deviation of a reading; NaN if it is to be estimated from the record [unit]
    random_walk : standard deviation of the zero's drift after one second, growing with the root of
        time [unit/s^0.5]
    resolution : step of the readings, 0 for none [unit]
    range_low, range_high : end of what it can read [unit]
    gain : reading over concentration [-]
    gain_sd : standard deviation of the gain [-]
    zero : reading of clean air [unit]
    zero_sd : standard deviation of the zero [unit]
    cross : response to other gases, in this gas's unit per unit of theirs
    cross_sd : standard deviation of that response, likewise
    pressure_effect : of the reading, relative to it [1/hPa]
    """

    gas: str
    t90_s: float
    noise: float
    t90_sd: float = 0.0
    second_pole: float = 0.0
    delay_s: float = 0.0
    delay_sd_s: float = 0.0
    random_walk: float = 0.0
    resolution: float = 0.0
    range_low: float = -math.inf
    range_high: float = math.inf
    gain: float = 1.0
    gain_sd: float = 0.0
    zero: float = 0.0
    zero_sd: float = 0.0
    cross: Mapping[str, float] = field(default_factory=dict)
    cross_sd: Mapping[str, float] = field(default_factory=dict)
    pressure_effect: float = 0.0

    def __post_init__(self) -> None:
        if self.gas not in GASES:
            raise MeasurementError(f"gas is {self.gas!r}; it must be one of {', '.join(GASES)}")
        time_constants(self.t90_s, self.second_pole)
        for name in (
            "t90_sd",
            "delay_s",
            "delay_sd_s",
            "random_walk",
            "resolution",
            "gain_sd",
            "zero_sd",
        ):
            value = getattr(self, name)
            if not value >= 0.0:
                raise MeasurementError(f"{name} of {self.gas} is {value:g}; it must be 0 or more")
            estimated = self.gas == "so2" and name in ("t90_sd", "delay_sd_s")
            if math.isinf(value) and not estimated:
                raise MeasurementError(
                    f"{name} of {self.gas} is {value:g}; it must be finite: "
                    "t90 and delay of SO2 alone can be estimated from a record"
                )
        if self.noise < 0.0 or math.isinf(self.noise):
            raise MeasurementError(
                f"noise of {self.gas} is {self.noise:g} {UNITS[self.gas]}; it must be 0 or more"
            )
        check_range(f"gain of {self.gas}", self.gain, 0.1, 10.0)
        if not self.range_low < self.range_high:
            raise MeasurementError(
                f"range of {self.gas} is {self.range_low:g} to {self.range_high:g}; "
                "its end must lie above its start"
            )
        for name, least in (("cross", -10.0), ("cross_sd", 0.0)):
            for gas, value in getattr(self, name).items():
                if gas not in GASES or gas == self.gas:
                    raise MeasurementError(
                        f"{name} of {self.gas} names {gas!r}; it must name another of "
                        f"{', '.join(GASES)}"
                    )
                check_range(f"{name} of {self.gas} to {gas}", value, least, 10.0)
        if not math.isfinite(self.zero):
            raise MeasurementError(f"zero of {self.gas} is {self.zero:g}; it must be finite")
        check_range(f"pressure_effect of {self.gas}", self.pressure_effect, -0.1, 0.1, " 1/hPa")

    @property
    def constants(self) -> tuple[float, ...]:
        """Time constants of its poles, the largest first [s]."""
        return time_constants(self.t90_s, self.second_pole)
