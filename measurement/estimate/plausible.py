"""Finds readings that no working sensor has: cut off, stuck, spikes, too little noise, mixed-up
gases.
"""

import math

import numpy as np

from measurement.estimate.quality import STRANGE_SIGMA
from measurement.estimate.record import Record, shown_scatter, shown_step, stated_noise
from measurement.gases import GASES
from measurement.sniffer.channel import Channel
from measurement.sniffer.lag import Array
from measurement.sniffer.sniffer import Readings
from measurement.sniffer.spec import SnifferSpec
from measurement.species import SLOT

_CUT_LEAST, _CUT_OVER, _CUT_STEPS = 8, 3.0, 5
"""Criterion of readings that are cut off: least number at an end, its ratio to the number in the
next steps, and the number of these steps.
"""

_FASTER, _FASTEST = 0.5, 0.1
"""Largest and least share of its t90 within which a sensor may fall, depending on the uncertainty
of t90.
"""

_FALL_SIGMAS = 10.0
"""Tolerance of a reading below the fastest fall [standard deviations of the noise]."""

_CHANCE_MOST = 1e-6
"""Least probability that noise alone has as many equal readings in a row in the record."""

_STUCK_SHARE_MOST = 0.1
"""Share of a record in which a sensor may be stuck, for no longer than its t90 at a time."""

_FEWEST = 10
"""Least number of equal readings in a row that show a stuck sensor."""

_RISE_SIGMA = 10.0
"""Rise of another gas that shows the plume [standard deviations of its noise, which reaches 7]."""

_SMOOTHED = 0.1
"""Least share of its stated noise that a sensor shows in clean air: instruments smooth their
readings.
"""

_STEP_ROUNDING = 1e-6
"""Tolerance of the difference of readings that are a step apart, for floating-point rounding
[steps].
"""

_NOISE_USUAL = 1.0
"""Noise of a channel of SO2, NO or NO2 without a stated noise [ppb]: presets have 0.3 to 7.5
ppb.
"""

_QUIET_SHARE = 0.01
"""Least scatter of readings, relative to their noise.

For readings in ppm it is a thousandth. With ``_NOISE_USUAL`` it is 10 ppt: only laser-induced
fluorescence has less noise in a second (2 ppt in 10 s: Rollins et al., AMT 9:4601).
"""

_OZONE_MOST = 50.0
"""Most NO2 that ozone makes of the NO of a plume [ppb]: sea air has 20 to 50 of ozone."""

_LOW, _HIGH, _NOISE_RANGE = 0.05, 0.95, 3.29
"""Quantiles whose difference is the range of a gas, and the range that noise alone has [sigma]."""


def implausibilities(record: Record, readings: Readings, instrument: SnifferSpec) -> list[str]:
    """Return the problems of the readings of CO2, SO2, and the gases to which SO2 responds."""
    so2, co2 = instrument.known("so2"), instrument.known("co2")
    problems = []
    for gas in record.gases:
        problems += _cut_off(readings, instrument, gas)
    problems += _stuck(readings, instrument, "co2")
    problems += _spikes(record, readings, co2)
    responds_to = (
        gas for gas in record.gases if so2.cross.get(gas, 0.0) or so2.cross_sd.get(gas, 0.0)
    )
    for gas in ("so2", *responds_to):
        problems += _stuck(readings, instrument, gas) or _quiet(
            record.scatter[gas], instrument, gas
        )
    return problems or _exchanged(record, instrument)


def _cut_off(readings: Readings, instrument: SnifferSpec, gas: str) -> list[str]:
    """Return the problem of readings that are cut off at the largest or the least value.

    Saturation at the end of the stated range is a problem of the record, and not repeated here.
    """
    channel, column = instrument.known(gas), readings.values[:, GASES.index(gas)]
    known, step = column[np.isfinite(column)], shown_step(column)
    if not step:
        return []
    most, least = float(known.max()), float(known.min())
    noise = stated_noise(channel, [known[known > least]], step)
    name, unit = instrument.name_of(gas), instrument.unit_of(gas)
    saturated = most >= channel.range_high - 0.5 * channel.resolution
    times = 0 if saturated else _heap((most - known) / step)
    if times:
        return [
            f"{name} reads {most:g} {unit}, and never more, {times} times, and hardly ever just"
            " less: it is cut off"
        ]
    # Clean air without visible noise always has the same, least reading.
    times = _heap((known - least) / step) if noise >= step else 0
    if times:
        return [
            f"{name} reads {least:g} {unit}, and never less, {times} times, and hardly ever just"
            " more: it is cut off; log what its noise takes below"
        ]
    return []


