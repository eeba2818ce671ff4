r"""Slope of SO2 over CO2 in a varying background, by a restricted likelihood.

**Residual.** Channels are brought to one response and one delay (``signals``) and averaged over
blocks. With the true slope b, the difference

    r = so2 - b co2                                                                      (1)

contains nothing of the ship's plume, for any shape of the plume. The rest is Gaussian, with the
covariance

    V = s N + e^2 I + a^2 K(l) + D b b' D' + c^2 Z Z'                                    (2)

* N : white noise of each channel through the filter that equalises it, and the walk of its zero, as
  stated; s is 1 within some 30 %;
* e : some hundredths of the plume, as no channel is exactly a lag;
* K : an Ornstein-Uhlenbeck background, exp(-|dt|/l) in the air, read with the common response;
* D : a column for each t90 and delay of SO2 and of CO2: the change of co2 by one standard deviation
  of that property, in the plume alone. This marginalises the property. For SO2, b is the slope of
  its readings, including its response to NO and NO2;
* Z : a column for each pass, its CO2: slopes of passes may differ by a random effect c.

Constant, trend, the transients of the filters and passes of another fuel are fixed columns X. With

    P = V^-1 - V^-1 X (X' V^-1 X)^-1 X' V^-1                                             (3)

s, a, l and c have the least of

    -2 log L = log|V| + log|X' V^-1 X| + r' P r,   X with z                              (4)

which is the restricted likelihood (Patterson and Thompson, Biometrika 58:545): with the instrument
z of (5) as one of the fixed columns, an error of b does not count as background.

**Slope.** Only the passes show the plume, each over the straight line between the troughs beside
it,

    z = E Q c,   c the readings, Q the line taken away, E the equalising filter          (5)

and D is made of it. With d the properties less those of the linearisation [units], SO2 is

    so2 = b p - H d + noise,   H = D b in the true plume p                               (6)

where the noise has the V of (2) without D, and d has a normal distribution about the stated
properties, d = -place. Both p and H are only known with the errors of c, its noise and background.
These errors reduce b. With D in P no correction by a trace removes this: a longer t90 makes short
passes in a slow cell lower, almost as a smaller b does. So z beside D is small, but the errors of z
and of D, which are the same, are not. The result for a fuel of 2.7 % was 26 % too high.

So d is estimated together with b, and the errors are removed from all products. With other errors w
of the same covariance, c + w and c - w are independent. Instruments are made of c + w, columns of c
- w:

    Z = (z, -H) of c + w,   X = (co2 - E w, -H of c - w),   M = mean of Z' P X over w    (7)

has the products of the true values as its mean, E[M] = E[Z]' P (p, -H), with P of (3) without D.
Then

    (M + G) (b, d) = mean of Z' P so2 - G (0, place),   G = diag(0, 1/prior^2)           (8)
    var b = v' Z' P Z v + sum of (v_k / prior_k)^2,   v the first row of (M + G)^-1      (9)

(instrumental variables: Fuller, Measurement Error Models, 1987, sections 1.4 and 2.4; splitting by
added errors: Oliveira, Lei and Tibshirani, arXiv:2111.09447; Leiner et al., arXiv:2112.11079). M
holds for any instruments that are made of c + w alone:

* The windows of the passes are found in c + w. In c, a weak pass would count where noise raises it,
  and windows would end where noise lowers it: the mean of such selected errors is not 0.
* All passes get their mean shape, each with its size. So only one number of each pass contains
  noise and background, and their covariance C need not be known well.

The part of M whose mean is H' P H has no negative eigenvalue; an eigenvalue that errors make
negative is set to 0. The background of CO2 in C is the smaller one of those that residuals and
troughs show.

Where a t90 or delay of SO2 is not stated, G is 0, and M alone leads away from the true t90 of a
cell in which passes overlap. Then (8) has only b. The delay stays in P, as in (2), and is estimated
from r. The t90 is that with the least (4), where so2 stays equalised as it is and co2 gets the
shape that a cell of another t90 would have given it; P takes it as exact, and its deviation adds to
(9).
"""

import itertools
import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import numpy.typing as npt
from scipy.linalg import lapack

from measurement.estimate.budget import SAMPLING_SD
from measurement.estimate.passes import SNR_LEAST
from measurement.estimate.record import Record
from measurement.estimate.signals import (
    Signals,
    equalised,
    equalised_from_rest,
    make_signals,
    shifted,
    transients,
)
from measurement.sniffer.lag import Array
from measurement.sniffer.spec import SnifferSpec

Rows = npt.NDArray[np.intp]

_BLOCKS_MOST, _BLOCK_LEAST = 400, 1.0
"""Largest number of blocks of a record, and shortest block [s]: the cost grows with the cube of the
number.
"""

_FREE_LEAST = 3
"""Least number of blocks in excess of the fixed columns [-]."""

_INDEPENDENT = 1e-5
"""Least singular value of a column, relative to the largest."""

