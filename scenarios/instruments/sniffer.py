"""A sniffer on board: what it reads of the exhaust, in flight or after it, and what that says of
the fuel.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt
from pydantic import BeforeValidator

from common.columns import described
from common.run_layout import SULPHUR_TABLE
from common.text import did_you_mean
from gnc.errors import InfeasibleError
from gnc.estimation.navigation import MeasuredMotion
from measurement.emission import expected_fsc
from measurement.errors import MeasurementError
from measurement.gases import GASES, UNITS
from measurement.rules import RULES
from measurement.sniffer.sniffer import Readings, Sniffer
from measurement.sniffer.spec import SnifferSpec, sensor_of, sensor_presets
from scenarios.instruments.air_samples import (
    CO2,
    PLACE_COLUMNS,
    RATE_COLUMNS,
    TIME_STEP,
    AirSampler,
    AirSamples,
)
from scenarios.instruments.fuel_estimate import FIGURES, TABLES, fuel_estimate
from scenarios.instruments.instrument import Evaluation, payload
from scenarios.instruments.plume_passes import PASS_FIGURES, fraction_of_axis, pass_figures
from scenarios.scenario.scenario import Scenario
from scenarios.world.faults import SNIFFER_DEAD, SNIFFER_SATURATED
from scenarios.world.world import World

Array = npt.NDArray[np.float64]

_PASSED_ON = 0.45
"""Time between readings that are passed on in flight, at least [s]: those of a faster sniffer come
together.
"""


_NOT_FLOWN = "unspecified"
"""Preset of a log's instrument of which nothing is known: there is no noise to sample."""


_NO_RULE = "none"
"""Name that stands for no rule."""


def _rules() -> tuple[str, ...]:
    """Return the names of rules by which ships are reported."""
    return (_NO_RULE, *RULES)


def flown_presets() -> tuple[str, ...]:
    """Return the names of the sniffers that can be flown."""
    return tuple(name for name in sensor_presets() if name != _NOT_FLOWN)


def _choices() -> tuple[str, ...]:
    """Return what a sensor may be, in words."""
    return (*flown_presets(), "a table")


def _name_or_table(given: Any) -> Any:
    if not isinstance(given, str | Mapping):
        raise MeasurementError(
            "give the name of a preset, or a table with a table per gas in channels"
        )
    return given


@dataclass(frozen=True, kw_only=True)
class SnifferSettings:
    """Keys of the sniffer.

    Attributes
    ----------
    sensor : a preset of measurement/sniffer/presets, or a table of one's own with the keys of these
    exact : whether the instrument is as its data sheet says; otherwise gains, zeros, responses and
        cross-sensitivities are sampled within what is stated
    limit_percent : sulphur content that the verdict is on [% m/m]: 0.1 in an emission control area,
        0.5 elsewhere
    rule : of measurement/estimate/verdict.py, by which a ship is reported as suspect; none for no
        such rule
    dynamic_pressure_fraction : fraction of the dynamic pressure that the inlet passes on to the
        sensors [-]
    """

    sensor: Annotated[str | dict[str, Any], BeforeValidator(_name_or_table)] = field(
        default="electrochemical", metadata={"choices": _choices}
    )
    exact: bool = False
    limit_percent: float = 0.1
    rule: str = field(default=_NO_RULE, metadata={"choices": _rules})
    dynamic_pressure_fraction: float = field(default=0.2, metadata={"limits": (0.0, 1.0)})

    def __post_init__(self) -> None:
        if isinstance(self.sensor, str):
            if self.sensor not in (known := flown_presets()):
                guess = did_you_mean(self.sensor, known) or ";"
                raise MeasurementError(
                    f"sensor is {self.sensor!r}{guess} there are {', '.join(known)}"
                )
        else:
            try:
                self.spec.check_known()
            except MeasurementError as error:
                raise MeasurementError(f"sensor is a table of no use: {error}") from None
            if "co2" not in (gases := self.spec.gases):
                raise MeasurementError(
                    f"sensor is a table of no use: its channels are {', '.join(gases)}, and co2, which shows the plume, is not"
                    " among them: add the table payload.sensor.channels.co2"
                )
        if not 0.0 < self.limit_percent <= 5.0:
            raise MeasurementError(
                f"limit_percent is {self.limit_percent:g}; give above 0 to 5 % m/m, as 0.1 in an emission control area"
            )
        if self.rule not in _rules():
            guess = did_you_mean(self.rule, _rules()) or ";"
            raise MeasurementError(f"rule is {self.rule!r}{guess} there are {', '.join(_rules())}")
        if not 0.0 <= self.dynamic_pressure_fraction <= 1.0:
            raise MeasurementError(
                f"dynamic_pressure_fraction is {self.dynamic_pressure_fraction:g}; give 0 to 1"
            )

    @property
    def spec(self) -> SnifferSpec:
        """Return the sniffer by its data sheet."""
        return sensor_of(self.sensor)


