"""Simulated logs of NOx, methane and particles with known emissions, and the estimates of them.

``python -m tests.measurement.simulator.gases nox --logs 100 --seed 1000`` prints coverage, verdicts
and the load's share of the variance. Like ``log.py``, what is simulated shares no code with
``measurement``: the relation of an emission to the air, the limits and the engine are written here
anew, from the same sources.
"""

import argparse
import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd

from tests.measurement.simulator.log import Array, Cell, Flight, random_flight, respond
from tests.measurement.simulator.regimes import REGIMES

KINDS = ("nox", "ch4", "pn", "bc")
"""Gases that logs are made of."""

_CARBON, _NO2, _CH4, _GAS = 12.011, 46.005, 16.043, 8.314462618
_AIR_C, _AIR_HPA = 20.0, 1013.25


@dataclass(frozen=True)
class GasLog:
    """A simulated log of a gas and CO2.

    Attributes
    ----------
    time, values : of the rows, and readings by column, shape (m,)
    stated : properties of each channel as its data sheet has them
    engine : of the ship, as far as it is known; empty for other gases than NOx
    truth : emission [g/kWh of NOx, % of the fuel of CH4, 10^15/kg, g/kg]
    limit, cycle : of NOx at one load and over the test cycle [g/kWh]; NaN for other gases
    stage : of the engine, or empty
    """

    time: Array
    values: dict[str, Array]
    stated: dict[str, dict[str, Any]]
    engine: dict[str, Any]
    truth: float
    limit: float = math.nan
    stage: str = ""


def _channel(t90: float, noise: float, gain_sd: float, **more: float) -> dict[str, Any]:
    return {
        "t90_s": t90,
        "t90_sd": 0.05,
        "delay_s": 1.0,
        "delay_sd_s": 0.2,
        "noise": noise,
        "gain_sd": gain_sd,
        **more,
    }


def _channels(kind: str, generator: np.random.Generator) -> dict[str, dict[str, Any]]:
    """Return CO2 and the channels of a gas, as stated."""
    co2_t90, slow, fast = generator.uniform([1.0, 2.0, 1.0], [4.0, 20.0, 6.0])
    co2 = _channel(co2_t90, 1.0, 0.02) | {"delay_sd_s": 0.01}
    own = {
        "nox": {"no": _channel(slow, 7.0, 0.05), "no2": _channel(slow + 3.0, 7.0, 0.05)},
        "ch4": {"ch4": _channel(fast, 5.0, 0.02)},
        "pn": {"pn": _channel(fast, 150.0, 0.10)},
        "bc": {"bc": _channel(fast, 100.0, 0.15)},
    }[kind]
    return {"co2": co2, **own}


def _limit(stage: str, rpm: float) -> float:
    """Return the limit over the test cycle [g/kWh]: regulation 13 of MARPOL Annex VI."""
    slow, factor, power, fast = {
        "I": (17.0, 45.0, 0.2, 9.8),
        "II": (14.4, 44.0, 0.23, 7.7),
        "III": (3.4, 9.0, 0.2, 2.0),
    }[stage]
    return slow if rpm < 130.0 else fast if rpm >= 2000.0 else factor / rpm**power


def _engine(generator: np.random.Generator) -> tuple[dict[str, Any], str, float, float, float]:
    """Return what is known of an engine, its stage and limit, and true NOx and consumption."""
    rpm = 80.0 * 12.5 ** generator.uniform()
    stage = ("I", "II", "III")[generator.integers(3)]
    year = {"I": 2005, "II": 2014, "III": 2022}[stage]
    design, share = generator.uniform([7.0, 0.3], [11.0, 0.95])
    through_water = design * share ** (1.0 / 3.0)
    hull, of_class, current = generator.standard_normal(3)
    load = share * (1.0 + 0.15 * hull)
    base = 185.0 if rpm < 300.0 else 205.0
    burnt = base * (1.0 + 0.06 * of_class) * (0.455 * load**2 - 0.71 * load + 1.28)
    cycle = _limit(stage, rpm)
    allowed = cycle * (1.5 if stage == "III" else 1.0)
    known = {
        "keel_laid": f"{year}-05-01",
        "rated_rpm": rpm,
        "control_area": "north_sea" if stage == "III" else "",
        "design_speed_mps": design,
        "speed_mps": max(0.5, through_water + 0.5 * current),
        "speed_sd_mps": 0.5,
    }
    true = allowed * math.exp(generator.uniform(math.log(0.4), math.log(2.5)))
    return known, stage, allowed, true, burnt


def _per_ppm(kind: str, truth: float, carbon: float, burnt: float, air_c: float) -> float:
    """Return what a ship emits with a ppm of CO2: ppb, particles per cm3 or ng/m3.

    Parameters
    ----------
    truth : emission in the unit of ``GasLog``
    carbon : of the fuel [-]
    burnt : fuel [g/kWh]
    air_c : temperature of the air [deg C]
    """
    carbon_mol = 1000.0 * carbon / _CARBON  # per kg of fuel
    if kind == "nox":
        return truth / burnt * 1000.0 / _NO2 / carbon_mol * 1000.0
    if kind == "ch4":
        escaped = truth / 100.0 * 1000.0 / _CH4
        return escaped / (carbon_mol - escaped) * 1000.0
    # A ppm of CO2 is so much fuel per m3.
    moles = 1e-6 * 100.0 * _AIR_HPA / (_GAS * (air_c + 273.15))
    kilograms = moles / carbon_mol
    return truth * kilograms * (1e15 / 1e6 if kind == "pn" else 1e9)


LONGEST_S = 360.0
"""Longest log [s]."""