_INEXACT = 0.03
"""Least noise of a block, relative to the SO2 of the plume: no channel is exactly a lag, and no
record is exact. Variation between readings adds ``SAMPLING_SD`` for each time constant of CO2."""


# Blocks and passes


@dataclass(frozen=True, kw_only=True)
class _Blocks:
    """Means over blocks of samples.

    Attributes
    ----------
    rows : samples of each block, shape (n, m)
    time, segment : middle of each block [s], and its segment, shape (n,)
    step : length of a block [s]
    """

    rows: Rows
    time: Array
    segment: Rows
    step: float

    def mean(self, values: Array) -> Array:
        """Return the means of samples, shape (n, ...)."""
        return np.asarray(values[self.rows].mean(axis=1))

    def by_segment(self, change: Callable[[Array], Array], values: Array) -> Array:
        """Return blocks of values after a change of each segment, in the shape of ``values``."""
        cuts = np.flatnonzero(np.diff(self.segment)) + 1
        return np.concatenate([change(part) for part in np.split(values, cuts)])


def _make_blocks(record: Record) -> _Blocks:
    """Return the blocks of a record; samples at a segment's end that do not fill a block are left
    out.
    """
    length = max(_BLOCK_LEAST, record.duration / _BLOCKS_MOST)
    size = max(1, round(length / record.step))
    rows, segments, start = [], [], 0
    for number, times in enumerate(record.times):
        count = len(times) // size
        rows.append(start + np.arange(count * size).reshape(count, size))
        segments.append(np.full(count, number))
        start += len(times)
    joined = np.concatenate(rows)
    return _Blocks(
        rows=joined,
        time=record.time[joined].mean(axis=1),
        segment=np.concatenate(segments),
        step=size * record.step,
    )


@dataclass(frozen=True, kw_only=True)
class Window:
    """Blocks of a pass: its peak, and both ends, which show the level beside it."""

    first: int
    peak: int
    last: int

    @property
    def inside(self) -> Rows:
        """Blocks between both ends."""
        return np.arange(self.first + 1, self.last)


_BESIDE = 6.0
"""Least time from the beginning of a window to its peak [s]; the window ends by the same time, and
three time constants of CO2, after the peak."""

_WIDTHS = 2.0
"""The same time for long passes, in widths at half of their height [-]."""

_NEAR = 20.0
"""Time on either side within which a peak must stand out [s]: broad haze does not."""


def _find_windows(blocks: _Blocks, co2: Array, instrument: SnifferSpec) -> list[Window]:
    """Return the windows of the passes: from trough to trough at most, by the CO2 of blocks [ppm].

    Blocks have less noise than readings, so that passes count that are too weak for
    ``find_passes``.
    """
    noise = _noise_of_blocks(blocks, instrument)
    memory = sum(instrument.known("co2").constants)
    windows: list[Window] = []
    for number in np.unique(blocks.segment):
        index = np.flatnonzero(blocks.segment == number)
        values = co2[index]
        # Padded, so that a peak at either end counts.
        padded = np.pad(values, 1, constant_values=float(values.min()))
        least = max(SNR_LEAST * noise, 1e-6 * float(np.abs(values).max()))
        peaks, widths = _peaks(padded, least, 2 * int(_NEAR / blocks.step) + 1)
        peaks, widths = peaks - 1, widths * blocks.step
        troughs = [a + int(np.argmin(values[a : b + 1])) for a, b in itertools.pairwise(peaks)]
        lows, highs = [0, *troughs], [*troughs, len(values) - 1]
        for peak, width, low, high in zip(peaks, widths, lows, highs, strict=False):
            beside = max(_BESIDE, _WIDTHS * float(width))
            before = max(2, round(beside / blocks.step))
            after = max(3, round((beside + 3.0 * memory) / blocks.step))
            first, last = max(low, peak - before), min(high, peak + after)
            if last - first > 1:
                start = int(index[0])
                windows.append(Window(first=start + first, peak=start + peak, last=start + last))
    return windows


def _noise_of_blocks(blocks: _Blocks, instrument: SnifferSpec) -> float:
    """Return the standard deviation of the noise of a block of CO2 [ppm]."""
    channel = instrument.known("co2")
    return channel.noise / channel.gain / math.sqrt(blocks.rows.shape[1])


def _peaks(values: Array, least: float, reach: int) -> tuple[Rows, Array]:
    """Return peaks that stand out by ``least`` within ``reach`` samples, and their widths."""
    from scipy.signal import find_peaks, peak_widths

    reach = max(5, reach)
    with warnings.catch_warnings():
        # A plateau that is longer than the reach does not stand out: SciPy warns of that.
        warnings.simplefilter("ignore")
        peaks, _ = find_peaks(values, prominence=least, wlen=reach)
        widths = peak_widths(values, peaks, rel_height=0.5, wlen=reach)[0]
    return peaks, widths


