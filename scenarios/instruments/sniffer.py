"""A sniffer on board: the air along the flight, the readings in flight or after it, and how well
the passes hit the plume.

The air is sampled at even times between samples of the flight. The result is the same in parts,
during the flight, as all at once after it.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, ClassVar

import numpy as np
import numpy.typing as npt
from pydantic import BeforeValidator

from common.columns import Column, described
from common.physics import STANDARD_GRAVITY
from common.run_layout import SULPHUR_TABLE
from common.text import did_you_mean
from gnc.errors import InfeasibleError
from gnc.estimation.navigation import MeasuredMotion
from measurement.emission import expected_fsc
from measurement.errors import MeasurementError
from measurement.gases import GASES, UNITS
from measurement.plume.fluctuating_plume import HIT, PlumeSample, passes
from measurement.rules import RULES
from measurement.sniffer.sniffer import Readings
from measurement.sniffer.spec import SnifferSpec, sensor_of, sensor_presets
from scenarios.instruments.failing_sniffer import FailingSniffer
from scenarios.instruments.fuel_estimate import FIGURES, TABLES, fuel_estimate
from scenarios.instruments.gas_channels import GasChannels, channels_of, gas_columns
from scenarios.instruments.instrument import Declarations, Evaluation, payload
from scenarios.scenario.scenario import Scenario
from scenarios.world.faults import OF_SNIFFER
from scenarios.world.plume import Background, Exhaust
from scenarios.world.world import World

Array = npt.NDArray[np.float64]

TIME_STEP = 0.05
"""Between the places at which the air is sampled [s]: a metre at 20 m/s, a tenth of the narrowest
plume.
"""

CLEAN_AIR = {"so2": 0.2, "co2": 420.0, "no": 0.1, "no2": 1.0}
"""Gases in clean air over the sea, in the units of readings; assumptions. They are far below the
noise, but for CO2.
"""

CO2 = GASES.index("co2")
"""Its column."""

PLACE_COLUMNS = ("north_m", "east_m", "altitude_m")
RATE_COLUMNS = ("velocity_north_mps", "velocity_east_mps", "climb_rate_mps")
"""Columns of a flight's record that say where it goes."""

_AIR_DENSITY = 1.225
"""Of the standard atmosphere at sea level [kg/m^3]."""


_SECTOR = 0.2
"""Distance across the mean axis over that from the ship within which the plume of another ship may
be met, at any height [-]: above a hundredth of its centre it was found up to 0.17, in 18
realisations at winds of 4 to 12 m/s.
"""

_FADED = 3.0
"""Time constants after which a sensor has forgotten a plume: to 5 % [-]."""

_AGAIN = 30.0
"""Time within which a plume that may have been met may be met again [s]: what is read between two
passes is left out with them, since a record in pieces has no verdict.
"""


@dataclass(frozen=True)
class AirSamples:
    """The air at even times.

    Attributes
    ----------
    time : shape (n,) [s]
    air : gases, shape (n, 4), in the order and the units of ``measurement.gases``
    background_co2 : CO2 without the exhaust of the measured ship, shape (n,) [ppm]
    pressure : pressure in the sensors minus that at sea level [hPa], shape (n,)
    above : height over the plume's mean axis [m], shape (n,)
    foreign : whether the plume of another ship may be there, shape (n,)
    plume : there
    """

    time: Array
    air: Array
    background_co2: Array
    pressure: Array
    above: Array
    foreign: npt.NDArray[np.bool_]
    plume: PlumeSample

    @classmethod
    def joined(cls, parts: "list[AirSamples]") -> "AirSamples":
        """Join successive parts into one."""
        if len(parts) == 1:
            return parts[0]

        def whole(of: str) -> Any:
            return np.concatenate([getattr(part, of) for part in parts])

        def of_plume(of: str) -> Array:
            return np.concatenate([getattr(part.plume, of) for part in parts])

        plume = PlumeSample(*(of_plume(name) for name in PlumeSample._fields))
        names = ("time", "air", "background_co2", "pressure", "above", "foreign")
        return cls(plume=plume, **{name: whole(name) for name in names})


