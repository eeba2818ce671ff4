"""A ship's engine from outside: its load by speed, its consumption, and the NOx that it may emit.

Regulation 13 of MARPOL Annex VI limits NOx per kWh, as a mean over the test cycle of a test bed, by
the rated speed of the engine and the date on which the keel was laid. A plume shows NOx per fuel,
at one load. The consumption at the load expected from the ship's speed relates the two, so that a
verdict on a plume is a screening and not a certificate.
"""

import math
from dataclasses import dataclass
from datetime import date

import numpy as np

from common.text import did_you_mean
from measurement.emission import FUEL_G_KWH, consumption_with_load
from measurement.errors import MeasurementError, check_range

TIERS = (
    (date(2000, 1, 1), "I", 17.0, 45.0, -0.2, 9.8),
    (date(2011, 1, 1), "II", 14.4, 44.0, -0.23, 7.7),
)
"""Keel laid from, stage, and limit of NOx [g/kWh]: below 130 rpm, factor and exponent of the rated
speed [rpm], and from 2000 rpm on. MARPOL Annex VI, regulation 13, paragraphs 3 and 4, by
resolution MEPC.176(58), 2008 (the same curves: 40 CFR 1042.104)."""

TIER_III = ("III", 3.4, 9.0, -0.2, 2.0)
"""The same within a control area of NOx: paragraph 5.1.1."""

CONTROL_AREAS = {
    "north_america": date(2016, 1, 1),
    "us_caribbean": date(2016, 1, 1),
    "baltic": date(2021, 1, 1),
    "north_sea": date(2021, 1, 1),
}
"""Control areas of NOx, and the keels from which on stage III holds there: regulation 13, paragraph
5.1, and resolution MEPC.286(71), 2017. Later areas are not in this table."""

ONE_LOAD = {"III": 1.5}
"""Limit at a single load over that of the cycle: an engine of stage III may emit 50 % more at any
point of its cycle (NOx Technical Code 2008, 3.1.4). The others have no limit at a single load: the
cycle's is taken."""

LOAD_LEAST = 0.25
"""Least load of the test cycles E2 and E3 of main engines [-] (NOx Technical Code 2008, 3.2)."""

SLOW_RPM = 300.0
"""Rated speed below which an engine has two strokes, unless that is stated; an assumption."""

LOAD_SD = 0.15
"""Relative standard deviation of the load at a known speed, by draught, hull, wind and waves [-];
an assumption."""

SPEED_SD = 0.5
"""Standard deviation of the speed through the water by that over ground, by currents [m/s]; an
assumption."""

CONSUMPTION_SD = 0.06
"""Relative standard deviation of an engine's consumption about its class [-].

An assumption: engines differ by 10 % between editions of IMO's studies, and such an even spread has
a standard deviation of 6 %.
"""

_UNKNOWN_LOAD = (LOAD_LEAST, 1.0)
"""Range of a load that is not known, evenly spread [-]."""

_POINTS = 41
"""Loads at which the consumption is evaluated."""


@dataclass(frozen=True, kw_only=True)
class Limit:
    """The limit of NOx of an engine.

    Attributes
    ----------
    stage : "I", "II" or "III"
    cycle_g_kwh : over the test cycle [g/kWh]
    at_load_g_kwh : limit for a single load [g/kWh]
    """

    stage: str
    cycle_g_kwh: float
    at_load_g_kwh: float