def line_operator(count: int, windows: Sequence[Window]) -> Array:
    """Return Q of (5): CO2 over the line between both ends of each window, 0 elsewhere."""
    operator = np.zeros((count, count))
    for window in windows:
        inside = window.inside
        share = (inside - window.first) / (window.last - window.first)
        operator[inside, inside] = 1.0
        operator[inside, window.first] -= 1.0 - share
        operator[inside, window.last] -= share
    return operator


def in_one_shape(over: Array, windows: Sequence[Window]) -> Array:
    """Return passes in the mean shape of all, each with the size that fits it, shape (n,).

    Only one number of each pass then contains noise and background, instead of all its blocks.

    Parameters
    ----------
    over : CO2 over the lines of the windows, of all blocks, shape (n,)
    """
    before = max((window.peak - window.first for window in windows), default=0)
    after = max((window.last - window.peak for window in windows), default=0)
    total = np.zeros(before + after + 1)
    places = [before + window.inside - window.peak for window in windows]
    for window, place in zip(windows, places, strict=True):
        total[place] += over[window.inside]
    shaped = np.zeros_like(over)
    for window, place in zip(windows, places, strict=True):
        shape = total[place]
        energy = float(shape @ shape)
        if energy > 0.0:
            shaped[window.inside] = shape * float(shape @ over[window.inside]) / energy
    return shaped


# Covariances


def _filtered_kernel(lags: Array, length: float, pole: float) -> Array:
    """Return the autocovariance of exp(-|t|/length) after a lag of one pole, at lags [s]."""
    a, c = 1.0 / length, 1.0 / pole
    if abs(a - c) < 1e-3 * c:
        a *= 1.0 + 2e-3
    return np.asarray(c**2 / (c**2 - a**2) * (np.exp(-a * lags) - a / c * np.exp(-c * lags)))


@dataclass(frozen=True, kw_only=True)
class Property:
    """T90 or delay of SO2 or CO2, which is known with a standard deviation or unknown.

    Attributes
    ----------
    gas, name : "t90_s" or "delay_s"
    unit : step of the property: of log(t90), or of the delay [s]
    prior : stated standard deviation [units]
    """

    gas: str
    name: str
    unit: float
    prior: float

    @property
    def stated(self) -> bool:
        """Whether it is stated: its unit then is its deviation."""
        return self.prior == 1.0

    def moved(self, instrument: SnifferSpec, units: float) -> SnifferSpec:
        """Return an instrument with this property moved by ``units``."""
        channel = instrument.known(self.gas)
        if self.name == "t90_s":
            value = channel.t90_s * math.exp(units * self.unit)
            return instrument.with_channel(replace(channel, t90_s=value))
        return with_delay(instrument, self.gas, channel.delay_s + units * self.unit)


_UNITS = {"t90_s": 0.05, "delay_s": 0.1}
"""Units of properties that are not stated: of log(t90), and of the delay [s]."""

_NOT_STATED = {"t90_s": 32.0, "delay_s": 100.0}
"""Standard deviation of such a property [units]: of a log(t90) and a delay that may lie anywhere in
the ranges of the search."""


def with_delay(instrument: SnifferSpec, gas: str, delay_s: float) -> SnifferSpec:
    """Return an instrument with another delay of a gas; if it is below 0, all other gases get later
    instead.
    """
    late = max(0.0, -delay_s)
    channels = tuple(
        replace(
            channel, delay_s=max(0.0, delay_s) if channel.gas == gas else channel.delay_s + late
        )
        for channel in instrument.channels
    )
    return replace(instrument, channels=channels)


def uncertain_properties(instrument: SnifferSpec) -> list[Property]:
    """Return those of t90 and delay of SO2 and CO2 that are not known exactly."""
    found = []
    for gas in ("so2", "co2"):
        channel = instrument.known(gas)
        for name, deviation in (("t90_s", channel.t90_sd), ("delay_s", channel.delay_sd_s)):
            if math.isinf(deviation):
                found.append(
                    Property(gas=gas, name=name, unit=_UNITS[name], prior=_NOT_STATED[name])
                )
            elif deviation > 0.0:
                found.append(Property(gas=gas, name=name, unit=deviation, prior=1.0))
    return found