class AirSampler:
    """Samples the air along a path that is given in parts. Between two places the path is the cubic
    through them and their rates.

    Parameters
    ----------
    exhaust, background : exhaust of the measured ship, and CO2 of the other air
    others : exhausts of other ships
    dynamic_pressure_fraction : fraction of the dynamic pressure that the inlet passes on to the
        sensors [-]
    """

    def __init__(
        self,
        exhaust: Exhaust,
        background: Background,
        others: Sequence[Exhaust] = (),
        *,
        dynamic_pressure_fraction: float,
    ) -> None:
        self._exhaust, self._background, self._others = exhaust, background, others
        self._fraction, self._taken = dynamic_pressure_fraction, 0
        self._clean = np.array([CLEAN_AIR[gas] for gas in GASES])

    def advance(self, time: Array, place: Array, rate: Array, airspeed: Array) -> AirSamples:
        """Return the samples that are complete, those before the last given time.

        Parameters
        ----------
        time : times from the last one of the previous call on, shape (n,) [s]
        place, rate : north, east and altitude, shape (n, 3) [m], and their rates [m/s]
        airspeed : shape (n,) [m/s]
        """
        from scipy.interpolate import CubicHermiteSpline

        end = max(self._taken, math.ceil(time[-1] / TIME_STEP))
        at = TIME_STEP * np.arange(self._taken, end, dtype=np.float64)
        self._taken = end
        north, east, up = CubicHermiteSpline(time, place, rate)(at).T
        plume = self._exhaust.sample(at, north, east, up)
        flown = np.interp(at, time, airspeed)
        clean = np.tile(self._clean, (len(at), 1))
        clean[:, CO2] += self._background.at(at)
        foreign = np.zeros(len(at), dtype=np.bool_)
        for other in self._others:
            smoke = other.sample(at, north, east, up)
            clean += other.excess(smoke.dilution)
            foreign |= np.abs(smoke.across) <= _SECTOR * smoke.distance
        return AirSamples(
            time=at,
            air=clean + self._exhaust.excess(plume.dilution),
            background_co2=clean[:, CO2],
            pressure=_AIR_DENSITY
            * (0.5 * self._fraction * flown**2 - STANDARD_GRAVITY * up)
            / 100.0,
            above=up - plume.axis_height,
            foreign=foreign,
            plume=plume,
        )


INSIDE = math.exp(-2.0)
"""Concentration over that of the axis from which a place counts as inside the plume [-]: two
spreads from the axis.
"""


PASS_FIGURES = described(
    {
        "plume_axis_crossings": "crossings of the smoke's mean axis seen from above, in the time"
        " evaluated, with smoke or without",
        "smoke_passes": "of those crossings the ones with smoke: once above exp(-2) of the"
        " concentration in the plume's centre",
        "hit_rate": Column(
            "of those crossings the share whose peak is above 0.6 of the concentration in the"
            " centre of the plume",
            title="Hit rate",
        ),
        "seconds_in_plume_s": "time in which the concentration is above exp(-2) of that on the"
        " axis",
        "dose_per_pass_ppm_s": "mean over plume_axis_crossings, with smoke or without, of the"
        " integral of CO2 above clean air",
        "axis_height_error_mean_m": "mean height of plume_axis_crossings above the plume's own"
        " axis",
        "axis_height_error_rms_m": "root mean square height of plume_axis_crossings above the"
        " plume's own axis",
    }
)
"""Columns of the summary."""


OTHERS_FIGURES = described(
    {
        "others_left_out": Column(
            "share of the readings that the estimate of the fuel does without, as the plume of"
            " another ship may be in them",
            title="Readings left out for plumes of other ships",
            digits=3,
            worse="higher",
        ),
    }
)
"""More of them, of flights beside other ships that emit."""


def fraction_of_axis(plume: PlumeSample) -> Array:
    """Return the concentration over that in the centre of the plume's cross-section; 0 where there
    is no plume.
    """
    inside = plume.axis_dilution > 0.0
    return np.divide(
        plume.dilution, plume.axis_dilution, out=np.zeros_like(plume.dilution), where=inside
    )


def pass_figures(
    across: Array, above: Array, fraction: Array, excess_co2: Array, *, time_step: float
) -> dict[str, float]:
    """Return figures of the passes of a flight.

    If the UAV changes sides of the plume's mean axis, seen from above, that is a crossing, even
    without smoke: the UAV may be above or below the plume, and the plume may have meandered away. A
    pass counts as a pass through smoke if the UAV was inside the plume (``INSIDE``) at one sample
    or more.

    Parameters
    ----------
    across, above : from the plume's axis, NaN where there is no plume, shape (n,) [m]
    fraction : same as ``fraction_of_axis``
    excess_co2 : above clean air [ppm]
    time_step : between samples [s]
    """
    found = list(passes(across))
    inside = float(time_step * np.count_nonzero(fraction > INSIDE))
    if not found:
        return {"plume_axis_crossings": 0, "smoke_passes": 0, "seconds_in_plume_s": inside}
    peaks = np.array([np.max(fraction[at]) for at in found])
    error = above[[at.start + int(np.nanargmin(np.abs(across[at]))) for at in found]]
    return {
        "plume_axis_crossings": len(found),
        "smoke_passes": int(np.count_nonzero(peaks > INSIDE)),
        "hit_rate": float(np.mean(peaks > HIT)),
        "seconds_in_plume_s": inside,
        "dose_per_pass_ppm_s": float(time_step * np.sum(excess_co2) / len(found)),
        "axis_height_error_mean_m": float(np.mean(error)),
        "axis_height_error_rms_m": float(np.sqrt(np.mean(error**2))),
    }


