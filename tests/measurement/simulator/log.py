"""One simulated log: the air along the flight, the sniffer's readings of it, and the truth.

A log is made in three steps, each with random numbers of its own: the flight with the plumes that
it crosses, the instrument within its stated tolerances, and the noise. They depend on the seed and
the log's number alone, so that log 7 of every regime is the same flight with the same noise, and
regimes are compared log by log.
"""

from __future__ import annotations

import csv
import json
import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
from scipy import signal

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from tests.measurement.simulator.regimes import Regime

Array = npt.NDArray[np.float64]

GASES = ("so2", "co2", "no", "no2")
"""Order of every array over gases: SO2, NO and NO2 in ppb, CO2 in ppm."""

COLUMNS = {"so2": "so2_ppb", "co2": "co2_ppm", "no": "no_ppb", "no2": "no2_ppb"}
"""Columns of a log."""

STEP_S = 0.05
"""Between samples of the air [s]."""

BEFORE_S = 90.0
"""Flight before the first reading, in which the sensors forget that they were started [s]."""

_SULPHUR, _CARBON = 32.06, 12.011
"""Standard atomic weights [g/mol]."""

_FLIGHT, _INSTRUMENT, _NOISE, _DISTURBANCE = range(4)
"""Streams of random numbers."""


@dataclass(frozen=True)
class Exhaust:
    """What a ship emits.

    Attributes
    ----------
    content_percent : sulphur in the fuel [% m/m], all of it emitted as SO2
    carbon : in the fuel [-]
    no, no2 : emitted with CO2 [ppb/ppm]
    """

    content_percent: float
    carbon: float
    no: float
    no2: float

    @property
    def per_co2(self) -> Array:
        """Excess of each gas over that of CO2, shape (4,) [ppb/ppm, and 1 for CO2]."""
        # 1 mol of CO2 holds 12.011 g of carbon; ppb/ppm is 1e-3, per cent is 1e-2.
        so2 = self.content_percent * _CARBON / (_SULPHUR * self.carbon) * 10.0
        return np.array([so2, 1.0, self.no, self.no2])


def random_exhaust(generator: np.random.Generator, least: float, most: float) -> Exhaust:
    """Return exhaust of a fuel whose sulphur is log-uniform between two contents [% m/m].

    Carbon is 0.85 (residual fuels) to 0.875 (gas oil); NOx is that of tiers II to 0, a twentieth
    to a seventh of it NO2.
    """
    share, carbon, nox, no2_share = generator.uniform(
        [0.0, 0.85, 6.0, 0.05], [1.0, 0.875, 26.0, 0.15]
    )
    return Exhaust(
        content_percent=least * (most / least) ** share,
        carbon=carbon,
        no=nox * (1.0 - no2_share),
        no2=nox * no2_share,
    )


@dataclass(frozen=True)
class Flight:
    """A flight that crosses a ship's plume again and again.

    Attributes
    ----------
    time : of the air's samples, from ``BEFORE_S`` before the first reading on, shape (n,) [s]
    duration_s : from the first reading to the last [s]
    interval_s : mean time between passes [s]
    middle, width, peak : of each pass, shape (k,): time [s], standard deviation of the Gaussian in
        time [s], and CO2 excess in the air [ppm]
    exhaust : of the ship
    changed_exhaust, change_s : after a change of fuel, and when; no change where it is infinite
    background : of clean air, shape (4,) [ppb, ppm]
    level : slow variation of its CO2, shape (n,) [ppm]
    """

    time: Array
    duration_s: float
    interval_s: float
    middle: Array
    width: Array
    peak: Array
    exhaust: Exhaust
    changed_exhaust: Exhaust
    change_s: float
    background: Array
    level: Array

    def air(self) -> Array:
        """Return the air along the flight without disturbances, shape (n, 4) [ppb, ppm]."""
        air = self.background + np.zeros((len(self.time), len(GASES)))
        air[:, 1] += self.level
        for middle, width, peak in zip(self.middle, self.width, self.peak, strict=True):
            exhaust = self.changed_exhaust if middle > self.change_s else self.exhaust
            air += plume(self.time, middle, width, peak, exhaust)
        return air