@dataclass(frozen=True, kw_only=True)
class BlockedRecord:
    """A record in blocks, linearised about an instrument.

    Attributes
    ----------
    signals : signals by that instrument
    blocks, known : all blocks, and which of them have all readings
    so2, co2 : of the known blocks, at the common response, shape (n,) [ppb], [ppm]
    read, windows : CO2 of all blocks at the delay of SO2 [ppm], and its passes
    passes : equalised CO2 of each pass over its line, shape (n, number of passes) [ppm]
    noises : for each gas, its share in so2 and in co2, and the covariance of its noise
    fixed : constant, trend and transients, orthonormal, shape (n, k)
    columns : change of r by a unit of each property, for readings of slope 1, shape (n, p)
    cross : slope of the response of SO2's readings to other gases [ppb/ppm]
    """

    signals: Signals
    blocks: _Blocks
    known: Rows
    so2: Array
    co2: Array
    read: Array
    windows: list[Window]
    passes: Array
    noises: list[tuple[float, float, Array]]
    fixed: Array
    columns: Array
    cross: float

    def noise(self, slope: float) -> Array:
        """Return N of (2)."""
        total = np.zeros((len(self.known),) * 2)
        for in_so2, in_co2, covariance in self.noises:
            share = in_so2 - slope * in_co2
            if share:
                total += share**2 * covariance
        return total

    def slopes(self, properties: Sequence[Property], slope: float) -> Array:
        """Return the slope of the readings that each property changes, shape (p,) [ppb/ppm]."""
        return np.array([slope + self.cross * (item.gas == "so2") for item in properties])

    def background(self, length: float) -> Array:
        """Return K of (2)."""
        time = self.blocks.time[self.known]
        lags = np.abs(time[:, np.newaxis] - time)
        return _filtered_kernel(lags, length, self.signals.common[0])

    def if_so2_had(self, t90_s: float) -> "BlockedRecord":
        """Return so2 without what corrects it for other gases, and co2 and passes in the shape that
        a cell of another t90 would have given them in so2.
        """
        so2 = self.signals.instrument.known("so2")
        own, other = so2.constants, replace(so2, t90_s=t90_s).constants
        step = self.blocks.step

        def shaped(values: Array) -> Array:
            return self.blocks.by_segment(lambda part: equalised(part, step, own, other), values)[
                self.known
            ]

        passes = np.zeros((len(self.blocks.time), self.passes.shape[1]))
        passes[self.known] = self.passes
        return replace(
            self,
            so2=self.so2 + self.cross * self.co2,
            cross=0.0,
            co2=shaped(self.blocks.mean(self.signals.co2)),
            passes=shaped(passes),
        )

    def equalised(self, values: Array) -> Array:
        """Return E of (5) applied to CO2 of all blocks, at the known ones, shape (n, ...)."""
        return self._equalised(values)[self.known]

    def _equalised(self, values: Array) -> Array:
        own = self.signals.instrument.known("co2").constants
        return self.blocks.by_segment(
            lambda part: equalised_from_rest(part, self.blocks.step, own, self.signals.common),
            values,
        )

    def regressors(self, over: Array, properties: Sequence[Property], slope: float) -> Array:
        """Return z of (5) and the columns -H of (7), shape (n, ..., 1 + p) [ppm], [ppb].

        Parameters
        ----------
        over : CO2 of passes over their lines, of all blocks, shape (m, ...) [ppm]
        """
        z = self._equalised(over)
        step, by_segment = self.blocks.step, self.blocks.by_segment
        columns = _distortions(self.signals, z, properties, step, by_segment)
        columns *= -self.slopes(properties, slope)
        return np.concatenate([z[..., np.newaxis], columns], axis=-1)[self.known]

    @property
    def reading_noise(self) -> float:
        """Standard deviation of the noise of a block of CO2 [ppm]."""
        return _noise_of_blocks(self.blocks, self.signals.instrument)

    def windows_of(self, read: Array) -> list[Window]:
        """Return the windows of the passes in other CO2 of all blocks [ppm]."""
        return _find_windows(self.blocks, read, self.signals.instrument)

    def means(self, instrument: SnifferSpec) -> tuple[Array, Array]:
        """Return SO2 and CO2 of the known blocks by another instrument, shape (n,) each."""
        other = make_signals(self.signals.record, instrument)
        return self.blocks.mean(other.so2)[self.known], self.blocks.mean(other.co2)[self.known]


def block_record(
    record: Record,
    instrument: SnifferSpec,
    properties: Sequence[Property],
    windows: list[Window] | None = None,
) -> BlockedRecord | None:
    """Return a record in blocks, with the given windows of its passes; None if it is too short."""
    signals, blocks = make_signals(record, instrument), _make_blocks(record)
    known = np.flatnonzero(signals.known[blocks.rows].min(axis=1) > 0.0)
    if len(known) < _FREE_LEAST:
        return None
    fixed = _fixed_columns(blocks.time[known], blocks.segment[known], signals.common)
    if len(known) < fixed.shape[1] + _FREE_LEAST:
        return None
    co2 = instrument.known("co2")
    native = np.concatenate(
        [
            shifted(values["co2"], record.step, signals.delay_to_so2("co2")) / co2.gain
            for values in record.values
        ]
    )
    read = blocks.mean(native)
    if windows is None:
        windows = _find_windows(blocks, read, instrument)
    over = _passes_over_lines(record, blocks, windows, native, read)
    each = _by_segments(record, over, lambda part: _from_rest(signals, part))
    so2, passes = blocks.mean(signals.so2)[known], blocks.mean(each)[known]
    others = signals.shares["so2"][0] * blocks.mean(signals.readings("so2"))[known] - so2
    z = _beside(fixed, passes.sum(axis=1))
    energy = float(z @ z)
    return BlockedRecord(
        signals=signals,
        blocks=blocks,
        known=known,
        so2=so2,
        co2=blocks.mean(signals.co2)[known],
        read=read,
        windows=windows,
        passes=passes,
        noises=_noises(signals, blocks, known),
        fixed=fixed,
        columns=blocks.mean(
            _distortions(
                signals,
                each.sum(axis=1),
                properties,
                record.step,
                lambda change, values: _by_segments(record, values, change),
            )
        )[known],
        cross=float(z @ others) / energy if energy > 0.0 else 0.0,
    )