def simulate_gas(kind: str, seed: int, number: int, longest_s: float = LONGEST_S) -> GasLog:
    """Return a log of a gas of ``KINDS``."""
    streams = (np.random.default_rng([seed, number, 10 + stream]) for stream in range(3))
    flight_numbers, ship, noise = streams
    flight = random_flight(flight_numbers, REGIMES["quiet"])
    flight = replace(flight, duration_s=min(flight.duration_s, longest_s))
    stated = _channels(kind, ship)
    carbon = ship.uniform(0.85, 0.875) if kind != "ch4" else ship.uniform(0.74, 0.76)
    known: dict[str, Any] = {}
    stage, limit, burnt = "", math.nan, math.nan
    if kind == "nox":
        known, stage, limit, truth, burnt = _engine(ship)
    elif kind == "ch4":
        truth = ship.uniform(1.0, 10.0)
    elif kind == "pn":
        truth = 2.0 * 15.0 ** ship.uniform()
    else:
        truth = 0.05 * 12.0 ** ship.uniform()
    ratio = _per_ppm(kind, truth, carbon, burnt, _AIR_C + 3.0 * ship.standard_normal())
    no2 = ship.uniform(0.05, 0.15)
    shares = {"no": 1.0 - no2, "no2": no2} if kind == "nox" else {kind: 1.0}
    background = {"no": 0.5, "no2": 3.0, "ch4": 1950.0, "pn": 1500.0, "bc": 100.0}
    time = np.arange(0.0, flight.duration_s)
    values = {}
    co2 = flight.air()[:, 1]
    excess = co2 - flight.background[1] - flight.level
    for gas, sheet in stated.items():
        air = co2 if gas == "co2" else background[gas] + ratio * shares[gas] * excess
        values[gas] = _read(sheet, air, flight, time, noise)
    return GasLog(
        time=time,
        values=values,
        stated=stated,
        engine=known,
        truth=truth,
        limit=limit,
        stage=stage,
    )


def _read(
    sheet: dict[str, Any], air: Array, flight: Flight, time: Array, generator: np.random.Generator
) -> Array:
    """Return the readings of a cell that is within its data sheet, shape (m,)."""
    t90, delay, gain = generator.standard_normal(3)
    cell = Cell(
        t90_s=sheet["t90_s"] * (1.0 + sheet["t90_sd"] * t90),
        second_pole=0.0,
        delay_s=max(0.0, sheet["delay_s"] + sheet["delay_sd_s"] * delay),
        response=np.array([1.0 + sheet["gain_sd"] * gain]),
        zero=0.0,
        noise=sheet["noise"],
        walk=0.0,
    )
    clean = np.interp(time - cell.delay_s, flight.time, respond(cell, air[:, np.newaxis]))
    return np.round(clean + cell.noise * generator.standard_normal(len(time)), 2)


# Estimates


def estimated(kind: str, seed: int, number: int, longest_s: float = LONGEST_S) -> dict[str, Any]:
    """Return the estimate of a log beside its truth, as a row of a table."""
    from tests.measurement.simulator.gas_estimate import estimate_log

    log = simulate_gas(kind, seed, number, longest_s)
    found = estimate_log(kind, log)
    verdict = "" if found.verdict is None else found.verdict.verdict
    above = log.truth > log.limit
    return {
        "log": number,
        "stage": log.stage,
        "truth": log.truth,
        "value": found.value,
        "total": found.total,
        "low": found.low,
        "high": found.high,
        "quality": found.quality,
        "load_share": found.load_share,
        "verdict": verdict,
        "wrong": verdict in ("above", "below") and (verdict == "above") != above,
        "over_limit": log.truth / log.limit,
        "reasons": "; ".join(found.quality_reasons),
    }


def run(kind: str, numbers: Iterable[int], seed: int, longest_s: float = LONGEST_S) -> pd.DataFrame:
    """Return the estimates of logs, a row for each number."""
    return pd.DataFrame([estimated(kind, seed, number, longest_s) for number in numbers])


def summary(table: pd.DataFrame) -> dict[str, Any]:
    """Return coverage, bias, verdicts and the load's share, of logs with quality A or B."""
    given = table[table["quality"] != "C"]
    held = (given["low"] <= given["truth"]) & (given["truth"] <= given["high"])
    figures: dict[str, Any] = {
        "logs": len(table),
        "refused": len(table) - len(given),
        "coverage": held.mean(),
        "bias": (given["value"] / given["truth"] - 1.0).median(),
        "stated": (given["total"] / given["value"]).median(),
        "error": (given["value"] / given["truth"] - 1.0).std(),
        "load_share": given["load_share"].median(),
        "load_share_most": given["load_share"].max(),
    }
    for stage, rows in given[given["stage"] != ""].groupby("stage"):
        decided = rows["verdict"].isin(["above", "below"])
        figures[f"stage {stage}"] = (
            f"{len(rows)} logs, {int(decided.sum())} verdicts, {int(rows['wrong'].sum())} wrong"
        )
    return figures


def main() -> None:
    """Print the figures of logs."""
    parser = argparse.ArgumentParser(prog="python -m tests.measurement.simulator.gases")
    parser.add_argument("kind", choices=KINDS)
    parser.add_argument("--logs", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--save", metavar="CSV")
    given = parser.parse_args()
    table = run(given.kind, range(given.logs), given.seed)
    if given.save:
        table.to_csv(given.save, index=False)
    for name, value in summary(table).items():
        print(f"{name}: {value if isinstance(value, str | int) else f'{value:.3f}'}")


if __name__ == "__main__":
    main()
