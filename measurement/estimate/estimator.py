"""Estimates the fuel sulphur content of a flight, with uncertainty, quality and verdicts, at its
end or over time.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import pandas as pd

from measurement.errors import MeasurementError
from measurement.estimate.areas import area_ratio
from measurement.estimate.budget import (
    CARBON_SD,
    SAMPLING_SD,
    SULPHATE_SHARE,
    common_errors,
    unmeasured,
)
from measurement.estimate.fit import ExcludedPass, Fit, fit_record
from measurement.estimate.passes import (
    SNR_LEAST,
    Pass,
    co2_excesses,
    coarseness_problem,
    find_passes,
)
from measurement.estimate.plausible import implausibilities
from measurement.estimate.quality import (
    delay_problem,
    noise_explains,
    pending_problem,
    quality_class,
    residual_problem,
)
from measurement.estimate.record import Record, checked_record, readings_noise
from measurement.estimate.result import Figures, FscEstimate, Method, PassContent
from measurement.estimate.signals import make_signals, signals_table, without
from measurement.estimate.timing import (
    DELAY_MOST,
    check_timing_is_stated,
    searched_timing,
    so2_delay,
)
from measurement.estimate.verdict import LIMITS_PERCENT, OPEN, interval, judged
from measurement.gases import CARBON_FRACTION, fsc_factor
from measurement.sniffer.lag import Array
from measurement.sniffer.sniffer import Readings
from measurement.sniffer.spec import SnifferSpec
from measurement.species import SPECIES, Species

ELAPSED_S = (60.0, 120.0, 300.0, 600.0)
"""Times after which the estimate is reported [s]."""

_CARBON_LEAST, _CARBON_MOST = 0.5, 0.95
"""Range of a fuel's carbon [-]. Methanol has 0.375, for which these factors do not hold."""

_OVERLAP_LEAST = 0.95
"""Least share of the SO2 that areas must contain [-]: the share at passes 2.0 t90 apart."""

_DELAY_NEAR = 0.75
"""Difference from the stated delay that the grid of the search may have by chance [s]."""

_EXPLAINED_LEAST = 0.5
"""Least share of a misfit that a delay has to explain to count as the true one [-]."""


@dataclass(frozen=True, kw_only=True)
class Ratio:
    """A ratio of SO2 to CO2, and the results that depend on the method; NaN without a pass.

    Attributes
    ----------
    ratio, noise : [ppb/ppm]
    misfit : mean square of the residuals over that of the noise [-]
    common : standard uncertainties by errors that do not average out, by name [ppb/ppm]
    instrument : with the stated response and delay of SO2, or with those that fit best
    overlap : ratio that separate passes would have, less ``ratio`` [ppb/ppm]
    problems : reasons why there can be no verdict
    """

    instrument: SnifferSpec
    ratio: float = math.nan
    noise: float = math.nan
    misfit: float = math.nan
    common: dict[str, float] = field(default_factory=dict)
    overlap: float = 0.0
    problems: tuple[str, ...] = ()


def estimate(
    readings: Readings,
    instrument: SnifferSpec,
    *,
    method: Method = "regression",
    carbon: float = CARBON_FRACTION,
    limits_percent: Sequence[float] = LIMITS_PERCENT,
    problems: Sequence[str] = (),
) -> FscEstimate:
    """Return the fuel sulphur content that the readings show.

    A weak but valid record gets quality C with the reason, and no verdict.

    Parameters
    ----------
    readings : of a flight through the plume of one ship
    instrument : as the analyst states it
    method : "regression" (equalise and regress), or "areas" over each pass
    carbon : mass share of the fuel [-], 0.5 to 0.95
    limits_percent : limits for the verdicts [% m/m], above 0, at most 10
    problems : further reasons why there can be no verdict

    Raises
    ------
    MeasurementError : the readings cannot be of a flight through a plume: no CO2, or wrong times,
        units or shapes; or a parameter is out of range
    """
    check_parameters(method, carbon, limits_percent)
    measured = measure_ratio(readings, instrument, method)
    measured.problems.extend(problems)
    return _estimate_from(measured, method, carbon, limits_percent)