def _beside(fixed: Array, values: Array) -> Array:
    """Return the part of values that fixed columns do not explain, in the same shape."""
    return np.asarray(values - fixed @ (fixed.T @ values))


def _fixed_columns(time: Array, segment: Rows, common: tuple[float, ...]) -> Array:
    """Return constant, trend and the transients of each segment, orthonormal, shape (n, k)."""
    columns = [np.ones(len(time)), (time - time.mean()) / max(1.0, float(np.ptp(time)))]
    for number in np.unique(segment):
        rows = np.flatnonzero(segment == number)
        for transient in transients(time[rows], common):
            column = np.zeros(len(time))
            column[rows] = transient
            columns.append(column)
    return orthonormal(np.stack(columns, axis=1))


def orthonormal(columns: Array) -> Array:
    """Return an orthonormal basis of columns, shape (n, k)."""
    unit = columns / np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    basis, sizes, _ = np.linalg.svd(unit, full_matrices=False)
    return np.asarray(basis[:, sizes > _INDEPENDENT * sizes[0]])


def _noises(signals: Signals, blocks: _Blocks, known: Rows) -> list[tuple[float, float, Array]]:
    """Return shares in so2 and co2, and covariance over the known blocks, of each gas's noise."""
    time, segment = blocks.time[known], blocks.segment[known]
    apart = np.abs(known[:, np.newaxis] - known)
    same = segment[:, np.newaxis] == segment
    since = time - time[0]
    walk = np.minimum(since[:, np.newaxis], since)
    size = blocks.rows.shape[1]
    found = []
    for gas, (in_so2, in_co2) in signals.shares.items():
        response = np.convolve(signals.impulse(gas), np.full(size, 1.0 / size))
        covariance = np.correlate(response, response, mode="full")[len(response) - 1 :: size]
        by_lag = np.zeros(len(blocks.time))
        by_lag[: len(covariance)] = covariance[: len(by_lag)]
        channel = signals.instrument.known(gas)
        white = np.where(same, by_lag[apart], 0.0)
        found.append((in_so2, in_co2, channel.noise**2 * white + channel.random_walk**2 * walk))
    return found


def _passes_over_lines(
    record: Record, blocks: _Blocks, windows: Sequence[Window], native: Array, read: Array
) -> Array:
    """Return CO2 of each pass over its line by sample, shape (samples, number of passes) [ppm].

    Parameters
    ----------
    native, read : CO2 of samples and of blocks [ppm]
    """
    over = np.zeros((len(native), len(windows)))
    for i, window in enumerate(windows):
        ends = [window.first, window.last]
        rows = blocks.rows[window.inside].ravel()
        over[rows, i] = native[rows] - np.interp(record.time[rows], blocks.time[ends], read[ends])
    return over


def _by_segments(record: Record, values: Array, change: Callable[[Array], Array]) -> Array:
    """Return samples after a change of each segment, in the shape of ``values``."""
    cuts = np.cumsum([len(times) for times in record.times])[:-1]
    return np.concatenate([change(part) for part in np.split(values, cuts)])


def _from_rest(signals: Signals, values: Array) -> Array:
    """Return E of (5) applied to samples of CO2 in a segment."""
    own = signals.instrument.known("co2").constants
    return equalised_from_rest(values, signals.record.step, own, signals.common)


def _distortions(
    signals: Signals,
    plume: Array,
    properties: Sequence[Property],
    step: float,
    by_segment: Callable[[Callable[[Array], Array], Array], Array],
) -> Array:
    """Return the columns D of (2) for slope 1: change of r by a unit of each property.

    They are made of the passes over their lines. Readings are not suitable: the derivative of their
    background is correlated with the background of r.

    Parameters
    ----------
    plume : equalised CO2 of the passes, ``step`` [s] apart, shape (m, ...) [ppm]
    by_segment : applies a change to each segment of such values

    Returns
    -------
    shape (m, ..., p) [ppm]
    """

    def change(part: Array, item: Property) -> Array:
        sign = 1.0 if item.gas == "so2" else -1.0
        if item.name == "delay_s":
            # A later SO2 has CO2 shifted later, a later CO2 has it shifted less.
            return part - shifted(part, step, sign * item.unit)
        # A channel whose assumed response is too slow is sharpened too much.
        constants = signals.instrument.known(item.gas).constants
        slower = tuple(math.exp(item.unit) * constant for constant in constants)
        return sign * (equalised_from_rest(part, step, slower, constants) - part)

    columns = np.zeros((*plume.shape, len(properties)))
    for i, item in enumerate(properties):
        columns[..., i] = by_segment(partial(change, item=item), plume)
    return columns