def _heap(steps: Array) -> int:
    """Return the number of readings at an end, given their steps from it, if they accumulate
    there.
    """
    heap, *near = (int(np.sum(np.round(steps) == number)) for number in range(_CUT_STEPS + 1))
    return heap if heap >= _CUT_LEAST and heap > _CUT_OVER * max(near) else 0


def _spikes(record: Record, readings: Readings, channel: Channel) -> list[str]:
    """Return the problem of CO2 that falls faster than its sensor can, as after a spike.

    One spike is enough to draw the slope to 0, and where SO2 is noisy no other check shows that.
    """
    column = readings.values[:, GASES.index("co2")]
    known = np.flatnonzero(np.isfinite(column))
    time, values, lowest = readings.time[known], column[known], float(np.min(column[known]))
    noise = np.fmax(channel.noise, record.scatter["co2"])
    share = max(_FASTEST, min(_FASTER, 1.0 - STRANGE_SIGMA * channel.t90_sd))
    fastest = channel.constants[0] * share
    left = np.exp(-np.diff(time) / fastest)
    least = lowest + (values[:-1] - lowest) * left - _FALL_SIGMAS * noise
    falls = np.flatnonzero(values[1:] < least)
    if not falls.size:
        return []
    i = int(falls[0])
    more = f", and {falls.size - 1} more such falls" if falls.size > 1 else ""
    when = f"in {time[i + 1] - time[i]:.2g} s at {time[i] - readings.time[0]:.0f} s{more}"
    return [
        f"CO2 falls from {values[i]:.1f} to {values[i + 1]:.1f} ppm {when}, faster than a t90 of"
        f" {channel.t90_s:g} s allows: leave spikes empty, or correct t90_s"
    ]


def _quiet(scatter: float, instrument: SnifferSpec, gas: str) -> list[str]:
    """Return the problem of a gas whose readings scatter less than its sensor can."""
    channel, unit = instrument.known(gas), instrument.unit_of(gas)
    stated = not math.isnan(channel.noise)
    noise = channel.noise if stated else _NOISE_USUAL
    if scatter >= _QUIET_SHARE * noise or channel.resolution > noise:
        return []
    found = "reads the same throughout"
    if scatter > 0.0:
        found = f"scatters by {scatter:.2g} {unit} from reading to reading"
    expected = f"its noise is {noise:g} {unit}"
    if not stated:
        expected = f"the noise of such sensors is about {noise:g} {unit}"
    key = instrument.compared.name if gas == SLOT else gas
    return [
        f"{instrument.name_of(gas)} {found}, and {expected}: it is in another unit (of ppm, give a"
        f" [scale] of {key} = 1000.0), or its sensor is dead"
    ]


def _exchanged(record: Record, instrument: SnifferSpec) -> list[str]:
    """Return the problem of NO2 that exceeds NO by more than ozone makes of it."""
    if not {"no", "no2"} <= set(record.gases):
        return []
    gains = {gas: instrument.known(gas).gain for gas in ("no", "no2")}
    no, no2 = (
        float(np.ptp(np.quantile(record.of(gas), (_LOW, _HIGH)))) / gain
        for gas, gain in gains.items()
    )
    # The squares of noise and plume add up.
    noise = _NOISE_RANGE * record.scatter["no2"] / gains["no2"]
    if no2**2 - noise**2 <= (no + _OZONE_MOST) ** 2:
        return []
    return [
        f"NO2 varies by {no2:.0f} ppb in the plume and NO by {no:.0f} ppb: exhaust has more NO than"
        f" NO2, and ozone makes at most {_OZONE_MOST:g} ppb of it; check which columns are"
        f" {instrument.name_of('so2')}, NO and NO2, and their units"
    ]


# Stuck sensors: they read the same for longer than their noise and resolution allow


