"""Sensors that stick: they read the same for longer than their noise and resolution allow."""

import math

import numpy as np

from measurement.estimate.record import shown_scatter, shown_step
from measurement.gases import GASES, UNITS
from measurement.sniffer.channel import Channel
from measurement.sniffer.lag import Array
from measurement.sniffer.sniffer import Readings

_CHANCE_MOST = 1e-6
"""Probability of as many equal readings in a row, by noise alone and anywhere in the record, below
which a sensor sticks.
"""

_SHARE_MOST = 0.1
"""Share of a record in which a sensor may stick, for no longer than its t90 at a time: as much may
be missing.
"""

_FEWEST = 10
"""Readings in a row that are compared: fewer are no sign of a sensor that sticks."""

_RISE_SIGMA = 10.0
"""Another gas that rises by so many standard deviations of its noise has met the plume: white noise
reaches 7 of them.
"""

_SMOOTHED = 0.1
"""Least share of its stated noise that a sensor shows in clean air: data sheets state 2 sigma, and
instruments smooth.
"""

_ROUNDING = 1e-6
"""Of a step: readings that are a step apart may differ by a little more in floating-point numbers.
"""


def sticking(readings: Readings, channel: Channel) -> tuple[str, ...]:
    """Return the problem of a gas whose sensor sticks, if it does.

    A living sensor shows its noise in clean air, too, unless that is below its resolution. Unless
    another gas rises in the meantime, a tenth of the noise that is stated has to be too much, and
    readings of 0 do not tell: a sensor may cut off there what is lower. A gas that reads the same
    throughout is left to ``quiet``.

    Parameters
    ----------
    readings : as they were logged, with those of the gas
    channel : of the gas, as the analyst knows it
    """
    column = readings.values[:, GASES.index(channel.gas)]
    known = np.flatnonzero(np.isfinite(column))
    time, values = readings.time[known], column[known]
    # While it lives it may hardly ever move by a single step.
    step = shown_step(np.sort(values))
    runs = (
        [run for run in _equal(values, step) if _stuck(run, values, step, channel)] if step else []
    )
    runs = [run for run in runs if not _explained(run, time, values, step, readings, channel)]
    lengths = [float(time[run[-1]] - time[run[0]]) for run in runs]
    if not runs or (
        max(lengths) <= channel.t90_s and sum(lengths) <= _SHARE_MOST * float(time[-1] - time[0])
    ):
        return ()
    longest, unit = runs[int(np.argmax(lengths))], UNITS[channel.gas]
    within = f" within {step:.3g} {unit}" if np.ptp(values[longest]) > 0.0 else ""
    times = f", and {len(runs) - 1} more time{'s' * (len(runs) > 2)}" if runs[1:] else ""
    noise = "noise" if math.isnan(channel.noise) else f"noise of {channel.noise:g} {unit}"
    return (
        f"{channel.gas.upper()} reads the same{within} for {max(lengths):.0f} s from {time[longest[0]] - readings.time[0]:.0f} s"
        f" on{times}, which its {noise} does not allow: its sensor, or its logger, was stuck",
    )


def _equal(values: Array, step: float) -> list[range]:
    """Return the rows of readings that are a step apart at most, as many in a row as are compared,
    shape (n,).
    """
    step *= 1.0 + _ROUNDING
    near = np.concatenate([[False], np.abs(np.diff(values)) <= step, [False]])
    edges = np.flatnonzero(np.diff(near.astype(int)))
    runs = []
    for start, end in zip(edges[::2], edges[1::2], strict=True):
        if end - start + 1 < _FEWEST:
            continue
        first, least, most = int(start), values[start], values[start]
        for row in range(int(start) + 1, int(end) + 1):
            least, most = min(least, values[row]), max(most, values[row])
            if most - least > step:
                runs.append(range(first, row))
                first, least, most = row, values[row], values[row]
        runs.append(range(first, int(end) + 1))
    return [run for run in runs if len(run) >= _FEWEST]


def _stuck(run: range, values: Array, step: float, channel: Channel) -> bool:
    """Return whether noise alone would hardly leave so many readings within a step."""
    noise = channel.noise
    if math.isnan(noise):
        # What sticks shows no noise; the rest of the record does.
        rest = [part for part in (values[: run.start], values[run.stop :]) if len(part)]
        noise = shown_scatter(rest, step)
    return _too_many(run, values, step, noise)


def _too_many(run: range, values: Array, step: float, noise: float) -> bool:
    if not noise > 0.0:
        return False
    # Of normal noise most is within a step if that is centred on its mean.
    within = math.erf(step / noise / math.sqrt(2.0))
    own = len(run) / _repeats(values)
    return own >= _FEWEST and len(values) * within ** (own - 1.0) < _CHANCE_MOST


def _repeats(values: Array) -> float:
    """Return how often the log has a reading before the next one: more than once, where the logger
    is faster than the sensor.
    """
    changes = np.flatnonzero(np.diff(values))
    return float(np.median(np.diff(changes))) if len(changes) > 1 else 1.0


def _explained(
    run: range, time: Array, values: Array, step: float, readings: Readings, channel: Channel
) -> bool:
    """Return whether a living sensor may read as this: at the end of its range, or in clean air."""
    if values[run[0]] >= channel.range_high - channel.resolution:
        return True
    if values[run[0]] != 0.0 and _too_many(run, values, step, _SMOOTHED * channel.noise):
        return False
    # A gas that arrives ends the clean air; faster sensors than this one show it before.
    during = (readings.time >= time[run[0]]) & (
        readings.time <= time[run[-1]] - channel.t90_s - channel.delay_s
    )
    others = [i for i, gas in enumerate(GASES) if gas != channel.gas]
    return not any(_rises(readings.values[:, i], during) for i in others)


def _rises(column: Array, during: Array) -> bool:
    """Return whether a gas rises by more than its noise in a part of its readings, shape (m,) each."""
    part = column[during & np.isfinite(column)]
    if not len(part):
        return False
    noise = shown_scatter([column[np.isfinite(column)]], shown_step(column))
    return float(np.max(part - np.minimum.accumulate(part))) > _RISE_SIGMA * noise
