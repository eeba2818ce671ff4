"""Figures of any gas by its ratio to CO2: the estimate of SO2 with another gas in its place.

The fit has two gases: CO2, and the gas that is compared with it, in the column of SO2. So every gas
is treated like SO2 in response, background, noise, quality and verdict; only the constants of
``measurement.species`` differ.

NOx is the sum of NO and NO2. Its cell is that of NO, which reads NOx less NO2: a cross-sensitivity
of -1 to NO2. So both are brought to one response, and the gain of NO2 has its part in the
uncertainty.
"""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np
import pandas as pd

from measurement.emission import NO2_SHARE
from measurement.engine import Engine, Limit
from measurement.errors import MeasurementError
from measurement.estimate.estimator import Figure, figures_of, measure_ratio
from measurement.estimate.quality import quality_class
from measurement.estimate.result import Figures, Method, Quality, plain
from measurement.estimate.signals import make_signals, signals_table
from measurement.estimate.verdict import REJECTED, Verdict, interval, judged, probability
from measurement.gases import GASES
from measurement.sniffer.channel import Channel
from measurement.sniffer.lag import Array
from measurement.sniffer.sniffer import Readings
from measurement.sniffer.spec import SnifferSpec
from measurement.species import PER_ENERGY, SLOT, SPECIES, Species

NO2_SHARE_SD = 0.03
"""Standard deviation of the share of NO2 in NOx that is not measured [-]: 0.05 to 0.15, evenly."""

AIR_SD = 0.01
"""Relative standard deviation of the volume of air in which particles are counted [-]: 3 K."""

_SHOWN = 300
"""Approximate number of samples of a gas in its record."""

ERRORS = {
    "noise": "noise, background and differences between passes",
    "calibration": "calibration of {gas} and CO2",
    "no": "correction for NO",
    "no2": "reading of NO2",
    "response": "response time and delay",
    "carbon": "carbon content of the fuel",
    "sampling": "time between readings",
    "load": "load of the engine, by the ship's speed",
    "consumption": "consumption of the engine about its class",
    "air": "temperature and pressure of the air",
    "overlap": "passes that overlap",
}
"""Names of errors in words."""


@dataclass(frozen=True, kw_only=True)
class GasReadings:
    """The readings of a gas in the form that the fit takes.

    Attributes
    ----------
    species : its constants
    readings, instrument : with the gas in the place of SO2
    remarks : how the gas was made of the log's columns
    own_column : whether the log has a column of the gas; NOx may be made of NO and NO2
    """

    species: Species
    readings: Readings
    instrument: SnifferSpec
    remarks: tuple[str, ...] = ()
    own_column: bool = True