# Restricted likelihood

LENGTH_LEAST, LENGTH_MOST = 8.0, 600.0
"""Range of the correlation length of the background [s]."""

_LENGTH_USUAL, _LENGTH_SPREAD = 60.0, 1.5
"""Median of the expected lengths [s], and standard deviation of their logarithm."""

_NOISE_SPREAD, _NOISE_FREEDOM = 0.3, 3.0
"""Spread of log(s), the noise's variance over the stated one, and degrees of freedom of its
Student-t distribution, whose tails allow for an instrument that differs from its statement."""


@dataclass(frozen=True, kw_only=True)
class Variances:
    """Parameters of (2).

    Attributes
    ----------
    noise : s, variance of the noise over the stated one [-]
    background, length : a of r [ppb], and l [s]
    between : c, standard deviation of the slopes of passes [ppb/ppm]
    """

    noise: float
    background: float
    length: float
    between: float = 0.0


ALIKE = 0.05
"""Standard deviation of slopes of passes of one fuel, relative to the slope [-]: other gases have
another response, and no response is exactly a lag.

It is the scale of the half-Cauchy prior of c. With that prior, the noise of a few passes does not
count as differences between them (Gelman, Bayesian Analysis 1:515)."""

_COARSE_MOST = 200
"""Largest number of blocks in the fit of variances: backgrounds are slower than such blocks."""


class Likelihood:
    """Equations (2) to (4) for one slope.

    Parameters
    ----------
    coarse : whether neighbouring blocks are averaged, to no more than ``_COARSE_MOST``
    """

    def __init__(
        self,
        data: BlockedRecord,
        slope: float,
        properties: Sequence[Property],
        *,
        coarse: bool = False,
    ) -> None:
        count = len(data.known)
        self._size = math.ceil(count / _COARSE_MOST) if coarse else 1
        noise = data.noise(slope)
        plume = float(np.std(data.passes.sum(axis=1) * slope)) if data.windows else 0.0
        record, co2 = data.signals.record, data.signals.instrument.known("co2")
        least = max(_INEXACT, SAMPLING_SD * record.step / co2.constants[0])
        inexact = max(least * plume, 1e-9)
        self._usual_between = max(ALIKE * abs(slope), 1e-6)
        self._noise = self.averaged(self.averaged(noise).T)
        priors = np.array([item.prior for item in properties])
        columns = self.averaged(data.columns * data.slopes(properties, slope) * priors)
        self._stated = columns @ columns.T
        self._stated[np.diag_indices_from(self._stated)] += inexact**2 / self._size
        time = self.averaged(data.blocks.time[data.known])
        self._lags = np.abs(time[:, np.newaxis] - time)
        self._pole = data.signals.common[0]

    def averaged(self, values: Array) -> Array:
        """Return means of neighbouring blocks, shape (n, ...) to (m, ...)."""
        if self._size == 1:
            return values
        count = len(values) // self._size
        parts = values[: count * self._size].reshape(count, self._size, *values.shape[1:])
        return np.asarray(parts.mean(axis=1))

    def inverse(
        self, found: Variances, fixed: Array, varying: Array | None = None
    ) -> tuple[Array, float, Array]:
        """Return P of (3), both determinants of (4), and K; ``varying`` are the columns Z.

        Columns have one row for each block after averaging.
        """
        kernel = self._background(found.length)
        total = found.noise * self._noise + found.background**2 * kernel + self._stated
        if varying is not None and found.between > 0.0:
            total += found.between**2 * varying @ varying.T
        factor, failed = lapack.dpotrf(total, lower=1, overwrite_a=1)
        if failed:
            raise np.linalg.LinAlgError
        logdet = 2.0 * float(np.sum(np.log(np.diagonal(factor))))
        lower, _ = lapack.dpotri(factor, lower=1, overwrite_c=1)
        inverse = np.tril(lower)
        inverse += np.tril(lower, -1).T
        weighted = inverse @ fixed
        inner = fixed.T @ weighted
        logdet += float(np.linalg.slogdet(inner)[1])
        inverse -= weighted @ np.linalg.solve(inner, weighted.T)  # (3)
        return inverse, logdet, kernel

    def _background(self, length: float) -> Array:
        return _filtered_kernel(self._lags, length, self._pole)

    def fitted(
        self, residual: Array, fixed: Array, start: Variances, varying: Array | None = None
    ) -> Variances:
        """Return the variances that maximise the restricted likelihood (4).

        Parameters
        ----------
        residual : r, shape (n,)
        fixed : X with z, shape (n, k)
        start : variances to start from; without ``varying``, all passes have one slope
        varying : columns Z, whose variance is fitted too, shape (n, m)
        """
        from scipy.optimize import minimize

        residual, fixed = self.averaged(residual), orthonormal(self.averaged(fixed))
        known = [start.noise, start.background, start.length]
        bounds = [(-3.0, 6.0), (-12.0, 12.0), (math.log(LENGTH_LEAST), math.log(LENGTH_MOST))]
        if varying is not None:
            varying = self.averaged(varying)
            known.append(start.between)
            bounds.append((-12.0, 12.0))
            outer = varying @ varying.T
        else:
            outer = np.zeros((0, 0))

        def cost(logs: Array) -> tuple[float, Array]:
            at = Variances(**_named(logs))
            try:
                weights, logdet, kernel = self.inverse(at, fixed, varying)
            except np.linalg.LinAlgError:
                return 1e12, np.zeros(len(logs))
            weighted = weights @ residual
            by_length = self._background(at.length * 1.01) - self._background(at.length / 1.01)
            # Derivatives of V by the logarithms of its parameters.
            derivatives = [
                (at.noise, self._noise),
                (2.0 * at.background**2, kernel),
                (at.background**2 / (2.0 * math.log(1.01)), by_length),
            ]
            if varying is not None:
                derivatives.append((2.0 * at.between**2, outer))
            gradient = np.array(
                [
                    factor * (np.vdot(weights, change) - weighted @ change @ weighted)
                    for factor, change in derivatives
                ]
            )
            value = float(residual @ weighted) + logdet
            penalty, slopes = _prior(logs, self._usual_between)
            return value + penalty, gradient + slopes

        best = minimize(
            cost,
            np.log(known),
            jac=True,
            method="L-BFGS-B",
            bounds=bounds,
            options={"maxiter": 30, "ftol": 1e-6, "gtol": 5e-2},
        )
        return Variances(**_named(best.x))