def plume(time: Array, middle: float, width: float, peak: float, exhaust: Exhaust) -> Array:
    """Return what a Gaussian crossing of a plume adds to the air, shape (n, 4) [ppb, ppm].

    Parameters
    ----------
    middle, width : time of the peak and standard deviation in time [s]
    peak : of CO2 [ppm]
    """
    co2 = peak * np.exp(-0.5 * ((time - middle) / width) ** 2)
    return co2[:, np.newaxis] * exhaust.per_co2


def random_flight(generator: np.random.Generator, regime: Regime) -> Flight:
    """Return a flight of 3 to 10 minutes with a pass every 8 to 27 s, one of 20 missed."""
    duration, interval = generator.uniform([180.0, 8.0], [600.0, 27.0])
    time = np.arange(-BEFORE_S, duration + STEP_S, STEP_S)
    exhaust = random_exhaust(generator, *regime.contents_percent)
    # Passes: regular but for some per cent; their height varies as the plume meanders.
    count = math.ceil((BEFORE_S + duration) / interval) + 1
    middle = -BEFORE_S + interval * (np.arange(count) + generator.uniform())
    middle += 0.04 * interval * generator.standard_normal(count)
    width = generator.uniform(0.7, 1.8) * np.exp(0.2 * generator.standard_normal(count))
    least, most = regime.peak_ppm
    typical = least * (most / least) ** generator.uniform()
    peak = typical * np.exp(0.5 * generator.standard_normal(count))
    peak *= generator.uniform(size=count) > 0.05
    # A level that varies as slowly as a line up to five minutes can follow, nearly.
    level = np.zeros(len(time))
    for _ in range(2):
        period = 300.0 * 4.0 ** generator.uniform()
        phase = 2.0 * math.pi * generator.uniform()
        level += generator.standard_normal() * np.sin(2.0 * math.pi * time / period + phase)
    background = generator.uniform([0.0, 400.0, 0.0, 1.0], [2.0, 440.0, 1.0, 5.0])
    change = generator.uniform(0.35, 0.65) * duration
    # Towards the middle of the contents.
    up = exhaust.content_percent < math.sqrt(math.prod(regime.contents_percent))
    factor = regime.fuel_change if up else 1.0 / regime.fuel_change
    changed = replace(exhaust, content_percent=factor * exhaust.content_percent)
    return Flight(
        time=time,
        duration_s=duration,
        interval_s=interval,
        middle=middle,
        width=np.minimum(width, interval / 6.0),
        peak=peak,
        exhaust=exhaust,
        changed_exhaust=changed,
        change_s=math.inf if regime.fuel_change == 1.0 else change,
        background=background,
        level=level,
    )


# Instrument


@dataclass(frozen=True)
class Cell:
    """A cell as it is, not as it is stated.

    Attributes
    ----------
    t90_s : time to 90 % of a step [s]
    second_pole : second time constant over the first [-]
    delay_s : [s]
    response : to each gas, shape (4,), gain included [-]
    zero, noise, walk : reading of clean air, standard deviation of a reading, and of the zero's
        drift in a second [ppb or ppm]
    """

    t90_s: float
    second_pole: float
    delay_s: float
    response: Array
    zero: float
    noise: float
    walk: float


@dataclass(frozen=True)
class Instrument:
    """A sniffer: what its configuration states, and its cells as they are, by gas."""

    rate_hz: int
    stated: dict[str, dict[str, Any]]
    cells: dict[str, Cell]

    def config(self, not_stated: Iterable[tuple[str, str]] = ()) -> dict[str, Any]:
        """Return the configuration of the log without those keys of those gases."""
        left_out = set(not_stated)
        channels = {
            gas: {key: value for key, value in table.items() if (gas, key) not in left_out}
            for gas, table in self.stated.items()
        }
        return {
            "instrument": {
                "title": "simulated",
                "rate_hz": self.rate_hz,
                "channels": channels,
            }
        }