@payload("sniffer")
class SnifferOnBoard:
    """Reads the exhaust along the flight."""

    SETTINGS = SnifferSettings
    COLUMNS = described(
        {f"{gas}_{UNITS[gas]}": "true concentration along the path" for gas in GASES}
        | {f"{gas}_reading_{UNITS[gas]}": "reading, held until the next one" for gas in GASES}
        | {
            "co2_background_ppm": "true CO2 of the air without the exhaust",
            "plume_across_m": "place across the plume's mean axis",
            "plume_above_m": "height above the plume's mean axis",
            "plume_fraction": "concentration over that in the centre of the plume",
        }
    )
    FIGURES = FIGURES | PASS_FIGURES
    TABLES = TABLES

    def __init__(self, scenario: Scenario, world: World, generator: np.random.Generator) -> None:
        if world.exhaust is None:
            raise InfeasibleError(
                "payload.instruments has a sniffer, and there is no exhaust: set emission.ship"
            )
        self._exhaust, self._settings, self._fault = (
            world.exhaust,
            scenario.payload.settings(type(self)),
            world.fault,
        )
        self.spec: SnifferSpec = self._settings.spec
        actual = self.spec if self._settings.exact else self.spec.drawn(generator)
        self._sniffer = Sniffer(actual, generator=generator, time_step=TIME_STEP)
        self._sampler = AirSampler(
            self._exhaust,
            world.background,
            dynamic_pressure_fraction=self._settings.dynamic_pressure_fraction,
        )
        self._air: list[AirSamples] = []
        self._read: list[Readings] = []
        ends = {channel.gas: channel.range_high for channel in actual.channels}
        self._full, self._stuck = (
            np.array([value.get(gas, np.nan) for gas in GASES]) for value in (ends, {})
        )
        # What is known of the flight since the air was last sampled: time, place, rates and
        # airspeed.
        self._path: list[tuple[float, ...]] = []
        self._count = 0

    @property
    def limit_percent(self) -> float:
        """Sulphur content that the verdict is on [% m/m]."""
        limit: float = self._settings.limit_percent
        return limit

    def readings(self, since: float) -> Readings:
        """Return what has been read since a time [s]."""
        read = _joined(self._read)
        late = read.time >= since
        return Readings(read.time[late], read.values[late])

    def follow(
        self, time: float, motion: MeasuredMotion, sample: tuple[float, ...]
    ) -> Sequence[tuple[float, float]]:
        """Return the times [s] and the CO2 [ppm] of the readings that have come; called for each
        row of the flight's record.

        Parameters are those of ``scenarios.instruments.instrument.Instrument.read``.
        """
        north, east, v_north, v_east, _ = motion
        altitude, airspeed, _, climb_rate, *_ = sample
        self._path.append((time, north, east, altitude, v_north, v_east, climb_rate, airspeed))
        if time <= self._count / self.spec.rate_hz or time - self._path[0][0] < _PASSED_ON:
            return ()
        path = np.array(self._path)
        del self._path[:-1]
        new = self._advance(path[:, 0], path[:, 1:4], path[:, 4:7], path[:, 7])
        return list(zip(new.time.tolist(), new.values[:, CO2].tolist(), strict=True))

    def _advance(self, time: Array, place: Array, rate: Array, airspeed: Array) -> Readings:
        """Go on along a path; return what is read of it."""
        air = self._sampler.advance(time, place, rate, airspeed)
        new = self._failed(self._sniffer.advance(air.air, air.pressure))
        self._air.append(air)
        self._read.append(new)
        self._count += len(new)
        return new

    def _failed(self, read: Readings) -> Readings:
        """Return readings as a fault leaves them: a dead sniffer repeats its last one, a saturated
        one reads its range's end.
        """
        kind, values = self._fault.kind, read.values
        good = read.time < self._fault.begins
        if kind == SNIFFER_SATURATED:
            values[~good] = self._full
        elif kind == SNIFFER_DEAD:
            if good.any():
                self._stuck = values[good][-1].copy()
            values[~good] = self._stuck
        return read

    def evaluate(self, column: Callable[[str], Array], since: float) -> Evaluation:
        """Return readings, and figures of the passes through the plume."""
        time = column("time_s")
        left = time >= self._path[0][0] if self._path else np.ones(len(time), bool)
        if np.count_nonzero(left) > 1:
            place, rate = (
                np.column_stack([column(name)[left] for name in names])
                for names in (PLACE_COLUMNS, RATE_COLUMNS)
            )
            self._advance(time[left], place, rate, column("airspeed_mps")[left])
        samples, readings = AirSamples.joined(self._air), _joined(self._read)
        at, air, above, plume = samples.time, samples.air, samples.above, samples.plume
        background = samples.background_co2
        held = np.clip(np.searchsorted(readings.time, time, side="right") - 1, 0, len(readings) - 1)
        fraction = fraction_of_axis(plume)
        beside = (background, plume.across, above, fraction)
        along = [np.interp(time, at, values) for values in (*air.T, *beside)]
        columns = np.column_stack(
            [*along[: len(GASES)], readings.values[held], *along[len(GASES) :]]
        )
        if not since < at[-1]:
            return Evaluation(columns=columns)
        flown = at >= since
        limit, fuel, expected = (
            self._settings.limit_percent,
            self._exhaust.fuel,
            expected_fsc(self._exhaust.fuel),
        )
        known = fuel_estimate(
            self.readings(since),
            self.spec,
            limit=limit,
            expected=expected,
            rule=RULES.get(self._settings.rule),
        )
        figures = {
            "sensor": self.spec.name,
            "fsc_fuel_percent": fuel.sulphur_percent,
            "fsc_expected_percent": expected,
            "sulphur_limit_percent": limit,
        }
        excess = air[:, CO2] - background
        passed = pass_figures(
            plume.across[flown], above[flown], fraction[flown], excess[flown], time_step=TIME_STEP
        )
        return Evaluation(
            columns=columns,
            figures=figures | passed | known.figures,
            tables={SULPHUR_TABLE: known.over_time},
            document=known.document,
        )


def _joined(parts: list[Readings]) -> Readings:
    """Return readings that follow each other as one, and keep them so."""
    if len(parts) > 1:
        parts[:] = [
            Readings(
                *(
                    np.concatenate([getattr(part, name) for part in parts])
                    for name in ("time", "values")
                )
            )
        ]
    return parts[0] if parts else Readings(np.empty(0), np.empty((0, len(GASES))))