@dataclass(frozen=True, kw_only=True)
class Measured:
    """The ratio of any gas to CO2 in a record, with the evidence for it.

    Attributes
    ----------
    record, passes, fit, ratio : of the readings
    problems : reasons why there can be no verdict
    """

    record: Record
    passes: tuple[Pass, ...]
    fit: Fit
    ratio: Ratio
    problems: list[str]

    def figure(self, species: Species, factor: float) -> "Figure":
        """Return the figure of a gas from its ratio to CO2, with its errors.

        ``factor`` is the figure per small ratio, of ``Species.factor``.
        """
        ratio, instrument = self.ratio, self.ratio.instrument
        value, slope = species.per_fuel(factor, ratio.ratio)
        absent = unmeasured(instrument, self.record.gases, factor)
        assumed = -sum(shift for shift, _ in absent.values())
        value += assumed
        common = {name: slope * size for name, size in ratio.common.items()}
        for gas, (_, deviation) in absent.items():
            common[gas] = math.hypot(common.get(gas, 0.0), deviation)
        common["carbon"] = CARBON_SD * abs(value)
        constant = instrument.known("co2").constants[0]
        common["sampling"] = SAMPLING_SD * self.record.step / constant * abs(value)
        return Figure(value=value, noise=slope * ratio.noise, common=common, assumed=assumed)

    def pending_problem(self, value: float, total: float) -> tuple[str, ...]:
        """Return the problem of a gas that may still arrive, where its delay is not stated."""
        instrument = self.ratio.instrument
        if not math.isinf(instrument.known("so2").delay_sd_s):
            return ()
        # Of the time in which the gas may arrive after each pass, the share that was read.
        after = [self.record.time - found.end_s for found in self.passes]
        samples = [np.count_nonzero((t > 0.0) & (t <= DELAY_MOST)) for t in after]
        read = [min(1.0, count * self.record.step / DELAY_MOST) for count in samples]
        doses = [found.dose_ppm_s for found in self.passes]
        return pending_problem(instrument.name_of("so2"), value, total, read, doses)


@dataclass(frozen=True, kw_only=True)
class Figure:
    """A figure and its errors, in the figure's unit.

    Attributes
    ----------
    value : NaN where it is unknown
    noise : standard uncertainty by noise
    common : standard uncertainties by errors that do not average out, by name
    assumed : part of the value that corrects for gases that were not measured
    """

    value: float
    noise: float
    common: dict[str, float]
    assumed: float

    @property
    def total(self) -> float:
        """Standard uncertainty by noise and common errors."""
        return math.sqrt(self.noise**2 + sum(value**2 for value in self.common.values()))


def measure_ratio(readings: Readings, instrument: SnifferSpec, method: Method) -> Measured:
    """Return the ratio to CO2 of the gas in the place of SO2, and the problems of the record.

    Raises
    ------
    MeasurementError : same as ``estimate``
    """
    record = checked_record(readings, instrument)
    problems = [*record.problems, *implausibilities(record, readings, instrument)]
    noise = readings_noise(record, instrument)
    channels = [
        replace(channel, noise=noise.get(channel.gas, channel.noise))
        for channel in instrument.channels
    ]
    instrument = replace(instrument, channels=tuple(channels))
    passes = find_passes(record, instrument.known("co2"))
    fit = Fit(instrument=instrument)
    ratio = Ratio(instrument=instrument)
    if not passes:
        problems.append(_no_pass(noise["co2"]))
    else:
        problems += coarseness_problem(passes, record) or _too_short(record, instrument, passes)
        if method == "areas":
            check_timing_is_stated(instrument)
        fit = fit_record(record, searched_timing(record, instrument))
        if method == "regression":
            ratio = _by_regression(record, instrument, fit)
        else:
            ratio = _by_areas(record, instrument, passes)
        problems += [*ratio.problems, *fit.problems]
    return Measured(record=record, passes=passes, fit=fit, ratio=ratio, problems=problems)