def random_instrument(generator: np.random.Generator, regime: Regime) -> Instrument:
    """Return a sniffer that agrees with its data sheet, but for what the regime declares.

    SO2 responds in 2 to 24 s (t90) and to NO and NO2; CO2 in 1 to 5 s. NO and NO2 are logged by
    five of six. Readings come ten times a second in two of three, otherwise once.
    """
    so2_t90 = 2.0 * 12.0 ** generator.uniform()
    so2_delay, co2_t90, co2_delay = generator.uniform([0.5, 1.0, 0.5], [3.0, 5.0, 2.0])
    stated: dict[str, dict[str, Any]] = {
        "so2": {
            "t90_s": so2_t90,
            "t90_sd": 0.05,
            "delay_s": so2_delay,
            "delay_sd_s": 0.3,
            "noise": 2.5,
            "random_walk": 0.02,
            "gain_sd": 0.03,
            "cross": {"no": 0.015, "no2": -0.16},
            "cross_sd": {"no": 0.0015, "no2": 0.032},
        },
        "co2": {
            "t90_s": co2_t90,
            "t90_sd": 0.05,
            "delay_s": co2_delay,
            "delay_sd_s": 0.01,
            "gain_sd": 0.02,
            "noise": 1.0,
        },
    }
    for gas, t90 in (("no", 25.0), ("no2", 30.0)):
        stated[gas] = {
            "t90_s": t90,
            "t90_sd": 0.05,
            "delay_s": 1.0,
            "delay_sd_s": 0.1,
            "noise": 7.0,
            "gain_sd": 0.05,
        }
    cells = {gas: _random_cell(generator, gas, stated[gas], regime) for gas in GASES}
    rate, logged = (10 if generator.uniform() < 2.0 / 3.0 else 1), generator.uniform() < 5.0 / 6.0
    gases = GASES if logged else GASES[:2]
    return Instrument(
        rate_hz=rate,
        stated={gas: stated[gas] for gas in gases},
        cells={gas: cells[gas] for gas in gases},
    )


def _random_cell(
    generator: np.random.Generator, gas: str, stated: dict[str, Any], regime: Regime
) -> Cell:
    """Return a cell within its stated tolerances, and as the regime departs from them."""
    t90, delay, gain, zero = generator.standard_normal(4)
    response = np.array([float(gas == other) for other in GASES])
    for other, share in stated.get("cross", {}).items():
        deviation = stated["cross_sd"][other] * generator.standard_normal()
        response[GASES.index(other)] = share + deviation
    later, second_pole = 0.0, 0.0
    pole, sign = generator.uniform(*regime.so2_second_pole), generator.uniform() < 0.5
    if gas == "so2":
        # Earlier in half of the logs, where there is as much delay.
        early = sign and stated["delay_s"] > regime.so2_later_s
        later, second_pole = regime.so2_later_s * (-1.0 if early else 1.0), pole
    return Cell(
        t90_s=stated["t90_s"]
        * (1.0 + stated["t90_sd"] * t90)
        * (regime.so2_t90_factor if gas == "so2" else 1.0),
        second_pole=second_pole,
        delay_s=max(0.0, stated["delay_s"] + stated["delay_sd_s"] * delay + later),
        response=response * (1.0 + stated["gain_sd"] * gain),
        zero=3.0 * zero,
        noise=stated["noise"] * regime.noise_factor,
        walk=stated.get("random_walk", 0.0),
    )


def respond(cell: Cell, air: Array) -> Array:
    """Return a cell's reading of the air at every sample, without delay, zero and noise.

    Parameters
    ----------
    air : of all gases, shape (n, 4)
    """
    seen = air @ cell.response
    first = cell.t90_s / _time_to_90_percent(cell.second_pole)
    poles = [first, cell.second_pole * first] if cell.second_pole else [first]
    for pole in poles:
        # Exact for air that is linear between samples.
        numerator, denominator, _ = signal.cont2discrete(([1.0], [pole, 1.0]), STEP_S, "foh")
        b, a = np.ravel(numerator), np.ravel(denominator)
        seen, _ = signal.lfilter(b, a, seen, zi=signal.lfilter_zi(b, a) * seen[0])
    return np.asarray(seen)


def _time_to_90_percent(second_pole: float) -> float:
    """Return t90 in units of the first time constant, of poles at 1 and ``second_pole``."""
    if second_pole == 0.0:
        return math.log(10.0)
    poles = ([1.0], np.polymul([1.0, 1.0], [second_pole, 1.0]))
    time, step = signal.step(poles, T=np.linspace(0.0, 12.0, 24_001))
    return float(np.interp(0.9, step, time))


# Log


@dataclass(frozen=True)
class Truth:
    """Truth of a log.

    Attributes
    ----------
    contents_percent : of the ship's fuel; two where it changes, the first of the beginning [% m/m]
    answerable : whether an estimate from the log alone can be right
    """

    contents_percent: tuple[float, ...]
    answerable: bool