@dataclass(frozen=True, kw_only=True)
class GasEstimate:
    """A figure of a gas with its uncertainty; NaN where it is unknown.

    Attributes
    ----------
    gas, title, figure, unit, source : of the gas, its figure, and its constants
    value, noise, common, total : the figure, and its standard uncertainties by noise, by errors
        that do not average out (by name), and by all of these [unit]
    low, high : 95 % interval [unit]
    slope, slope_unit : ratio to CO2
    per_fuel, per_fuel_unit : the figure per fuel, if ``value`` is per kWh; otherwise ``value``
    carbon : mass share of the fuel [-]
    quality, quality_reasons : A, B or C, and why it is not A
    verdict, no_verdict : verdict on its limit, or the reason why there is no verdict
    stage : limit of NOx of the engine, or None
    rated_rpm : of the engine; NaN where it is unknown [1/min]
    load, load_sd, consumption_kg_kwh : of the engine, as expected from its speed
    agreement, misfit : see ``FscEstimate``
    t90_s, delay_s : response, and delay after CO2, as stated or fitted [s]
    figures : of the record
    remarks : how the gas was made of the log's columns
    signals : equalised signals; a row per sample
    """

    gas: str
    title: str
    figure: str
    unit: str
    source: str
    value: float
    noise: float
    common: Mapping[str, float]
    total: float
    low: float
    high: float
    slope: float
    slope_unit: str
    per_fuel: float
    per_fuel_unit: str
    carbon: float
    quality: Quality
    quality_reasons: tuple[str, ...]
    verdict: Verdict | None
    no_verdict: str
    stage: Limit | None
    rated_rpm: float
    load: float
    load_sd: float
    consumption_kg_kwh: float
    agreement: float
    misfit: float
    t90_s: float
    delay_s: float
    digits: int
    figures: Figures
    remarks: tuple[str, ...]
    signals: pd.DataFrame = field(compare=False, repr=False)

    def record(self) -> dict[str, Any]:
        """Return everything but the signals, for JSON, with None for NaN.

        It contains a selection of the signals' samples, for a figure: ``co2_ppm`` and ``excess``
        over it.
        """
        nested = ("figures", "verdict", "stage")
        values = {name: value for name, value in vars(self).items() if name != "signals"}
        for name in nested:
            values[name] = None if values[name] is None else asdict(values[name])
        values["common"] = dict(self.common)
        table = self.signals.dropna(subset=["co2_excess_ppm", "so2_excess_ppb"])
        some = table.iloc[:: max(1, len(table) // _SHOWN)]
        step = SPECIES[self.gas].step if self.gas in SPECIES else 1.0
        values["samples"] = {
            "co2_ppm": [float(f"{x:.5g}") for x in some["co2_excess_ppm"]],
            "excess": [float(f"{step * y:.5g}") for y in some["so2_excess_ppb"]],
        }
        return {name: plain(value) for name, value in values.items()}

    @property
    def load_share(self) -> float:
        """Share of the load in the variance of the figure [-]; 0 where the load has no effect."""
        return self.common.get("load", 0.0) ** 2 / self.total**2 if self.total > 0.0 else 0.0


def placed(
    species: Species,
    channel: Channel,
    column: Array,
    readings: Readings,
    instrument: SnifferSpec,
    *,
    with_no2: bool = False,
    remarks: tuple[str, ...] = (),
) -> GasReadings:
    """Return a gas in the place of SO2.

    Parameters
    ----------
    channel : of the gas; its name is that of SO2
    column : its readings, shape (m,)
    readings, instrument : with CO2, and with NO2 where it contributes
    """
    values = np.full((len(readings.time), len(GASES)), np.nan)
    values[:, GASES.index(SLOT)] = column / species.step
    kept = ("co2", "no2") if with_no2 else ("co2",)
    for gas in kept:
        values[:, GASES.index(gas)] = readings.values[:, GASES.index(gas)]
    channels = (_in_steps(channel, species.step), *(instrument.known(gas) for gas in kept))
    return GasReadings(
        species=species,
        readings=Readings(readings.time, values),
        instrument=replace(instrument, channels=channels, compared=species),
        remarks=remarks,
    )


def _in_steps(channel: Channel, step: float) -> Channel:
    """Return a channel in the place of SO2, with readings in steps of its unit."""
    names = ("noise", "random_walk", "resolution", "range_low", "range_high", "zero", "zero_sd")
    return replace(channel, gas=SLOT, **{name: getattr(channel, name) / step for name in names})


def nox_of(readings: Readings, instrument: SnifferSpec) -> GasReadings | None:
    """Return NOx from the readings of NO, and of NO2 if there are any; None without NO."""
    known = {
        gas: instrument.channel(gas) is not None
        and bool(np.isfinite(readings.values[:, GASES.index(gas)]).any())
        for gas in ("no", "no2")
    }
    if not known["no"]:
        return None
    no = instrument.known("no")
    column = readings.values[:, GASES.index("no")]
    if known["no2"]:
        # The gain of NO applies to the share of NO in NOx.
        gain_sd = (1.0 - NO2_SHARE) * no.gain_sd
        channel = replace(no, cross={"no2": -1.0}, cross_sd={}, gas=SLOT, gain_sd=gain_sd)
        remark = "the sum of NO and NO2"
    else:
        kept = 1.0 - NO2_SHARE
        channel = replace(
            no,
            gas=SLOT,
            gain=kept * no.gain,
            gain_sd=math.hypot(no.gain_sd, NO2_SHARE_SD / kept),
            cross={},
            cross_sd={},
        )
        remark = f"NO over {kept:g}, as NO2 is not measured"
    found = placed(
        SPECIES["nox"],
        channel,
        column,
        readings,
        instrument,
        with_no2=known["no2"],
        remarks=(remark,),
    )
    return replace(found, own_column=False)


def estimate_gas(
    gas: GasReadings,
    *,
    method: Method = "regression",
    carbon: float | None = None,
    air: tuple[float, float],
    engine: Engine | None = None,
    problems: tuple[str, ...] = (),
) -> GasEstimate:
    """Return the figure of a gas that the readings show.

    Parameters
    ----------
    method : same as for ``estimate``
    carbon : mass share of the fuel [-]; None for that of fuels with this gas
    air : temperature [deg C] and pressure [hPa] of the air in which particles are counted
    engine : of the ship, where it is known; without an engine NOx is per fuel
    problems : further reasons why there can be no verdict

    Raises
    ------
    MeasurementError : the readings cannot be of a flight through a plume
    """
    species = gas.species
    try:
        measured = measure_ratio(gas.readings, gas.instrument, method)
    except MeasurementError as error:
        raise MeasurementError(f"{species.title}: {error}") from None
    carbon = species.carbon if carbon is None else carbon
    factor = species.factor(carbon, air) * species.step
    figure = measured.figure(species, factor)
    if species.mass is None:
        figure = _with_error(figure, "air", AIR_SD)
    per_fuel, unit = figure.value, species.result
    found = [*measured.problems, *measured.pending_problem(figure.value, figure.total)]
    limit, no_verdict = _limit(species, engine)
    load, consumption = (math.nan, math.nan), math.nan
    if species.per_energy and engine is not None:
        unit, load = PER_ENERGY, engine.load or load
        consumption, by_load, by_engine = engine.consumption()
        figure = _with_error(_scaled(figure, consumption), "load", by_load)
        figure = _with_error(figure, "consumption", by_engine)
        if problem := engine.load_problem():
            found.append(problem)
    value, total = figure.value, figure.total
    instrument = measured.ratio.instrument
    table, snr = signals_table(make_signals(measured.record, instrument), measured.ratio.ratio)
    figures = figures_of(measured, snr)
    shown = replace(species, result=unit, most=species.most * _most_over_fuel(unit, species))
    quality, reasons = quality_class(
        problems=[*found, *problems],
        snr=figures.co2_snr,
        passes=len(measured.passes),
        fsc=value,
        deviation=total,
        agreement=measured.fit.agreement,
        limit=None if limit is None else limit.at_load_g_kwh,
        responses_stated=True,
        species=shown,
    )
    low, high = interval(value, total)
    slot = instrument.known(SLOT)
    return GasEstimate(
        gas=species.name,
        title=species.title,
        figure=species.figure,
        unit=unit,
        source=species.source,
        value=value,
        noise=figure.noise,
        common=figure.common,
        total=total,
        low=low,
        high=high,
        slope=measured.ratio.ratio * species.step,
        slope_unit=species.slope_unit,
        per_fuel=per_fuel,
        per_fuel_unit=species.result,
        carbon=carbon,
        quality=quality,
        quality_reasons=reasons,
        verdict=None
        if limit is None
        else judged(limit.at_load_g_kwh, value, total, admitted=quality != REJECTED),
        no_verdict=no_verdict,
        stage=limit,
        rated_rpm=math.nan if engine is None or engine.rated_rpm is None else engine.rated_rpm,
        load=load[0],
        load_sd=load[1],
        consumption_kg_kwh=consumption,
        agreement=measured.fit.agreement,
        misfit=measured.ratio.misfit,
        t90_s=slot.t90_s,
        delay_s=slot.delay_s - instrument.known("co2").delay_s,
        digits=species.digits,
        figures=figures,
        remarks=gas.remarks,
        signals=table,
    )


_KWH_MOST = 0.4
"""Largest consumption of an engine [kg/kWh]."""


def _most_over_fuel(unit: str, species: Species) -> float:
    """Return the factor of the largest figure per fuel in a unit [-]."""
    return _KWH_MOST if unit == PER_ENERGY and species.per_energy else 1.0


def _limit(species: Species, engine: Engine | None) -> tuple[Limit | None, str]:
    """Return the limit of the engine, or None and why there is no verdict on it."""
    if species.per_energy and engine is not None:
        return engine.limit(), engine.limit_problem()
    if species.per_energy:
        return None, "no verdict: give [engine], whose consumption and stage lead to g/kWh"
    if species.judged:
        return None, "judged by the limits of the configuration"
    return None, "no limit on this gas"


def _scaled(figure: Figure, factor: float) -> Figure:
    """Return a figure in another unit."""
    return Figure(
        value=factor * figure.value,
        noise=factor * figure.noise,
        common={name: factor * size for name, size in figure.common.items()},
        assumed=factor * figure.assumed,
    )


def _with_error(figure: Figure, name: str, relative: float) -> Figure:
    """Return a figure with one more error, which is relative to the figure."""
    return replace(figure, common={**figure.common, name: relative * abs(figure.value)})


# Texts, the same on consoles and in reports

SCREENING = (
    "a plume shows one load, and the limit is of a test bed's cycle: a verdict screens, and"
    " certifies nothing"
)
"""Remark on the significance of a verdict on NOx."""


def value_words(found: GasEstimate) -> str:
    """Return a figure with its interval in words."""
    if not math.isfinite(found.value):
        return f"{found.figure}: none can be given"
    digits = found.digits
    return (
        f"{found.figure} {found.value:.{digits}f} {found.unit}, 95 % interval"
        f" {found.low:.{digits}f} to {found.high:.{digits}f} {found.unit}"
    )


def verdict_words(found: GasEstimate) -> str:
    """Return the verdict on a gas in words, or the reason why there is no verdict."""
    verdict, stage = found.verdict, found.stage
    if verdict is None or stage is None:
        return found.no_verdict
    limit = f"{verdict.limit:.1f} {found.unit} (stage {stage.stage}"
    if stage.at_load_g_kwh != stage.cycle_g_kwh:
        limit += f", {stage.cycle_g_kwh:.1f} over the test cycle"
    limit += ")"
    if found.quality == REJECTED:
        return f"no verdict on the limit of {limit}: quality {REJECTED} gives none"
    side = "not shown to be above or below" if verdict.verdict == "open" else verdict.verdict
    return (
        f"{side} the limit of {limit}; probability above it:"
        f" {probability(verdict.probability_above)}"
    )


def error_words(name: str, title: str) -> str:
    """Return the name of an error of a gas in words."""
    return ERRORS.get(name, name).format(gas=title)
