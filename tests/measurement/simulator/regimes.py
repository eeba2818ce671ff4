"""The regimes of simulated logs: in what air, beside which other ships, with what instrument.

Unless a regime says otherwise, the sulphur content of the fuel is log-uniform from 0.03 to 2.75 %
m/m, passes are every 8 to 27 s and 15 to 65 ppm of CO2 high in the air (median of a flight; the
passes vary by a factor of 1.6), and the instrument is within its stated tolerances. Clean air
varies by 1 ppm within 300 s or more. A disturbance adds CO2 without SO2, unless it is a ship.
"""

import math
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
from scipy import signal

from tests.measurement.simulator.log import (
    GASES,
    STEP_S,
    Array,
    Exhaust,
    Flight,
    plume,
    random_exhaust,
)

Requirement = Literal["covered", "rarely wrong", "no verdict"]
"""What an estimate has to hold in a regime; wrong verdicts below 1 % of those given in each:

* covered: the 95 % interval holds the content in 93 to 97 % of the logs of quality A and B.
* rarely wrong: no more than that.
* no verdict: the log alone cannot tell the content.
"""

CONTENTS_PERCENT = (0.03, 2.75)
"""Sulphur contents of ships' fuels [% m/m]."""

OTHER_SHIP_HEIGHT = (0.5, 1.5)
"""Height of another ship's plume, over the median of the ship's own passes [-]."""

OTHER_SHIP_WIDTH = (1.0, 2.5)
"""Standard deviation in time of a crossing of another ship's plume [s]."""


class Disturbance(Protocol):
    """Something that adds gases to the air along a flight."""

    def air(self, flight: Flight, generator: np.random.Generator) -> Array:
        """Return what it adds, shape (n, 4) [ppb, ppm]."""


def _co2(values: Array) -> Array:
    """Return air to which CO2 alone is added, shape (n, 4) [ppm]."""
    air = np.zeros((len(values), len(GASES)))
    air[:, 1] = values
    return air


@dataclass(frozen=True)
class Haze:
    """CO2 that varies as an Ornstein-Uhlenbeck process.

    Attributes
    ----------
    sd_ppm : standard deviation [ppm]
    correlation_s : least and most time in which the correlation falls to 1/e, uniform [s]
    """

    sd_ppm: float
    correlation_s: tuple[float, float] = (15.0, 40.0)

    def air(self, flight: Flight, generator: np.random.Generator) -> Array:
        """Return what it adds, shape (n, 4) [ppm]."""
        kept = math.exp(-STEP_S / generator.uniform(*self.correlation_s))
        white = generator.standard_normal(len(flight.time))
        white[1:] *= math.sqrt(1.0 - kept**2)
        return _co2(self.sd_ppm * signal.lfilter([1.0], [1.0, -kept], white))


@dataclass(frozen=True)
class Sine:
    """CO2 that varies as a sine of any phase [ppm, s]."""

    amplitude_ppm: float
    period_s: float

    def air(self, flight: Flight, generator: np.random.Generator) -> Array:
        """Return what it adds, shape (n, 4) [ppm]."""
        turns = flight.time / self.period_s + generator.uniform()
        return _co2(self.amplitude_ppm * np.sin(2.0 * math.pi * turns))


@dataclass(frozen=True)
class Sway:
    """CO2 with a gradient in space, which a UAV on its swings sees in step with its turns.

    It turns on one side of the plume and then on the other. So a gradient across the plume has a
    period of two intervals between passes, and is 0 in the passes but for 15 % of an interval; one
    with height, of a UAV that climbs in turns, has a period of one, and extremes in passes.

    Attributes
    ----------
    amplitude_ppm : of the variation: from the middle to a turn, or, with height, half of what it is
        from a pass to a turn [ppm]
    with_height : whether it is with height
    """

    amplitude_ppm: float
    with_height: bool = False

    def air(self, flight: Flight, generator: np.random.Generator) -> Array:
        """Return what it adds, shape (n, 4) [ppm]."""
        off = 0.15 * generator.standard_normal()
        swings = np.interp(flight.time, flight.middle, np.arange(len(flight.middle)))
        side = generator.choice([-1.0, 1.0]) * self.amplitude_ppm
        if self.with_height:
            return _co2(side * np.cos(2.0 * math.pi * swings))
        return _co2(side * np.sin(math.pi * (swings + off)))