def check_parameters(method: str, carbon: float, limits_percent: Sequence[float]) -> None:
    """Check that the parameters of ``estimate`` are in range.

    Raises
    ------
    MeasurementError : one is not
    """
    if method not in ("regression", "areas"):
        raise MeasurementError(f"method is {method!r}; it must be 'regression' or 'areas'")
    if not _CARBON_LEAST <= carbon <= _CARBON_MOST:
        raise MeasurementError(
            f"carbon is {carbon:g}; a fuel's mass share of carbon must be {_CARBON_LEAST:g} to"
            f" {_CARBON_MOST:g}"
        )
    if not limits_percent or not all(0.0 < limit <= 10.0 for limit in limits_percent):
        raise MeasurementError(
            f"limits_percent is {list(limits_percent)}; give one or more numbers above 0, up to"
            " 10 % m/m"
        )


def _no_pass(noise: float) -> str:
    """Return the problem of a record without a pass, given the noise of CO2 [ppm]."""
    if noise == 0.0:
        return "no pass through a plume: CO2 reads the same throughout; check its sensor"
    least = f"{SNR_LEAST * noise:.1f} ppm, {SNR_LEAST:g} times its noise"
    return f"no pass through a plume: CO2 is nowhere {least}, over its background"


def _too_short(record: Record, instrument: SnifferSpec, passes: Sequence[Pass]) -> tuple[str, ...]:
    """Return the problem of a record that is shorter than a pass with the response of SO2."""
    so2 = instrument.known("so2")
    needed = max(found.end_s - found.start_s for found in passes)
    needed += so2.t90_s if math.isfinite(so2.t90_sd) else 0.0
    if record.duration >= needed:
        return ()
    return (
        f"the record lasts {record.duration:.0f} s; a pass and the response of"
        f" {instrument.name_of('so2')} take {needed:.0f} s",
    )


def _by_regression(record: Record, instrument: SnifferSpec, fit: Fit) -> Ratio:
    """Return the slope of SO2 over CO2, with the stated or best-fitting response and delay."""
    problems: tuple[str, ...] = ()
    parts: dict[str, float] = {}
    if fit.residuals is not None:
        parts, energy = common_errors(fit.instrument, record.gases, fit.change, timing=False)
        gains = [fit.instrument.known(gas).gain_sd for gas in ("so2", "co2")]
        parts["calibration"] = math.hypot(
            parts.get("calibration", 0.0), *(gain * fit.slope for gain in gains)
        )
        for gas, deviation in _by_responses_not_stated(record, fit.instrument).items():
            parts[gas] = max(parts.get(gas, 0.0), deviation)
        problems = (
            *_shown_delay_problem(record, instrument, fit),
            *residual_problem(fit.residuals, energy),
        )
    return Ratio(
        ratio=fit.slope,
        noise=fit.noise,
        misfit=fit.residuals.misfit if fit.residuals else math.nan,
        common={**parts, "response": fit.response},
        instrument=fit.instrument,
        problems=problems,
    )


def _by_responses_not_stated(record: Record, instrument: SnifferSpec) -> dict[str, float]:
    """Return standard uncertainties of the ratio by responses of SO2 that are not stated [ppb/ppm].

    They follow from the ratio of the other gas to CO2. Where such a response takes most of SO2
    away, the fit finds t90 and delay in what is left, where NO2 has another effect.
    """
    so2 = instrument.known("so2")
    gases = [gas for gas in so2.cross_sd if gas in record.gases and not so2.cross.get(gas)]
    if not gases:
        return {}
    signals = make_signals(record, instrument)
    co2 = without(signals.basis, signals.known * signals.co2)
    found = {}
    for gas in gases:
        other = without(signals.basis, signals.known * signals.readings(gas))
        found[gas] = so2.cross_sd[gas] * abs(float(other @ co2)) / float(co2 @ co2)
    return found