def _stuck(readings: Readings, instrument: SnifferSpec, gas: str) -> list[str]:
    """Return the problem of a gas whose sensor is stuck for a part of the record.

    The stated noise is used in full only where another gas rises meanwhile. Otherwise even a tenth
    of it has to be too much, and readings of 0 do not count, as a sensor may cut off lower ones.
    ``_quiet`` checks a gas whose reading never changes.
    """
    channel, column = instrument.known(gas), readings.values[:, GASES.index(gas)]
    known = np.flatnonzero(np.isfinite(column))
    time, values = readings.time[known], column[known]
    # A sensor that works for a part of the record may rarely move by a single step.
    step = shown_step(np.sort(values))
    if not step:
        return []
    runs = [
        run
        for run in _equal_runs(values, step)
        if _too_long(run, values, step, stated_noise(channel, _around(run, values), step))
        and not _explained(run, time, values, step, readings, channel)
    ]
    lengths = [float(time[run[-1]] - time[run[0]]) for run in runs]
    most = _STUCK_SHARE_MOST * float(time[-1] - time[0])
    if not runs or (max(lengths) <= channel.t90_s and sum(lengths) <= most):
        return []
    longest, unit = runs[int(np.argmax(lengths))], instrument.unit_of(gas)
    within = f" within {step:.3g} {unit}" if np.ptp(values[longest]) > 0.0 else ""
    times = f", and {len(runs) - 1} more time{'s' * (len(runs) > 2)}" if runs[1:] else ""
    noise = "noise" if math.isnan(channel.noise) else f"noise of {channel.noise:g} {unit}"
    return [
        f"{instrument.name_of(gas)} reads the same{within} for {max(lengths):.0f} s from"
        f" {time[longest[0]] - readings.time[0]:.0f} s on{times}, which its {noise} does not allow:"
        " its sensor, or its logger, was stuck"
    ]


def _equal_runs(values: Array, step: float) -> list[range]:
    """Return the rows of ``_FEWEST`` or more consecutive readings within one step, shape (n,)."""
    step *= 1.0 + _STEP_ROUNDING
    near = np.concatenate([[False], np.abs(np.diff(values)) <= step, [False]])
    edges = np.flatnonzero(np.diff(near.astype(int)))
    runs = []
    for start, end in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        if end - start + 1 < _FEWEST:
            continue
        first = start
        least = most = values[start]
        for row in range(start + 1, end + 1):
            least, most = min(least, values[row]), max(most, values[row])
            if most - least > step:
                runs.append(range(first, row))
                first = row
                least = most = values[row]
        runs.append(range(first, end + 1))
    return [run for run in runs if len(run) >= _FEWEST]


def _around(run: range, values: Array) -> list[Array]:
    return [part for part in (values[: run.start], values[run.stop :]) if len(part)]


def _too_long(run: range, values: Array, step: float, noise: float) -> bool:
    """Return whether noise would very rarely leave as many readings within a step."""
    if not noise > 0.0:
        return False
    # Normal noise lies most often within a step that is centred on its mean.
    within = math.erf(step / noise / math.sqrt(2.0))
    # A logger that is faster than the sensor repeats each reading in several rows.
    changes = np.flatnonzero(np.diff(values))
    rows = float(np.median(np.diff(changes))) if len(changes) > 1 else 1.0
    readings = len(run) / rows
    return readings >= _FEWEST and len(values) * within ** (readings - 1.0) < _CHANCE_MOST


def _explained(
    run: range, time: Array, values: Array, step: float, readings: Readings, channel: Channel
) -> bool:
    """Return whether a working sensor may have these readings: at the end of its range, or in clean
    air.
    """
    if values[run[0]] >= channel.range_high - channel.resolution:
        return True
    if values[run[0]] != 0.0 and _too_long(run, values, step, _SMOOTHED * channel.noise):
        return False
    # An arriving gas ends the clean air; sensors that are faster than this one show it earlier.
    until = time[run[-1]] - channel.t90_s - channel.delay_s
    during = (readings.time >= time[run[0]]) & (readings.time <= until)
    others = [i for i, gas in enumerate(GASES) if gas != channel.gas]
    return not any(_rises(readings.values[:, i], during) for i in others)


def _rises(column: Array, during: Array) -> bool:
    """Return whether a gas rises by more than its noise in a part of its readings, shape (m,)."""
    part = column[during & np.isfinite(column)]
    if not len(part):
        return False
    noise = shown_scatter([column[np.isfinite(column)]], shown_step(column))
    return float(np.max(part - np.minimum.accumulate(part))) > _RISE_SIGMA * noise