_PASSED_ON = 0.45
"""Time between readings that are passed on in flight, at least [s]: those of a faster sniffer come
together.
"""


_NOT_FLOWN = "unspecified"
"""Preset for the instrument of a log when nothing is known of it: it has no noise to sample."""


_NO_RULE = "none"
"""Name that stands for no rule."""


def _rules() -> tuple[str, ...]:
    """Return the names of rules by which ships are reported."""
    return (_NO_RULE, *RULES)


def flown_presets() -> tuple[str, ...]:
    """Return the names of the sniffers that can be flown."""
    return tuple(name for name in sensor_presets() if name != _NOT_FLOWN)


def _choices() -> tuple[str, ...]:
    """Return the possible values of a sensor, in words."""
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
    sensor : a preset of measurement/sniffer/presets, or an inline table with the same keys
    channels : further channels, a table by gas, ch4, bc or pn, with the keys of those of a sensor:
        methane, black carbon and the number of particles that the ship emits
    exact : whether the instrument is exactly as its data sheet says; otherwise gains, zeros,
        responses and cross-sensitivities are sampled within the stated uncertainties
    limit_percent : limit of the sulphur content for the verdict [% m/m]: 0.1 in an emission control
        area, 0.5 elsewhere
    rule : of measurement/estimate/verdict.py, by which a ship is reported as suspect; none for no
        such rule
    dynamic_pressure_fraction : fraction of the dynamic pressure that the inlet passes on to the
        sensors [-]
    """

    sensor: Annotated[str | dict[str, Any], BeforeValidator(_name_or_table)] = field(
        default="electrochemical", metadata={"choices": _choices}
    )
    channels: dict[str, Any] | None = field(
        default=None, metadata={"choices": lambda: ("a table",)}
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
                raise MeasurementError(f"sensor is an invalid table: {error}") from None
            if "co2" not in (gases := self.spec.gases):
                raise MeasurementError(
                    f"sensor is an invalid table: its channels are {', '.join(gases)}, and co2,"
                    " which shows the plume, is not"
                    " among them: add the table payload.sensor.channels.co2"
                )
        try:
            channels_of(self.channels or {})
        except MeasurementError as error:
            raise MeasurementError(f"channels is an invalid table: {error}") from None
        if not 0.0 < self.limit_percent <= 5.0:
            raise MeasurementError(
                f"limit_percent is {self.limit_percent:g}; give above 0 to 5 % m/m, as 0.1 in an"
                " emission control area"
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
            "co2_background_ppm": "true CO2 of the air without the exhaust of the measured ship",
            "plume_across_m": "place across the plume's mean axis",
            "plume_above_m": "height above the plume's mean axis",
            "plume_fraction": "concentration over that in the centre of the plume",
        }
    )
    FIGURES = FIGURES | PASS_FIGURES
    TABLES = TABLES
    FILLED_BY: ClassVar[Mapping[str, Callable[[Any], Declarations]]] = {"channels": gas_columns}

    def __init__(self, scenario: Scenario, world: World, generator: np.random.Generator) -> None:
        if world.exhaust is None:
            raise InfeasibleError(
                "payload.instruments has a sniffer, and there is no exhaust: set emission.ship"
            )
        self._exhaust = world.exhaust
        self._settings = scenario.payload.settings(type(self))
        fault = world.faults.first(OF_SNIFFER)
        self.spec: SnifferSpec = self._settings.spec
        actual = self.spec if self._settings.exact else self.spec.drawn(generator)
        channels = channels_of(self._settings.channels or {})
        self._gases = GasChannels(
            channels,
            world.exhaust.ratios,
            scenario,
            self.spec,
            exact=self._settings.exact,
            fault=fault,
            generator=generator,
            time_step=TIME_STEP,
        )
        if channels:
            added = gas_columns(channels)
            self.COLUMNS = {**self.COLUMNS, **added.histories}
            self.FIGURES = {**self.FIGURES, **added.figures}
        self._sniffer = FailingSniffer(actual, fault, generator=generator, time_step=TIME_STEP)
        self._others = [ship for ship in world.traffic if ship.exhaust is not None]
        if self._others:
            self.FIGURES = {**self.FIGURES, **OTHERS_FIGURES}
        self._sampler = AirSampler(
            self._exhaust,
            world.background,
            [ship.exhaust for ship in self._others if ship.exhaust is not None],
            dynamic_pressure_fraction=self._settings.dynamic_pressure_fraction,
        )
        self._air: list[AirSamples] = []
        self._read: list[Readings] = []
        self._methane = scenario.emission.methane
        # The flight since the air was last sampled: time, place, rates and airspeed.
        self._path: list[tuple[float, ...]] = []
        self._count = 0

    @property
    def limit_percent(self) -> float:
        """Sulphur content that the verdict is on [% m/m]."""
        limit: float = self._settings.limit_percent
        return limit

    def readings(self, since: float) -> Readings:
        """Return the readings since a time [s], without those that the plume of another ship may
        have affected. The place of that plume is known from the ship's reports and the wind.
        """
        return self._kept(since)[0]

    def _kept(self, since: float) -> tuple[Readings, npt.NDArray[np.bool_]]:
        """Return those readings, and their mask among all readings."""
        read = _joined(self._read)
        kept = read.time >= since
        if self._others:
            kept &= ~self._foreign(read.time)
        return Readings(read.time[kept], read.values[kept]), kept

    def _foreign(self, time: Array) -> npt.NDArray[np.bool_]:
        """Return whether readings at some times [s] may contain the plume of another ship, or lie
        between two such readings.
        """
        met = [part.time[part.foreign] for part in self._air]
        times = np.concatenate([np.full(1, -np.inf), *met])
        since = time - times[np.searchsorted(times, time, side="right") - 1]
        channels = (self.spec.known(gas) for gas in ("so2", "co2"))
        memory = max(_AGAIN, *(of.delay_s + _FADED * sum(of.constants) for of in channels))
        return np.asarray(since <= memory)

    def follow(
        self, time: float, motion: MeasuredMotion, sample: tuple[float, ...]
    ) -> Sequence[tuple[float, float]]:
        """Return the times [s] and the CO2 [ppm] of the readings so far; called for each row of the
        flight's record.

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
        """Continue along a path; return the readings on it."""
        air = self._sampler.advance(time, place, rate, airspeed)
        new = self._sniffer.advance(air.air, air.pressure)
        self._gases.advance(air.air[:, CO2] - air.background_co2, air.pressure)
        self._air.append(air)
        self._read.append(new)
        self._count += len(new)
        return new

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
            [
                *along[: len(GASES)],
                readings.values[held],
                *along[len(GASES) :],
                *self._gases.columns(time, at, held),
            ]
        )
        if not since < at[-1]:
            return Evaluation(columns=columns)
        flown = at >= since
        limit = self._settings.limit_percent
        fuel = self._exhaust.fuel
        expected = expected_fsc(fuel, self._methane)
        used, kept = self._kept(since)
        known = fuel_estimate(
            used,
            self.spec,
            limit=limit,
            expected=expected,
            rule=RULES.get(self._settings.rule),
        )
        left_out = self._left_out(since, known.figures) if self._others else {}
        of_gases, records = self._gases.estimates(used, kept)
        document = known.document
        if document is not None and records:
            document = {**document, "gases": records}
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
            figures=figures | passed | known.figures | left_out | of_gases,
            tables={SULPHUR_TABLE: known.over_time},
            document=document,
        )

    def _left_out(self, since: float, known: Mapping[str, Any]) -> dict[str, Any]:
        """Return the figures of the estimate, and of the readings that are left out because of
        other ships' plumes.
        """
        time = _joined(self._read).time
        time = time[time >= since]
        share = float(np.mean(self._foreign(time))) if len(time) else 0.0
        reason = known.get("sulphur_reason", "")
        if share > 0.0 and known["sulphur_quality"] != "A":
            names = ", ".join(ship.name for ship in self._others)
            words = f"{100.0 * share:.0f} % of the readings are left out for the plume of {names}"
            reason = f"{reason}; {words}" if reason else words
        return {"others_left_out": share, "sulphur_reason": reason}


def _joined(parts: list[Readings]) -> Readings:
    """Join successive parts of readings into one, and keep the result."""
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