def _shown_delay_problem(record: Record, instrument: SnifferSpec, fit: Fit) -> tuple[str, ...]:
    """Return the problem of SO2 and CO2 whose times do not match, as with the clocks of two
    loggers.

    The delay is sought over its whole range: far from the true one, small steps show no error.
    """
    so2, residuals = instrument.known("so2"), fit.residuals
    if math.isinf(so2.delay_sd_s) or residuals is None or noise_explains(residuals):
        return ()
    free = searched_timing(record, instrument.with_channel(replace(so2, delay_sd_s=math.inf)))
    stated = so2_delay(instrument)
    if abs(so2_delay(free) - stated) <= _DELAY_NEAR:
        return ()
    found = fit_record(record, free)
    # With a clean fuel, the uncorrected effect of NO and NO2 is left. It may follow the CO2 of
    # another pass a little better than the CO2 of the same pass.
    if found.residuals is None:
        return ()
    remaining, whole = found.residuals.misfit - 1.0, residuals.misfit - 1.0
    if not remaining < (1.0 - _EXPLAINED_LEAST) * whole:
        return ()
    deviation = math.hypot(so2.delay_sd_s, found.delay_sd_s)
    shown = so2_delay(found.instrument)
    return delay_problem(instrument.name_of("so2"), stated, shown, deviation)


def _by_areas(record: Record, instrument: SnifferSpec, passes: Sequence[Pass]) -> Ratio:
    """Return the ratio of areas, with a common error where passes overlap in the slow channel."""
    found = area_ratio(record, instrument, passes)

    def changes(moved: SnifferSpec) -> tuple[float, Array]:
        return area_ratio(record, moved, passes).ratio - found.ratio, np.zeros(1)

    common, _ = common_errors(instrument, record.gases, changes)
    problems: tuple[str, ...] = ()
    if found.share < _OVERLAP_LEAST:
        problems = (found.truncation_reason(instrument.known("so2").t90_s),)
    overlap = found.separate - found.ratio
    return Ratio(
        ratio=found.ratio,
        noise=found.noise,
        misfit=1.0,
        common={**common, "overlap": abs(overlap)},
        instrument=instrument,
        overlap=overlap,
        problems=problems,
    )


def _estimate_from(
    measured: Measured, method: Method, carbon: float, limits: Sequence[float]
) -> FscEstimate:
    """Return the estimate of the fuel from a ratio of SO2 to CO2."""
    record, passes, fit, ratio = measured.record, measured.passes, measured.fit, measured.ratio
    factor, instrument = fsc_factor(carbon), ratio.instrument
    so2 = instrument.known("so2")
    figure = measured.figure(SPECIES["so2"], factor)
    fsc, total, assumed = figure.value, figure.total, figure.assumed
    problems = [*measured.problems, *measured.pending_problem(fsc, total)]
    signals = make_signals(record, instrument)
    table, so2_snr = signals_table(signals, ratio.ratio)
    figures = figures_of(measured, so2_snr)
    quality, reasons = quality_class(
        problems=problems,
        snr=figures.co2_snr,
        passes=len(passes),
        fsc=fsc,
        deviation=total,
        agreement=fit.agreement,
        limit=min(limits),
        responses_stated=all(so2.cross.get(gas) for gas in so2.cross_sd),
    )
    low, high = interval(fsc, total)
    return FscEstimate(
        method=method,
        fsc_percent=fsc,
        noise_percent=figure.noise,
        common_percent=figure.common,
        overlap_percent=factor * ratio.overlap,
        assumed_percent=assumed,
        total_percent=total,
        low_percent=low,
        high_percent=high,
        sulphate_percent=-SULPHATE_SHARE * max(fsc, 0.0),
        slope_ppb_per_ppm=ratio.ratio,
        misfit=ratio.misfit,
        quality=quality,
        quality_reasons=reasons,
        verdicts=tuple(judged(limit, fsc, total, admitted=quality != "C") for limit in limits),
        figures=figures,
        passes=passes,
        excluded=tuple(_excluded(item, factor, assumed) for item in fit.excluded),
        pass_percent=tuple(factor * slope + assumed for slope, _ in fit.groups),
        pass_deviation_percent=tuple(factor * sd for _, sd in fit.groups),
        agreement=fit.agreement,
        so2_t90_s=so2.t90_s,
        so2_t90_sd_s=fit.t90_sd_s,
        delay_s=so2_delay(instrument),
        delay_sd_s=fit.delay_sd_s,
        instrument=instrument,
        signals=table,
    )


def _excluded(found: ExcludedPass, factor: float, assumed: float) -> PassContent:
    """Return the sulphur content by a pass of another fuel."""
    return PassContent(
        time_s=found.time_s,
        fsc_percent=factor * found.slope + assumed,
        noise_percent=factor * found.deviation,
    )