@dataclass(frozen=True)
class Puffs:
    """Puffs of CO2 from elsewhere, at random times.

    Attributes
    ----------
    height_ppm : mean height; each has 0.5 to 1.5 of it [ppm]
    every_s : mean time between them [s]
    width_s : least and most standard deviation in time [s]
    """

    height_ppm: float
    every_s: float = 30.0
    width_s: tuple[float, float] = (3.0, 10.0)

    def air(self, flight: Flight, generator: np.random.Generator) -> Array:
        """Return what it adds, shape (n, 4) [ppm]."""
        first, last = flight.time[[0, -1]]
        co2 = np.zeros(len(flight.time))
        for _ in range(generator.poisson((last - first) / self.every_s)):
            middle, width = generator.uniform([first, self.width_s[0]], [last, self.width_s[1]])
            height = self.height_ppm * generator.uniform(0.5, 1.5)
            co2 += height * np.exp(-0.5 * ((flight.time - middle) / width) ** 2)
        return _co2(co2)


@dataclass(frozen=True)
class Steps:
    """A level of CO2 that jumps at random times, as at the border of two air masses.

    Attributes
    ----------
    sd_ppm : standard deviation of a jump [ppm]
    every_s : mean time between jumps [s]
    front_s : time in which most of a jump happens, from 12 to 88 % [s]
    """

    sd_ppm: float
    every_s: float = 80.0
    front_s: float = 3.0

    def air(self, flight: Flight, generator: np.random.Generator) -> Array:
        """Return what it adds, shape (n, 4) [ppm]."""
        first, last = flight.time[[0, -1]]
        co2 = np.zeros(len(flight.time))
        for _ in range(generator.poisson((last - first) / self.every_s)):
            middle, jump = generator.uniform(first, last), self.sd_ppm * generator.standard_normal()
            co2 += 0.5 * jump * np.tanh(2.0 * (flight.time - middle) / self.front_s)
        return _co2(co2)


@dataclass(frozen=True)
class OtherShip:
    """Plumes of another ship with another fuel.

    Attributes
    ----------
    plumes : how many; all that there is room for where it is infinite
    place : from a pass, least and most, uniform [intervals between passes]
    contents_percent : of its fuel, log-uniform [% m/m]
    least_ratio : of the contents of both ships, the larger over the smaller, at least [-]
    """

    plumes: float
    place: tuple[float, float]
    contents_percent: tuple[float, float] = CONTENTS_PERCENT
    least_ratio: float = 1.0

    def air(self, flight: Flight, generator: np.random.Generator) -> Array:
        """Return what it adds, shape (n, 4) [ppb, ppm]."""
        exhaust = random_exhaust(generator, *self.contents_percent)
        while self._alike(exhaust, flight.exhaust):
            exhaust = random_exhaust(generator, *self.contents_percent)
        inside = (flight.middle > 0.0) & (flight.middle < flight.duration_s - flight.interval_s)
        passes = generator.permutation(flight.middle[inside & (flight.peak > 0.0)])
        typical = float(np.median(flight.peak[flight.peak > 0.0]))
        air = np.zeros((len(flight.time), len(GASES)))
        for middle in passes[: int(min(self.plumes, len(passes)))]:
            place = middle + flight.interval_s * generator.uniform(*self.place)
            width = min(generator.uniform(*OTHER_SHIP_WIDTH), flight.interval_s / 6.0)
            height = typical * generator.uniform(*OTHER_SHIP_HEIGHT)
            air += plume(flight.time, place, width, height, exhaust)
        return air

    def _alike(self, one: Exhaust, other: Exhaust) -> bool:
        """Return whether the contents of two ships are nearer to each other than declared."""
        contents = one.content_percent, other.content_percent
        return max(contents) < self.least_ratio * min(contents)


