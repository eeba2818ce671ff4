"""The fuel sulphur content of a record, how sure it is, and what follows."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from measurement.errors import MeasurementError
from measurement.estimate.areas import area_ratio
from measurement.estimate.budget import (
    CARBON_SD,
    SAMPLING_SD,
    SULPHATE_SHARE,
    common_errors,
    unmeasured,
)
from measurement.estimate.fit.alignment import DELAY_MOST, Alignment, align, stated, widened
from measurement.estimate.fit.groups import grouped
from measurement.estimate.fit.regression import fitted, regress
from measurement.estimate.fit.signals import Ends, Signals, make_signals, samples_of, used_gases
from measurement.estimate.passes import (
    SNR_LEAST,
    Pass,
    co2_excesses,
    find_passes,
    read_coarsely,
    readings_noise,
)
from measurement.estimate.plausible import unlikely
from measurement.estimate.quality import judged_quality, late, noise_alone, not_arrived, stranger
from measurement.estimate.record import Record, checked_record
from measurement.estimate.result import Figures, FscEstimate, Method
from measurement.estimate.verdict import LIMITS_PERCENT, interval, judged
from measurement.gases import CARBON_FRACTION, fsc_factor
from measurement.sniffer.lag import Array
from measurement.sniffer.sniffer import Readings
from measurement.sniffer.spec import SnifferSpec

CARBON_LEAST, CARBON_MOST = 0.5, 0.95
"""Of a fuel [-]; methanol has 0.375, which these factors are not made for."""

OVERLAP_LEAST = 0.95
"""Least share of the truth that areas must read, by how their passes overlap in the slow channel:
2.0 t90 between passes.
"""

EXPLAINED_LEAST = 0.5
"""Share of a misfit that another delay has to explain for it to be the true one."""


@dataclass(frozen=True, kw_only=True)
class _Ratio:
    """A ratio of SO2 to CO2 by either method, with what the methods do not share."""

    ratio: float
    noise: float
    misfit: float
    common: dict[str, float]
    alignment: Alignment
    overlap: float = 0.0
    problems: tuple[str, ...] = ()


def estimate(
    readings: Readings,
    instrument: SnifferSpec,
    *,
    method: Method = "regression",
    carbon: float = CARBON_FRACTION,
    limits_percent: Sequence[float] = LIMITS_PERCENT,
) -> FscEstimate:
    """Return the fuel sulphur content that the readings show.

    Parameters
    ----------
    readings : of a flight through the plume of one ship
    instrument : as the analyst knows it
    method : "regression" (equalise and regress), or "areas" over each pass
    carbon : mass share of the fuel [-]
    limits_percent : on which there are to be verdicts [% m/m]

    Raises
    ------
    MeasurementError : the readings cannot be those of a flight through a plume: no CO2, times,
        units or shapes; or a parameter is out of range. What makes a record weak rather than wrong
        is a quality of C with its reason, and no verdict.
    """
    check_parameters(method, carbon, limits_percent)
    record = checked_record(readings, instrument)
    strange = unlikely(record, readings, instrument)
    noise = readings_noise(record, instrument)
    instrument = replace(
        instrument,
        channels=tuple(
            replace(channel, noise=noise.get(channel.gas, channel.noise))
            for channel in instrument.channels
        ),
    )
    passes = find_passes(record, instrument.known("co2"))
    problems = [*record.problems, *strange, *_too_little(record, instrument, passes, noise["co2"])]
    if not passes:
        ratio = _nothing(instrument)
    else:
        ratio = (
            _regressed(record, instrument)
            if method == "regression"
            else _areas(record, instrument, passes)
        )
    return _told(
        record, passes, ratio, method, carbon, tuple(limits_percent), [*problems, *ratio.problems]
    )


def check_parameters(method: str, carbon: float, limits_percent: Sequence[float]) -> None:
    """Refuse parameters of ``estimate`` that are out of range.

    Raises
    ------
    MeasurementError : one is
    """
    if method not in ("regression", "areas"):
        raise MeasurementError(f"method is {method!r}; it must be 'regression' or 'areas'")
    if not CARBON_LEAST <= carbon <= CARBON_MOST:
        raise MeasurementError(
            f"carbon is {carbon:g}; a fuel's mass share of carbon must be {CARBON_LEAST:g} to {CARBON_MOST:g}"
        )
    if not limits_percent or not all(0.0 < limit <= 10.0 for limit in limits_percent):
        raise MeasurementError(
            f"limits_percent is {list(limits_percent)}; give one or more numbers above 0, up to 10 % m/m"
        )


def _too_little(
    record: Record, instrument: SnifferSpec, passes: Sequence[Pass], noise: float
) -> list[str]:
    """Return why the record is too short or too coarse, or has no plume in it."""
    if not passes:
        if noise == 0.0:
            return ["no pass through a plume: CO2 reads the same throughout; check its sensor"]
        least = f"{SNR_LEAST * noise:.1f} ppm, {SNR_LEAST:g} times its noise"
        return [f"no pass through a plume: CO2 is nowhere {least}, over its background"]
    if coarse := read_coarsely(passes, record):
        return coarse
    width = max(found.end_s - found.start_s for found in passes)
    response = (
        instrument.known("so2").t90_s if math.isfinite(instrument.known("so2").t90_sd) else 0.0
    )
    if record.duration < width + response:
        return [
            f"the record lasts {record.duration:.0f} s; a pass and the response of SO2 take {width + response:.0f} s"
        ]
    return []


def _nothing(instrument: SnifferSpec) -> _Ratio:
    """Return the ratio of a record without a pass."""
    alignment = Alignment(
        instrument=instrument, slope_deviation=math.nan, t90_sd_s=math.nan, delay_sd_s=math.nan
    )
    return _Ratio(ratio=math.nan, noise=math.nan, misfit=math.nan, common={}, alignment=alignment)


def _regressed(record: Record, instrument: SnifferSpec) -> _Ratio:
    alignment = align(record, instrument)
    found = regress(make_signals(record, alignment.instrument))

    def aligned(moved: SnifferSpec, ends: Ends = (0, 0)) -> Signals:
        return make_signals(
            record, align(record, moved, start=alignment.instrument).instrument, ends
        )

    as_known, others = aligned(alignment.instrument), list[SnifferSpec]()

    def changes(moved: SnifferSpec) -> tuple[float, Array]:
        # Both of the samples that both know.
        other = aligned(moved, as_known.ends)
        others.append(other.instrument)
        same = (
            as_known
            if other.ends == as_known.ends
            else make_signals(record, as_known.instrument, other.ends)
        )
        (slope, residual), (before, left) = fitted(other), fitted(same)
        if not math.isfinite(slope - before):
            # It may be anything.
            return found.slope, np.zeros(1)
        return slope - before, residual - left

    errors = common_errors(alignment.instrument, used_gases(record), changes)
    common = {
        **errors.parts,
        "response": math.hypot(errors.parts.get("response", 0.0), alignment.slope_deviation),
    }
    strange = stranger(found.misfit, found.residual_energy, errors.residual_energy, as_known.count)
    problems = (*_out_of_time(record, instrument, found.misfit, as_known.count), *strange)
    alignment = widened(alignment, as_known.instrument, others)
    return _Ratio(
        ratio=found.slope,
        noise=found.noise,
        misfit=found.misfit,
        common=common,
        alignment=alignment,
        problems=problems,
    )


def _out_of_time(
    record: Record, instrument: SnifferSpec, misfit: float, samples: int
) -> tuple[str, ...]:
    """Return the problem of SO2 and CO2 that do not fit in time, as where two loggers have two
    clocks.

    Far from the true delay the slope is near 0 and changes little: an error that small steps of the
    delay do not show. So the delay is sought over its whole range, as if it were not stated; where
    noise alone explains the residuals it is not needed.
    """
    so2 = instrument.known("so2")
    if math.isinf(so2.delay_sd_s) or not misfit > 0.0 or noise_alone(misfit, samples):
        return ()
    free = align(record, instrument.with_channel(replace(so2, delay_sd_s=math.inf)))
    # A clean fuel leaves what NO and NO2 were not corrected for, which may follow CO2 of another
    # pass a little better than its own.
    if not regress(make_signals(record, free.instrument)).misfit - 1.0 < (1.0 - EXPLAINED_LEAST) * (
        misfit - 1.0
    ):
        return ()

    def changes(moved: SnifferSpec) -> tuple[float, Array]:
        return _delay(align(record, moved, start=free.instrument).instrument) - delay, np.zeros(1)

    delay = _delay(align(record, free.instrument, start=free.instrument).instrument)
    parts = common_errors(free.instrument, used_gases(record), changes).parts
    deviation = math.hypot(so2.delay_sd_s, free.delay_sd_s, *parts.values())
    return late(_delay(instrument), _delay(free.instrument), deviation)


def _delay(instrument: SnifferSpec) -> float:
    """Return the delay of SO2 after CO2 [s]."""
    return instrument.known("so2").delay_s - instrument.known("co2").delay_s


def _areas(record: Record, instrument: SnifferSpec, passes: Sequence[Pass]) -> _Ratio:
    """Return the ratio of areas; passes that overlap in the slow channel add a common error as
    large as the closed form tells.
    """
    alignment = stated(instrument)
    found = area_ratio(record, instrument, passes)

    def changes(moved: SnifferSpec) -> tuple[float, Array]:
        return area_ratio(record, moved, passes).ratio - found.ratio, np.zeros(1)

    common = common_errors(instrument, used_gases(record), changes).parts
    problems: tuple[str, ...] = ()
    if found.share < OVERLAP_LEAST:
        problems = (found.unread(instrument.known("so2").t90_s),)
    overlap = found.separate - found.ratio
    common["overlap"] = abs(overlap)
    return _Ratio(
        ratio=found.ratio,
        noise=found.noise,
        misfit=1.0,
        common=common,
        alignment=alignment,
        overlap=overlap,
        problems=problems,
    )


def _told(
    record: Record,
    passes: tuple[Pass, ...],
    ratio: _Ratio,
    method: Method,
    carbon: float,
    limits: tuple[float, ...],
    problems: list[str],
) -> FscEstimate:
    """Return the estimate that a ratio means."""
    factor, instrument = fsc_factor(carbon), ratio.alignment.instrument
    absent = unmeasured(instrument, used_gases(record), carbon)
    assumed = -sum(shift for shift, _ in absent.values())
    fsc = factor * ratio.ratio + assumed
    noise = factor * ratio.noise
    common = {name: factor * value for name, value in ratio.common.items()}
    for gas, (_, deviation) in absent.items():
        common[gas] = math.hypot(common.get(gas, 0.0), deviation)
    common["carbon"] = CARBON_SD * abs(fsc)
    common["sampling"] = SAMPLING_SD * record.step / instrument.known("co2").constants[0] * abs(fsc)
    total = math.sqrt(noise**2 + sum(value**2 for value in common.values()))
    if math.isinf(instrument.known("so2").delay_sd_s):
        read = [_read_after(record, found.end_s) for found in passes]
        problems += not_arrived(fsc, total, read, [found.dose_ppm_s for found in passes])
    signals = make_signals(record, instrument)
    groups = grouped(
        signals,
        passes,
        ratio.ratio,
        misfit=ratio.misfit,
        response=ratio.common.get("response", 0.0),
    )
    samples, so2_snr = samples_of(signals, ratio.ratio)
    snr = float(np.median([found.snr for found in passes])) if passes else 0.0
    quality, reasons = judged_quality(
        problems=problems,
        snr=snr,
        passes=len(passes),
        fsc=fsc,
        deviation=total,
        agreement=groups.agreement,
        limit=min(limits),
        responses_stated=all(
            instrument.known("so2").cross.get(gas) for gas in instrument.known("so2").cross_sd
        ),
    )
    low, high = interval(fsc, total)
    return FscEstimate(
        method=method,
        fsc_percent=fsc,
        noise_percent=noise,
        common_percent=common,
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
        figures=_figures(record, passes, instrument, snr, so2_snr),
        passes=passes,
        pass_percent=tuple(factor * slope + assumed for slope in groups.slopes),
        pass_deviation_percent=tuple(factor * deviation for deviation in groups.deviations),
        agreement=groups.agreement,
        so2_t90_s=instrument.known("so2").t90_s,
        so2_t90_sd_s=ratio.alignment.t90_sd_s,
        delay_s=_delay(instrument),
        delay_sd_s=ratio.alignment.delay_sd_s,
        instrument=instrument,
        signals=samples,
    )


def _read_after(record: Record, end: float) -> float:
    """Return which share was read of the time after the end of a pass [s] in which its SO2 may
    come.
    """
    after = record.time - end
    return min(
        1.0, np.count_nonzero((after > 0.0) & (after <= DELAY_MOST)) * record.step / DELAY_MOST
    )


def _figures(
    record: Record, passes: tuple[Pass, ...], instrument: SnifferSpec, snr: float, so2_snr: float
) -> Figures:
    noise = instrument.known("co2").noise
    above = sum(int(np.sum(excess > SNR_LEAST * noise)) for excess in co2_excesses(record, noise))
    times = np.array([found.centre_s for found in passes])
    return Figures(
        duration_s=record.duration,
        passes=len(passes),
        interval_s=float(np.median(np.diff(times))) if len(times) > 1 else math.nan,
        seconds_in_plume=above * record.step if passes else 0.0,
        dose_ppm_s=float(np.mean([found.dose_ppm_s for found in passes])) if passes else math.nan,
        co2_snr=snr,
        so2_snr=so2_snr,
    )