@dataclass(frozen=True, kw_only=True)
class Engine:
    """The known data of a ship's main engine; None for unknown values.

    Attributes
    ----------
    keel_laid : date
    rated_rpm : rated speed [1/min]
    control_area : of NOx in which the ship was measured, one of ``CONTROL_AREAS``, or empty
    design_speed_mps : of the ship at full power [m/s]
    speed_mps, speed_sd_mps : speed during the measurement, as by AIS, and its standard deviation
        [m/s]
    strokes : 2 or 4; by the rated speed unless stated
    residual : whether it burns residual fuel
    consumption_g_kwh : at the engine's best load; by its class unless stated [g/kWh]
    consumption_sd : relative standard deviation of the consumption [-]

    Raises
    ------
    MeasurementError : a value is out of its range
    """

    keel_laid: date | None = None
    rated_rpm: float | None = None
    control_area: str = ""
    design_speed_mps: float | None = None
    speed_mps: float | None = None
    speed_sd_mps: float = SPEED_SD
    strokes: int | None = None
    residual: bool = False
    consumption_g_kwh: float | None = None
    consumption_sd: float = CONSUMPTION_SD

    def __post_init__(self) -> None:
        for name, low, high, unit in (
            ("rated_rpm", 30.0, 4000.0, " 1/min"),
            ("design_speed_mps", 1.0, 40.0, " m/s"),
            ("speed_mps", 0.0, 40.0, " m/s"),
            ("speed_sd_mps", 0.0, 10.0, " m/s"),
            ("consumption_g_kwh", 100.0, 400.0, " g/kWh"),
            ("consumption_sd", 0.0, 0.5, ""),
        ):
            value = getattr(self, name)
            if value is not None:
                check_range(f"engine.{name}", value, low, high, unit)
        if self.strokes not in (None, 2, 4):
            raise MeasurementError(f"engine.strokes is {self.strokes}; it must be 2 or 4")
        if self.control_area and self.control_area not in CONTROL_AREAS:
            raise MeasurementError(
                f"engine.control_area is {self.control_area!r}"
                f"{did_you_mean(self.control_area, CONTROL_AREAS) or ';'} there are"
                f" {', '.join(CONTROL_AREAS)}"
            )

    @property
    def load(self) -> tuple[float, float] | None:
        """Load expected from the speed, and its standard deviation [-]; None if unknown.

        Power goes with the cube of the speed (BSH library 188756, p. 17).
        """
        if self.speed_mps is None or self.design_speed_mps is None:
            return None
        load = (self.speed_mps / self.design_speed_mps) ** 3
        by_speed = 3.0 * self.speed_sd_mps / max(self.speed_mps, self.speed_sd_mps, 1e-9)
        return load, load * math.hypot(by_speed, LOAD_SD)

    def load_problem(self) -> str:
        """Return why the load admits no verdict, or an empty text."""
        if self.load is None:
            return (
                "the load is not known: give engine.design_speed_mps, and engine.speed_mps or --ais"
            )
        load, deviation = self.load
        shown = f"the load by speed is {load:.2f}, standard deviation {deviation:.2f}"
        if load - 2.0 * deviation > 1.0:
            return f"{shown}, beyond the engine: check speed_mps and design_speed_mps of [engine]"
        if load < LOAD_LEAST:
            return f"{shown}, below {LOAD_LEAST:g}, the least of the test cycle"
        return ""

    def consumption(self) -> tuple[float, float, float]:
        """Return the consumption at the load [kg/kWh], and two relative deviations [-].

        The deviations are by the load, and by the engine about its class.
        """
        if self.load is None:
            loads = np.linspace(*_UNKNOWN_LOAD, _POINTS)
            weights = np.ones(_POINTS)
        else:
            load, deviation = self.load
            steps = np.linspace(-3.0, 3.0, _POINTS)
            loads = np.clip(load + deviation * steps, 0.05, 1.1)
            weights = np.exp(-0.5 * steps**2)
        weights /= weights.sum()
        shares = consumption_with_load(loads)
        mean = float(weights @ shares)
        spread = math.sqrt(float(weights @ (shares - mean) ** 2)) / mean
        return 1e-3 * self.base_g_kwh * mean, spread, self.consumption_sd

    @property
    def base_g_kwh(self) -> float:
        """Consumption at the best load [g/kWh]; of its class unless it is stated."""
        if self.consumption_g_kwh is not None:
            return self.consumption_g_kwh
        slow = self.rated_rpm is not None and self.rated_rpm < SLOW_RPM
        return FUEL_G_KWH[self.strokes or (2 if slow else 4), self.residual]

    def limit(self) -> Limit | None:
        """Return the limit of NOx; None where it is unknown, or there is no limit."""
        if self.keel_laid is None or self.rated_rpm is None:
            return None
        return limit_of(self.keel_laid, self.rated_rpm, self.control_area)

    def limit_problem(self) -> str:
        """Return why there is no limit, or an empty text."""
        missing = [name for name in ("keel_laid", "rated_rpm") if getattr(self, name) is None]
        if missing:
            return f"the stage is not known: give engine.{' and engine.'.join(missing)}"
        if self.limit() is None:
            return f"no limit: the keel was laid before {TIERS[0][0]}"
        return ""


def limit_of(keel_laid: date, rated_rpm: float, control_area: str = "") -> Limit | None:
    """Return the limit of NOx of an engine, None for keels of before 2000.

    >>> round(limit_of(date(2012, 5, 1), 500.0).cycle_g_kwh, 1)
    10.5
    """
    if control_area and keel_laid >= CONTROL_AREAS[control_area]:
        stage, *curve = TIER_III
    else:
        held = [tier for tier in TIERS if keel_laid >= tier[0]]
        if not held:
            return None
        _, stage, *curve = held[-1]
    cycle = _on_curve(rated_rpm, *curve)
    return Limit(stage=stage, cycle_g_kwh=cycle, at_load_g_kwh=cycle * ONE_LOAD.get(stage, 1.0))


def _on_curve(rpm: float, slow: float, factor: float, exponent: float, fast: float) -> float:
    """Return the limit at a rated speed [g/kWh]."""
    if rpm < 130.0:
        return slow
    return fast if rpm >= 2000.0 else float(factor * rpm**exponent)