@dataclass(frozen=True, kw_only=True)
class Regime:
    """A regime.

    Attributes
    ----------
    name : row of the table
    meaning : in words
    required : of an estimate
    disturbances : of the air
    contents_percent : of the ship's fuel, log-uniform [% m/m]
    peak_ppm : median CO2 of a flight's passes in the air, log-uniform [ppm]
    fuel_change : content after a change in the middle of the flight over that before; the inverse
        for fuels in the upper half of the contents [-]
    so2_t90_factor : t90 of SO2 over the stated one [-]
    so2_later_s : delay of SO2 more than stated; less in half of the logs, if it is longer [s]
    so2_second_pole : second time constant of SO2 over the first, uniform; 0 is stated [-]
    noise_factor : noise of all channels over the stated one [-]
    not_stated : keys that the configuration leaves out, by gas
    """

    name: str
    meaning: str
    required: Requirement
    disturbances: tuple[Disturbance, ...] = ()
    contents_percent: tuple[float, float] = CONTENTS_PERCENT
    peak_ppm: tuple[float, float] = (15.0, 65.0)
    fuel_change: float = 1.0
    so2_t90_factor: float = 1.0
    so2_later_s: float = 0.0
    so2_second_pole: tuple[float, float] = (0.0, 0.0)
    noise_factor: float = 1.0
    not_stated: tuple[tuple[str, str], ...] = ()

    @property
    def answerable(self) -> bool:
        """Whether an estimate from the log alone can be right."""
        return self.required != "no verdict"


_IN_GAPS = (0.4, 0.6)
"""Place in the gap after a pass [intervals]."""

_ON_PASSES = (-0.15, 0.15)
"""Place that overlaps a pass [intervals]."""


_T90 = (("so2", "t90_s"), ("so2", "t90_sd"))
_DELAY = (("so2", "delay_s"), ("so2", "delay_sd_s"))
_NOISE = tuple((gas, "noise") for gas in GASES)
_BUT_CROSS = ("t90_s", "t90_sd", "delay_s", "delay_sd_s", "gain_sd", "noise", "random_walk")
"""Keys that a regime leaves out of the configuration."""