def _named(logs: Array) -> dict[str, float]:
    names = ("noise", "background", "length", "between")
    return {name: math.exp(value) for name, value in zip(names, logs, strict=False)}


def _prior(logs: Array, between: float) -> tuple[float, Array]:
    """Return -2 log of the prior densities of the variances, and its derivative by their logs.

    Parameters
    ----------
    between : scale of the half-Cauchy distribution of c [ppb/ppm]
    """
    slopes = np.zeros(len(logs))
    scale = _NOISE_FREEDOM * _NOISE_SPREAD**2
    value = (_NOISE_FREEDOM + 1.0) * math.log1p(logs[0] ** 2 / scale)
    slopes[0] = (_NOISE_FREEDOM + 1.0) * 2.0 * logs[0] / (scale + logs[0] ** 2)
    # Some backgrounds have no effect: this keeps their size from growing without end.
    value += 0.01 * logs[1] ** 2
    slopes[1] = 0.02 * logs[1]
    away = (logs[2] - math.log(_LENGTH_USUAL)) / _LENGTH_SPREAD
    value += away**2
    slopes[2] = 2.0 * away / _LENGTH_SPREAD
    if len(logs) > 3:
        ratio = math.exp(2.0 * logs[3]) / between**2
        value += 2.0 * math.log1p(ratio)
        slopes[3] = 4.0 * ratio / (1.0 + ratio)
    return value, slopes


# Slope


@dataclass(frozen=True, kw_only=True)
class Slope:
    """Solution of (8); the slope is NaN where the plume does not stand out of noise and background.

    Attributes
    ----------
    slope, noise : slope, and its standard deviation by V [ppb/ppm]
    by_property : its standard deviation by each property that is stated, shape (p,) [ppb/ppm]
    properties, covariance : properties less those of the linearisation, and their covariance
        [units]
    weights : the slope is the sum of SO2 with these weights, apart from the effect of stated
        properties, shape (n,) [1/ppm]
    kept : slope to which noise and background of CO2 would reduce a slope of 1 [-]
    """

    slope: float
    noise: float
    by_property: Array
    properties: Array
    covariance: Array
    weights: Array
    kept: float

    @property
    def deviation(self) -> float:
        """Standard deviation of the slope [ppb/ppm]."""
        return math.sqrt(self.noise**2 + float(np.sum(self.by_property**2)))


SLOPE_LEAST = 0.1
"""Slope below which residuals contain no information on CO2, and slope at which the fit begins
[ppb/ppm].
"""


def background_of_co2(data: BlockedRecord, found: Variances, slope: float) -> float:
    """Return the standard deviation of the background of CO2 [ppm].

    It is the smaller of the values that residuals and troughs between passes show: the residuals
    contain the background of SO2, too, and a trough may contain the tail of a pass.
    """
    by_residuals = found.background / max(abs(slope), SLOPE_LEAST)
    outside = np.ones(len(data.read), dtype=bool)
    for window in data.windows:
        outside[window.inside] = False
    rows = np.flatnonzero(outside)
    apart = np.diff(data.blocks.time[rows])
    across = apart > 1.5 * data.blocks.step
    if not across.any():
        return by_residuals
    changes = np.diff(data.read[rows])[across] ** 2 - 2.0 * found.noise * data.reading_noise**2
    expected = 2.0 * (1.0 - np.exp(-apart[across] / found.length))
    by_troughs = math.sqrt(max(0.0, float(np.sum(changes)) / float(np.sum(expected))))
    return min(by_residuals, by_troughs)