@dataclass(frozen=True)
class Log:
    """A simulated log.

    Attributes
    ----------
    name : regime, seed and number
    time : of the rows, shape (m,) [s]
    values : readings by gas, shape (m,) each [ppb or ppm]
    config : of the instrument as it is stated
    truth : of the fuel
    """

    name: str
    time: Array
    values: dict[str, Array]
    config: dict[str, Any]
    truth: Truth = field(compare=False)

    def write(self, folder: Path) -> None:
        """Write NAME.csv and NAME.toml, in the form of a real flight's."""
        header = ["time_s", *(COLUMNS[gas] for gas in self.values)]
        with (folder / f"{self.name}.csv").open("w", encoding="utf-8", newline="") as file:
            rows = csv.writer(file, lineterminator="\n")
            rows.writerow(header)
            for row in zip(self.time, *self.values.values(), strict=True):
                rows.writerow([f"{value:.3f}" for value in row])
        text = "\n".join(_toml(self.config)) + "\n"
        (folder / f"{self.name}.toml").write_text(text, encoding="utf-8")


def write_logs(logs: Iterable[Log], folder: Path) -> None:
    """Write logs, and ``truth.csv`` with the fuel of each."""
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "truth.csv").open("w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["log", "true_fsc_percent", "last_fsc_percent", "answerable"])
        for log in logs:
            log.write(folder)
            contents = log.truth.contents_percent
            rows.writerow(
                [log.name, *(f"{contents[i]:.4f}" for i in (0, -1)), log.truth.answerable]
            )


def _toml(table: dict[str, Any], path: str = "") -> list[str]:
    """Return the lines of a TOML table of numbers, texts and tables."""
    lines = [f"[{path}]"] if path else []
    below = []
    for key, value in table.items():
        if isinstance(value, dict):
            below += _toml(value, f"{path}.{key}" if path else key)
        else:
            lines.append(f"{key} = {json.dumps(value)}")
    return lines + below


def simulate(regime: Regime, seed: int, number: int) -> Log:
    """Return a log of a regime."""
    flight_numbers, instrument_numbers, noise, disturbances = (
        np.random.default_rng([seed, number, stream])
        for stream in (_FLIGHT, _INSTRUMENT, _NOISE, _DISTURBANCE)
    )
    flight = random_flight(flight_numbers, regime)
    instrument = random_instrument(instrument_numbers, regime)
    air = flight.air()
    for disturbance in regime.disturbances:
        air += disturbance.air(flight, disturbances)
    time = np.arange(0.0, flight.duration_s, 1.0 / instrument.rate_hz)
    values = {
        gas: _read(cell, air, flight.time, time, noise) for gas, cell in instrument.cells.items()
    }
    kept = _logged_rows(time, noise)
    contents = (flight.exhaust.content_percent,)
    if math.isfinite(flight.change_s):
        contents += (flight.changed_exhaust.content_percent,)
    return Log(
        name=f"{regime.name}_{seed}_{number}",
        time=np.round(time[kept], 3),
        values={gas: column[kept] for gas, column in values.items()},
        config=instrument.config(regime.not_stated),
        truth=Truth(contents, regime.answerable),
    )


def _read(
    cell: Cell, air: Array, air_time: Array, time: Array, generator: np.random.Generator
) -> Array:
    """Return the readings of a cell, rounded to a tenth, shape (m,)."""
    clean = np.interp(time - cell.delay_s, air_time, respond(cell, air))
    white, steps = generator.standard_normal((2, len(time)))
    walk = cell.walk * math.sqrt(time[1] - time[0]) * np.cumsum(steps)
    return np.asarray(np.round(clean + cell.zero + walk + cell.noise * white, 1))


def _logged_rows(time: Array, generator: np.random.Generator) -> npt.NDArray[np.bool_]:
    """Return which rows were logged: 98 %, and in three of four logs not those of 5 to 15 s."""
    kept = generator.uniform(size=len(time)) > 0.02
    start, length = generator.uniform([0.1, 5.0], [0.9, 15.0])
    if generator.uniform() < 0.75:
        kept &= np.abs(time - start * time[-1]) > 0.5 * length
    return np.asarray(kept)
