"""A sniffer on board: what it reads of the exhaust, and what that says of the fuel."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.interpolate import CubicHermiteSpline

from common.run_layout import SULPHUR_TABLE
from gnc.errors import InfeasibleError
from measurement.emission.emission import GRAVITY
from measurement.emission.fuel import expected_fsc
from measurement.errors import MeasurementError
from measurement.gases import GASES, UNITS
from measurement.sniffer.presets import sensor_preset
from measurement.sniffer.sniffer import Readings, Sniffer
from scenarios.instruments.fuel_estimate import FIGURES, TABLES, fuel_estimate
from scenarios.instruments.instrument import Evaluation, payload
from scenarios.instruments.plume_passes import PASS_FIGURES, fraction_of_axis, pass_figures
from scenarios.schema.scenario import Scenario
from scenarios.world.world import World

Array = npt.NDArray[np.float64]

TIME_STEP = 0.05
"""Between the places at which the air is sampled [s]: a metre at 20 m/s, a tenth of the narrowest plume."""

CLEAN_AIR = {"so2": 0.2, "co2": 420.0, "no": 0.1, "no2": 1.0}
"""Gases in clean air over the sea, in the units of readings; assumptions. They are far below the noise, but for CO2."""

CO2 = GASES.index("co2")
"""Its column."""

_AIR_DENSITY = 1.225
"""Of the standard atmosphere at sea level [kg/m^3]."""


@dataclass(frozen=True, kw_only=True)
class SnifferSettings:
    """Keys of the sniffer.

    Attributes
    ----------
    sensor : a preset of measurement/sniffer/presets
    exact : whether the instrument is as its data sheet says; otherwise gains, zeros, responses and cross-sensitivities are sampled
        within what is stated
    limit_percent : sulphur content that the verdict is on [% m/m]: 0.1 in an emission control area, 0.5 elsewhere
    dynamic_pressure_fraction : of the dynamic pressure that the inlet passes on to the sensors [-]
    """

    sensor: str = "electrochemical"
    exact: bool = False
    limit_percent: float = 0.1
    dynamic_pressure_fraction: float = 0.2

    def __post_init__(self) -> None:
        sensor_preset(self.sensor)
        if not 0.0 < self.limit_percent <= 5.0:
            raise MeasurementError(
                f"limit_percent is {self.limit_percent:g}; give above 0 to 5, as 0.1 in an emission control area"
            )
        if not 0.0 <= self.dynamic_pressure_fraction <= 1.0:
            raise MeasurementError(f"dynamic_pressure_fraction is {self.dynamic_pressure_fraction:g}; give 0 to 1")


@payload("sniffer")
class SnifferOnBoard:
    """Reads the exhaust along the flight."""

    SETTINGS = SnifferSettings
    COLUMNS = (
        *(f"{gas}_{UNITS[gas]}" for gas in GASES),
        *(f"{gas}_reading_{UNITS[gas]}" for gas in GASES),
        "plume_across_m",
        "plume_above_m",
        "plume_fraction",
    )
    FIGURES = (*FIGURES, *PASS_FIGURES)
    TABLES = TABLES

    def __init__(self, scenario: Scenario, world: World, generator: np.random.Generator) -> None:
        if world.exhaust is None:
            raise InfeasibleError("payload.instruments has a sniffer, and there is no exhaust: set emission.ship")
        self._exhaust, self._settings = world.exhaust, scenario.payload.settings(type(self))
        self._spec = sensor_preset(self._settings.sensor)
        actual = self._spec if self._settings.exact else self._spec.drawn(generator)
        self._sniffer = Sniffer(actual, generator=generator, time_step=TIME_STEP)
        self._background = np.array([CLEAN_AIR[gas] for gas in GASES])

    def evaluate(self, column: Callable[[str], Array], since: float) -> Evaluation:
        """Return readings, and figures of the passes through the plume."""
        time = column("time_s")
        at = np.arange(0.0, time[-1], TIME_STEP)
        north, east, up = (
            CubicHermiteSpline(time, column(place), column(rate))(at)
            for place, rate in (
                ("north_m", "velocity_north_mps"), ("east_m", "velocity_east_mps"), ("altitude_m", "climb_rate_mps"),
            )
        )  # fmt: skip
        plume = self._exhaust.sample(at, north, east, up)
        air = self._background + self._exhaust.excess(plume.dilution)
        airspeed = np.interp(at, time, column("airspeed_mps"))
        pressure = _AIR_DENSITY * (0.5 * self._settings.dynamic_pressure_fraction * airspeed**2 - GRAVITY * up) / 100.0
        readings = self._sniffer.advance(air, pressure)
        held = np.clip(np.searchsorted(readings.time, time, side="right") - 1, 0, len(readings) - 1)
        above, fraction = up - plume.axis_height, fraction_of_axis(plume)
        along = [np.interp(time, at, values) for values in (*air.T, plume.across, above, fraction)]
        columns = np.column_stack([*along[: len(GASES)], readings.values[held], *along[len(GASES) :]])
        if not since < at[-1]:
            return Evaluation(columns=columns)
        measured, flown = readings.time >= since, at >= since
        limit, fuel, expected = self._settings.limit_percent, self._exhaust.fuel, expected_fsc(self._exhaust.fuel)
        known = fuel_estimate(
            Readings(readings.time[measured], readings.values[measured]), self._spec, limit=limit, expected=expected
        )
        figures = {
            "sensor": self._settings.sensor,
            "fsc_fuel_percent": fuel.sulphur_percent,
            "fsc_expected_percent": expected,
            "sulphur_limit_percent": limit,
        }
        excess = air[:, CO2] - self._background[CO2]
        passed = pass_figures(plume.across[flown], above[flown], fraction[flown], excess[flown], time_step=TIME_STEP)
        return Evaluation(
            columns=columns,
            figures=figures | passed | known.figures,
            tables={SULPHUR_TABLE: known.over_time},
            document=known.document,
        )