def read_errors(data: BlockedRecord, found: Variances, size: float) -> Array:
    """Return the covariance of noise and background of CO2 as read, of all blocks [ppm^2].

    Parameters
    ----------
    size : standard deviation of the background of CO2 [ppm]
    """
    lags = np.abs(data.blocks.time[:, np.newaxis] - data.blocks.time)
    pole = data.signals.instrument.known("co2").constants[0]
    covariance = size**2 * _filtered_kernel(lags, found.length, pole)
    covariance[np.diag_indices_from(covariance)] += found.noise * data.reading_noise**2
    return covariance


_DRAWS, _SEED = 8, 60
"""Pairs of draws w and -w in (7), and the seed of their random numbers: the same for all records,
so that an estimate is repeated to the last bit."""

_ROUNDING = 1e-10
"""Variance that makes a covariance positive definite, relative to the largest variance [-]."""


def drawn_errors(errors: Array) -> Array:
    """Return draws w of (7), one in each column and each with its negative, shape (n, k) [ppm].

    Parameters
    ----------
    errors : covariance of the errors of CO2 as read, of all blocks [ppm^2]
    """
    white = np.random.default_rng(_SEED).standard_normal((len(errors), _DRAWS))
    # Errors that are exactly 0 are not drawn.
    least = max(_ROUNDING * float(np.max(np.diagonal(errors))), 1e-300)
    drawn = np.linalg.cholesky(errors + least * np.eye(len(errors))) @ white
    return np.hstack([drawn, -drawn])


def error_energy(data: BlockedRecord, inverse: Array, operator: Array, errors: Array) -> float:
    """Return the part of z' P co2 that errors of CO2 make, for given windows [-].

    Parameters
    ----------
    inverse : P of (3), shape (n, n)
    operator : removes the lines, of all blocks
    errors : covariance of the errors of CO2 as read, of all blocks [ppm^2]
    """
    covariance = data.equalised(data.equalised(operator @ errors).T).T
    return float(np.vdot(inverse, covariance))


@dataclass(frozen=True, kw_only=True)
class Copies:
    """Z and X of (7) for each draw w, shape (n, draws, 1 + p).

    Attributes
    ----------
    instruments, columns : Z of c + w and X of c - w: z or co2 [ppm], and -H [ppb]
    noisy : X of c
    """

    instruments: Array
    columns: Array
    noisy: Array


def solve_slope(
    inverse: Array, copies: Copies, so2: Array, precision: Array, place: Array
) -> Slope:
    """Return the slope by (8) and (9).

    Parameters
    ----------
    inverse : P of (3), shape (n, n)
    so2 : by the instrument of the linearisation, shape (n,) [ppb]
    precision : of the stated value of each property [1/unit^2]
    place : of the linearisation [units]
    """
    count, _, size = copies.instruments.shape
    weighted = (inverse @ copies.instruments.reshape(count, -1)).reshape(copies.instruments.shape)
    stated = np.diag(np.concatenate([[0.0], precision]))
    left, noisy = (
        _products(weighted, columns) + stated for columns in (copies.columns, copies.noisy)
    )
    if left[0, 0] > 0.0:
        z, weights = copies.instruments.mean(axis=1), weighted.mean(axis=1)
        solved = np.linalg.inv(left)
        of_slope = solved[0]
        found = solved @ (weights.T @ so2 - stated @ np.concatenate([[0.0], place]))  # (8)
        variance = float(of_slope @ (z.T @ weights) @ of_slope)
        kept = float(np.linalg.solve(noisy, left[:, 0])[0])
        if of_slope[0] > 0.0 and variance > 0.0 and kept > 0.0:
            return Slope(
                slope=float(found[0]),
                noise=math.sqrt(variance),  # (9)
                by_property=of_slope[1:] * np.sqrt(precision),
                properties=found[1:],
                covariance=0.5 * (solved + solved.T)[1:, 1:],
                weights=weights @ of_slope,
                kept=kept,
            )
    return Slope(
        slope=math.nan,
        noise=math.nan,
        by_property=np.zeros(size - 1),
        properties=np.zeros(size - 1),
        covariance=np.diag(1.0 / precision),
        weights=np.zeros(count),
        kept=0.0,
    )


def _products(weighted: Array, columns: Array) -> Array:
    """Return M of (7), given P Z."""
    matrix: Array = np.tensordot(weighted, columns, axes=([0, 1], [0, 1])) / weighted.shape[1]
    matrix[1:, 1:] = _without_negative(matrix[1:, 1:])
    return matrix


def _without_negative(matrix: Array) -> Array:
    """Return the nearest symmetric matrix that has no negative eigenvalue."""
    values, vectors = np.linalg.eigh(0.5 * (matrix + matrix.T))
    return np.asarray((vectors * np.maximum(values, 0.0)) @ vectors.T)