def _regimes() -> tuple[Regime, ...]:
    haze = tuple(
        Regime(
            name=f"haze_{sd:g}",
            meaning=f"CO2 background that varies within 15 to 40 s, sd {sd:g} ppm",
            required="covered" if sd <= 5.0 else "rarely wrong",
            disturbances=(Haze(sd),),
        )
        for sd in (0.5, 1.0, 2.0, 3.0, 5.0, 20.0)
    )
    sines = tuple(
        Regime(
            name=f"sine_{period:g}",
            meaning=f"CO2 sine of 2 ppm, period {period:g} s",
            required="covered",
            disturbances=(Sine(2.0, period),),
        )
        for period in (60.0, 120.0, 240.0, 480.0)
    )
    sway = tuple(
        Regime(
            name=f"sway_{amplitude:g}",
            meaning=f"CO2 gradient across the plume, {amplitude:g} ppm to a turn",
            required="covered",
            disturbances=(Sway(amplitude),),
        )
        for amplitude in (0.5, 1.0, 2.0)
    )
    climb = Regime(
        name="climb_1",
        meaning="CO2 gradient with height, 2 ppm between passes and turns",
        required="rarely wrong",
        disturbances=(Sway(1.0, with_height=True),),
    )
    second_ship = tuple(
        Regime(
            name=f"second_ship_{name}",
            meaning=f"another ship's plume in {name.replace('_', ' ')} between passes",
            required="no verdict" if math.isinf(plumes) else "rarely wrong",
            disturbances=(OtherShip(plumes, _IN_GAPS),),
        )
        for name, plumes in (("one_gap", 1), ("three_gaps", 3), ("every_gap", math.inf))
    )
    return (
        Regime(name="quiet", meaning="quiet air", required="covered"),
        *haze,
        *sines,
        *sway,
        climb,
        Regime(
            name="puffs",
            meaning="puffs of 3 ppm of CO2, one in 30 s, 3 to 10 s wide (sd)",
            required="covered",
            disturbances=(Puffs(3.0),),
        ),
        Regime(
            name="steps",
            meaning="level of CO2 that jumps by 3 ppm (sd), once in 80 s",
            required="covered",
            disturbances=(Steps(3.0),),
        ),
        Regime(
            name="weak_peaks",
            meaning="passes of 8 ppm in the air",
            required="covered",
            peak_ppm=(8.0, 8.0),
        ),
        *second_ship,
        Regime(
            name="foreign_pass",
            meaning="a plume of 2.7 % sulphur over one pass of a ship below 0.09 %",
            required="covered",
            contents_percent=(0.03, 0.09),
            disturbances=(OtherShip(1, _ON_PASSES, (2.7, 2.7)),),
        ),
        Regime(
            name="foreign_every_pass",
            meaning="another ship's plume over every pass, contents three times apart or more",
            required="no verdict",
            disturbances=(OtherShip(math.inf, _ON_PASSES, least_ratio=3.0),),
        ),
        Regime(
            name="fuel_change",
            meaning="fuel with five times or a fifth of the sulphur from the middle on",
            required="no verdict",
            fuel_change=5.0,
        ),
        Regime(
            name="so2_slower",
            meaning="t90 of SO2 30 % longer than stated (5 %, sd)",
            required="rarely wrong",
            so2_t90_factor=1.3,
        ),
        Regime(
            name="so2_faster",
            meaning="t90 of SO2 30 % shorter than stated (5 %, sd)",
            required="rarely wrong",
            so2_t90_factor=0.7,
        ),
        Regime(
            name="so2_delay",
            meaning="delay of SO2 1.5 s more or less than stated (0.3 s, sd)",
            required="rarely wrong",
            so2_later_s=1.5,
        ),
        Regime(
            name="noise_twice",
            meaning="noise of every channel twice the stated one",
            required="rarely wrong",
            noise_factor=2.0,
        ),
        Regime(
            name="two_poles",
            meaning="SO2 with a second pole of 0.2 to 0.5 of the first, stated with one",
            required="rarely wrong",
            so2_second_pole=(0.2, 0.5),
        ),
        Regime(
            name="haze_as_passes",
            meaning="passes of 30 ppm in CO2 that varies by 30 ppm (sd) within 3 to 10 s",
            required="no verdict",
            peak_ppm=(30.0, 30.0),
            disturbances=(Haze(30.0, (3.0, 10.0)),),
        ),
        Regime(
            name="t90_not_stated",
            meaning="t90 of SO2 not stated",
            required="rarely wrong",
            not_stated=_T90,
        ),
        Regime(
            name="delay_not_stated",
            meaning="delay of SO2 not stated",
            required="rarely wrong",
            not_stated=_DELAY,
        ),
        Regime(
            name="timing_not_stated",
            meaning="t90 and delay of SO2 not stated",
            required="rarely wrong",
            not_stated=(*_T90, *_DELAY),
        ),
        Regime(
            name="noise_not_stated",
            meaning="noise of no channel stated",
            required="rarely wrong",
            not_stated=_NOISE,
        ),
        Regime(
            name="only_cross_stated",
            meaning="of the instrument only the response of SO2 to NO and NO2 stated",
            required="rarely wrong",
            not_stated=tuple((gas, key) for gas in GASES for key in _BUT_CROSS),
        ),
    )


REGIMES = {regime.name: regime for regime in _regimes()}
"""Regimes by name."""