def figures_of(measured: Measured, gas_snr: float) -> Figures:
    """Return the figures of a record: its length, its passes, and signal to noise.

    ``gas_snr`` is that of the gas in the place of SO2.
    """
    record, passes, fit = measured.record, measured.passes, measured.fit
    noise = measured.ratio.instrument.known("co2").noise
    above = sum(int(np.sum(excess > SNR_LEAST * noise)) for excess in co2_excesses(record, noise))
    times = np.array([found.centre_s for found in passes])
    return Figures(
        duration_s=record.duration,
        passes=len(passes),
        interval_s=float(np.median(np.diff(times))) if len(times) > 1 else math.nan,
        seconds_in_plume=above * record.step if passes else 0.0,
        dose_ppm_s=float(np.mean([found.dose_ppm_s for found in passes])) if passes else math.nan,
        co2_snr=float(np.median([found.snr for found in passes])) if passes else 0.0,
        so2_snr=gas_snr,
        background_ppm=fit.background_ppm,
        background_ppb=fit.background_ppb,
        background_s=fit.background_s,
        passes_excluded=len(fit.excluded),
    )


def over_time(
    readings: Readings,
    instrument: SnifferSpec,
    *,
    elapsed_s: Sequence[float] = ELAPSED_S,
    method: Method = "regression",
    carbon: float = CARBON_FRACTION,
    limits_percent: Sequence[float] = LIMITS_PERCENT,
    problems: Sequence[str] = (),
) -> pd.DataFrame:
    """Return the estimate after each elapsed time within the record, a row per time.

    Columns: ``elapsed_s``, ``fsc_percent``, ``noise_percent``, ``total_percent``, ``low_percent``,
    ``high_percent``, ``quality``, ``passes``, and for each limit ``verdict_0.1`` and
    ``probability_above_0.1``. Times before the first estimate have quality C and NaN.

    Raises
    ------
    MeasurementError : a parameter is out of range, or the whole record cannot be of a flight, as in
        ``estimate``
    """
    check_parameters(method, carbon, limits_percent)
    checked_record(readings, instrument)
    start, end = float(readings.time[0]), float(readings.time[-1])
    rows = []
    for elapsed in elapsed_s:
        if elapsed > end - start + 1e-6:
            continue
        until = int(np.searchsorted(readings.time, start + elapsed + 1e-6))
        part = Readings(readings.time[:until], readings.values[:until])
        try:
            found = estimate(
                part,
                instrument,
                method=method,
                carbon=carbon,
                limits_percent=limits_percent,
                problems=problems,
            )
        except MeasurementError:
            found = None
        rows.append(_row(elapsed, found, limits_percent))
    return pd.DataFrame(rows, columns=list(_row(0.0, None, limits_percent)))


def _row(
    elapsed: float, found: FscEstimate | None, limits: Sequence[float]
) -> dict[str, float | str]:
    """Return a row of the table over time; ``found`` is None before the first estimate."""
    row: dict[str, float | str] = {"elapsed_s": elapsed}
    for name in ("fsc_percent", "noise_percent", "total_percent", "low_percent", "high_percent"):
        row[name] = math.nan if found is None else getattr(found, name)
    row["quality"] = "C" if found is None else found.quality
    row["passes"] = 0 if found is None else found.figures.passes
    for i, limit in enumerate(limits):
        verdict = None if found is None else found.verdicts[i]
        row[f"verdict_{limit:g}"] = OPEN if verdict is None else verdict.verdict
        row[f"probability_above_{limit:g}"] = (
            math.nan if verdict is None else verdict.probability_above
        )
    return row


def time_to_verdict(table: pd.DataFrame, limit_percent: float) -> float:
    """Return the elapsed time after which the verdict on a limit [% m/m] stays [s]; NaN if it is
    open.
    """
    verdicts = table[f"verdict_{limit_percent:g}"].tolist()
    if not verdicts or verdicts[-1] == OPEN:
        return math.nan
    first = len(verdicts)
    while first > 0 and verdicts[first - 1] == verdicts[-1]:
        first -= 1
    return float(table["elapsed_s"].iloc[first])
