"""Fits a record: rounds of ``model``, passes of other fuels, and records that must not be judged.

1. Properties of the instrument are linearised about the stated ones, then about those that the
   record shows, with variances and slope found anew. A t90 of SO2 that is not stated is sought by
   its likelihood.
2. A pass with a very different slope becomes a fixed column: it may be of another ship.
3. Passes that do not stand out of the fitted background are dropped.
4. The slopes of the other passes get a random effect.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt
from scipy.special import chdtrc

from measurement.estimate.model import (
    ALIKE,
    SLOPE_LEAST,
    BlockedRecord,
    Copies,
    Likelihood,
    Property,
    Slope,
    Variances,
    Window,
    background_of_co2,
    block_record,
    drawn_errors,
    error_energy,
    in_one_shape,
    line_operator,
    orthonormal,
    read_errors,
    solve_slope,
    uncertain_properties,
)
from measurement.estimate.record import Record
from measurement.estimate.timing import T90_LEAST, T90_MOST
from measurement.sniffer.lag import Array
from measurement.sniffer.spec import SnifferSpec

FOREIGN_SIGMA = 4.5
"""Least difference of the slope of a pass of another fuel [standard deviations]."""

FOREIGN_MOST = 0.25
"""Largest share of the passes that may be left out."""

_COMPARED_LEAST = 4
"""Least number of passes among which a pass of another fuel can be found."""

TOGETHER = 0.1
"""Standard deviation, from pass to pass, of the time between SO2 and CO2 [s]."""

_PASS_S = 3.0
"""Usual length of a pass [s]: a shift by as much counts as a ratio that is twice as large."""

DISAGREE = 0.01
"""Least probability of such differences between passes for a verdict.

They may differ by ``ALIKE`` and ``TOGETHER``, so that quiet logs are below it in fewer than 1 of
1,000."""

CHANGE = 1e-4
"""Least probability of such a change of slope between two passes for a verdict."""

KEPT_LEAST = 0.8
"""Least share of the instrument's energy that the plume must have for a verdict."""

_CORRECTED_SPREAD = 0.3
"""Relative standard deviation of the correction by (7), as the background differs a little from the
model."""

_STANDS_OUT = 3.0
"""Least height of a pass over its line [standard deviations of the background over such a line]."""

_ROUNDS, _ROUNDS_FREE = 5, 10
"""Largest number of rounds of linearisation with a stated instrument, and with a delay that is not
stated.
"""

_SEARCHES = 6
"""Largest number of searches for a t90 that is not stated, each about the one found before."""

_T90_GRID = np.linspace(-1.0, 1.0, 9)
"""Where a search looks, relative to the logarithm of the t90 that was found before."""

_T90_TOLERANCE, _T90_SETTLED = 0.01, 0.05
"""Precision of its logarithm in a search, and the change at which the last search was enough."""

_SETTLED = 0.2
"""Largest change of a property at which the linearisation has settled [units]."""

_PLACE_MOST = 3.0
"""Largest distance of a property from its stated value [units]."""

_STEP_MOST = {"t90_s": 0.3, "delay_s": 1.0}
"""Largest step of log(t90), and of a delay [s]: columns are not proportional to a larger one."""


@dataclass(frozen=True, kw_only=True)
class ExcludedPass:
    """A pass whose ratio is of another fuel: its time [s], its slope and noise [ppb/ppm]."""

    time_s: float
    slope: float
    deviation: float


@dataclass(frozen=True, kw_only=True)
class _State:
    """The state of the fit.

    Attributes
    ----------
    data, properties : the record, linearised, and its instrument's properties
    place : of the linearisation, by property [units]
    variances, slope : present estimates
    foreign : indices of passes of other fuels
    """

    data: BlockedRecord
    properties: list[Property]
    place: Array
    variances: Variances
    slope: float
    foreign: tuple[int, ...] = ()

    @property
    def signals(self) -> tuple[Array, Array]:
        """The so2 and co2 of the stated instrument, shape (n,) [ppb], [ppm]."""
        changes = self.data.columns * self.place
        of_so2 = np.array([item.gas == "so2" for item in self.properties], dtype=bool)
        so2 = self.data.so2 - self.data.cross * changes[:, of_so2].sum(axis=1)
        return so2, self.data.co2 + changes.sum(axis=1)

    @property
    def residual(self) -> Array:
        """The residual r of the stated instrument, shape (n,) [ppb]."""
        so2, co2 = self.signals
        return so2 - self.slope * co2

    @property
    def own(self) -> list[int]:
        """Indices of the passes of the ship."""
        return [i for i in range(len(self.data.windows)) if i not in self.foreign]

    @property
    def fixed(self) -> Array:
        """Fixed columns, passes of other fuels included.

        Where another plume overlaps the ship's, SO2 has another place in the pass than CO2.
        """
        if not self.foreign:
            return self.data.fixed
        others = self.data.passes[:, list(self.foreign)]
        return orthonormal(np.hstack([self.data.fixed, others, self.later(others)]))

    def later(self, passes: Array) -> Array:
        """Return the change of passes per second of delay, shape (n, k) [ppm/s]."""
        return -np.asarray(np.gradient(passes, self.data.blocks.time[self.data.known], axis=0))

    @property
    def freed(self) -> Array:
        """Fixed columns with z, so that an error of the slope does not count as background."""
        return orthonormal(np.hstack([self.fixed, self.instrument_column[:, np.newaxis]]))

    @property
    def instrument_column(self) -> Array:
        """The instrument z, shape (n,)."""
        return np.asarray(self.data.passes[:, self.own].sum(axis=1))

    @property
    def distortions(self) -> Array:
        """Changes of r by a unit of each property, shape (n, p) [ppb]."""
        return self.data.columns * self.data.slopes(self.properties, self.slope)

    def moved(self, instrument: SnifferSpec) -> SnifferSpec:
        """Return the stated instrument with its properties at ``place``."""
        for item, units in zip(self.properties, self.place, strict=True):
            instrument = item.moved(instrument, float(units))
        return instrument

    def inverse(self, fixed: Array, varying: Array | None = None) -> Array:
        """Return P of (3)."""
        likelihood = Likelihood(self.data, self.slope, self.properties)
        return likelihood.inverse(self.variances, fixed, varying)[0]

    def unweighted_slope(self) -> float:
        """Return the slope by the instrument z without weights; 0 without an instrument.

        It does not depend on the variances, which depend on it only a little.
        """
        z, fixed = self.instrument_column, self.fixed
        z = z - fixed @ (fixed.T @ z)
        so2, co2 = self.signals
        energy = float(z @ co2)
        return float(z @ so2) / energy if energy > 0.0 else 0.0

    def refitted(self, varying: Array | None = None) -> "_State":
        """Return the state with the variances that maximise the likelihood (4)."""
        likelihood = Likelihood(self.data, self.slope, self.properties, coarse=True)
        found = likelihood.fitted(self.residual, self.freed, self.variances, varying)
        return replace(self, variances=found)

    @property
    def read_errors(self) -> Array:
        """Covariance of the errors of CO2 as read, of all blocks [ppm^2]."""
        size = background_of_co2(self.data, self.variances, self.slope)
        return read_errors(self.data, self.variances, size)

    def solved(self, varying: Array | None = None, *, draw_windows: bool = False) -> Slope:
        """Return the slope by (8).

        Parameters
        ----------
        varying : the columns Z of passes whose slopes may differ
        draw_windows : whether windows are found in c + w, or taken as given
        """
        if not self.all_stated:
            bare = self.without_properties()
            copies = bare.copies(draw_windows=draw_windows)
            inverse = self.only(~self.searched).inverse(self.fixed, varying)
            return solve_slope(inverse, copies, self.signals[0], np.zeros(0), bare.place)
        inverse = self.only(self.none).inverse(self.fixed, varying)
        precision = np.array([item.prior**-2.0 for item in self.properties])
        copies = self.copies(draw_windows=draw_windows)
        return solve_slope(inverse, copies, self.data.so2, precision, self.place)

    @property
    def stated(self) -> npt.NDArray[np.bool_]:
        """Which properties are stated, shape (p,)."""
        return np.array([item.stated for item in self.properties], dtype=bool)

    @property
    def all_stated(self) -> bool:
        """Whether all properties are stated: only then (8) finds them together with the slope."""
        return bool(self.stated.all())

    @property
    def none(self) -> npt.NDArray[np.bool_]:
        """None of the properties, shape (p,)."""
        return np.zeros(len(self.properties), dtype=bool)

    @property
    def searched(self) -> npt.NDArray[np.bool_]:
        """Which property was found by ``_with_likeliest_t90``, shape (p,)."""
        found = [not item.stated and item.name == "t90_s" for item in self.properties]
        return np.array(found, dtype=bool)

    def only(self, kept: npt.NDArray[np.bool_]) -> "_State":
        """Return the state for an instrument of which the other properties are exactly those at
        ``place``.
        """
        return replace(self, data=replace(self.data, columns=self.data.columns * kept))

    def cost_of_t90(self, t90_s: float) -> float:
        """Return -2 log L of (4), but for a constant, if that is the t90 of SO2.

        SO2 stays equalised by the t90 of the linearisation, and CO2 gets the shape that the cell
        would have given it: then L is of the same readings for every t90.
        """
        state = replace(self, data=self.data.if_so2_had(t90_s))
        state = replace(state, slope=max(SLOPE_LEAST, state.unweighted_slope())).refitted()
        likelihood = Likelihood(state.data, state.slope, state.properties, coarse=True)
        residual, fixed = (likelihood.averaged(each) for each in (state.residual, state.freed))
        inverse, determinants, _ = likelihood.inverse(state.variances, orthonormal(fixed))
        return float(residual @ inverse @ residual) + determinants

    def without_properties(self) -> "_State":
        """Return the state of the stated instrument, without properties."""
        so2, co2 = self.signals
        data = replace(self.data, so2=so2, co2=co2, columns=self.data.columns[:, :0])
        return replace(self, data=data, properties=[], place=np.zeros(0))

    def properties_found(self) -> tuple[Array, Array]:
        """Return mean and covariance of the properties by the residuals [units]."""
        inverse = self.only(self.none).inverse(self.freed)
        columns = self.distortions
        weighted = inverse @ columns
        priors = np.array([item.prior for item in self.properties])
        precision = np.diag(priors**-2.0) + columns.T @ weighted
        covariance: Array = np.asarray(np.linalg.inv(precision), dtype=np.float64)
        return -covariance @ (weighted.T @ self.residual), covariance

    def copies(self, *, draw_windows: bool) -> Copies:
        """Return the instruments of c + w and the columns of c - w, for each w of (7)."""
        data, errors = self.data, self.read_errors
        drawn = drawn_errors(errors)
        windows = [data.windows[i] for i in self.own]
        operator = line_operator(len(drawn), windows)
        over = np.zeros((len(drawn), 3, drawn.shape[1]))
        for i, added in enumerate(drawn.T):
            if draw_windows:
                windows = self._windows_of(data.read + added, 2.0 * errors)
                operator = line_operator(len(drawn), windows)
            copies = operator @ np.stack([data.read + added, data.read - added, data.read], axis=1)
            copies[:, 0] = in_one_shape(copies[:, 0], windows)
            over[:, :, i] = copies
        found = data.regressors(over, self.properties, self.slope)
        instruments, columns, noisy = (found[:, i].copy() for i in range(3))
        # SO2 follows all of CO2, not only the passes over their lines.
        noisy[:, :, 0] = data.co2[:, np.newaxis]
        columns[:, :, 0] = data.co2[:, np.newaxis] - data.equalised(drawn)
        return Copies(instruments=instruments, columns=columns, noisy=noisy)

    def plume_share(self, varying: Array) -> float:
        """Return the share of the energy of the passes that is neither noise nor background [-]."""
        inverse = self.only(self.none).inverse(self.fixed, varying)
        operator = line_operator(len(self.data.read), [self.data.windows[i] for i in self.own])
        whole = float(self.instrument_column @ inverse @ self.data.co2)
        errors = error_energy(self.data, inverse, operator, self.read_errors)
        return 1.0 - errors / whole if whole > 0.0 else 0.0

    def _windows_of(self, read: Array, errors: Array) -> list[Window]:
        """Return the windows of the ship's passes in CO2 with errors of that covariance."""
        windows = [window for window in self.data.windows_of(read) if self._is_own(window)]
        operator = line_operator(len(read), windows)
        high = stands_out(operator, windows, read, errors)
        return [windows[i] for i in np.flatnonzero(high)]

    def _is_own(self, window: Window) -> bool:
        """Return whether no pass of another fuel lies at the peak of this window."""
        foreign = [self.data.windows[i] for i in self.foreign]
        return not any(other.first < window.peak < other.last for other in foreign)

    def with_between(self, between: float) -> "_State":
        """Return the state with a standard deviation of the slopes of passes [ppb/ppm]."""
        return replace(self, variances=replace(self.variances, between=between))

    def with_slope(self, found: Slope) -> "_State":
        """Return the state with a slope; unchanged if the slope is not a number."""
        return replace(self, slope=found.slope) if math.isfinite(found.slope) else self


@dataclass(frozen=True, kw_only=True)
class Residuals:
    """Sums of squares of residuals in blocks, without a slow background [ppb^2].

    Attributes
    ----------
    energy : of the residuals
    noise, background, instrument : expected from the stated noise, from the background that CO2
        shows, and from one standard deviation of each stated t90 and delay
    freedom : degrees of freedom of the expected sums [-]
    """

    energy: float
    noise: float
    background: float
    instrument: float
    freedom: float

    @property
    def misfit(self) -> float:
        """Mean square of the residuals over that of the stated noise [-]; 1 without noise."""
        return self.energy / self.noise if self.noise > 0.0 else 1.0


@dataclass(frozen=True, kw_only=True)
class Fit:
    """Slope of SO2 over CO2 of a record, and the other results of the fit.

    Attributes
    ----------
    slope : [ppb/ppm]; NaN where the plume does not stand out of noise and background
    noise : its standard deviation by noise, background and differences between passes
    response : its standard deviation by t90 and delay of SO2 and CO2
    residuals : their sums of squares
    background_ppb, background_ppm, background_s : standard deviation of the background of the
        residuals and of CO2, and its correlation length
    agreement : probability that passes of one fuel differ as much as these, in slope or in time;
        NaN for a single pass
    excluded : passes of another fuel
    groups : slopes of groups of passes, and their noise
    t90_sd_s, delay_sd_s : standard deviations of t90 of SO2 and of its delay after CO2 [s]
    instrument : with the t90 and delay that the record shows where they are not stated
    problems : reasons why there can be no verdict
    """

    slope: float = math.nan
    noise: float = math.nan
    response: float = math.nan
    residuals: "Residuals | None" = None
    background_ppb: float = math.nan
    background_ppm: float = math.nan
    background_s: float = math.nan
    agreement: float = math.nan
    excluded: tuple[ExcludedPass, ...] = ()
    groups: tuple[tuple[float, float], ...] = ()
    t90_sd_s: float = math.nan
    delay_sd_s: float = math.nan
    instrument: SnifferSpec
    problems: tuple[str, ...] = ()
    _state: _State | None = field(default=None, repr=False)
    _weights: Array = field(default_factory=lambda: np.zeros(0), repr=False)

    def change(self, moved: SnifferSpec) -> tuple[float, Array]:
        """Return the changes of slope and residuals with another instrument.

        Parameters
        ----------
        moved : ``instrument`` with one property changed
        """
        state = self._state
        if state is None:
            return 0.0, np.zeros(1)
        (so2, co2), (other_so2, other_co2) = (
            state.data.means(instrument) for instrument in (self.instrument, moved)
        )
        residual = other_so2 - so2 - self.slope * (other_co2 - co2)
        fixed = state.fixed
        return float(self._weights @ residual), residual - fixed @ (fixed.T @ residual)


def fit_record(record: Record, instrument: SnifferSpec) -> Fit:
    """Return the fit of a record.

    Parameters
    ----------
    instrument : an infinite deviation of t90 or delay of SO2 means that it is not stated; the value
        is where the search begins
    """
    state = _begun(record, instrument)
    if state is None:
        return Fit(instrument=instrument)
    if math.isinf(instrument.known("so2").t90_sd):
        instrument, state = _with_likeliest_t90(record, instrument, state)
    else:
        state = _linearised(record, instrument, state)
    state, _, _ = _without_foreign(state)
    state, problems = _of_passes_that_stand_out(record, instrument, state)
    state, alike, agreement = _without_foreign(state)
    own = state.data.passes[:, state.own]
    if len(state.own) > 2:
        start = 0.1 * abs(state.slope) + state.solved(own).deviation
        state = state.with_between(max(1e-3, start)).refitted(own)
    else:
        state = state.with_between(0.0)
    found = state.solved(own, draw_windows=True)
    if not math.isfinite(found.slope):
        return Fit(instrument=instrument, problems=(_HAZE,))
    if state.plume_share(own) < KEPT_LEAST and not problems:
        problems = (_HAZE,)
    state = state.with_slope(found)
    corrected = _CORRECTED_SPREAD * state.slope * max(0.0, 1.0 / found.kept - 1.0)
    problems += _disagreement(state, alike, agreement)
    return _result(instrument, state, found, corrected, agreement, problems)


_HAZE = "CO2 background varies as much within passes as the plume; fly closer or wait"


def _begun(record: Record, instrument: SnifferSpec) -> _State | None:
    """Return the initial state; None without passes."""
    properties = uncertain_properties(instrument)
    data = block_record(record, instrument, properties)
    if data is None or not data.windows:
        return None
    start = Variances(noise=1.0, background=0.0, length=25.0)
    place = np.zeros(len(properties))
    state = _State(data=data, properties=properties, place=place, variances=start, slope=0.0)
    slope = max(SLOPE_LEAST, state.unweighted_slope())
    return replace(state, slope=slope, variances=replace(start, background=0.3 * slope))


def _linearised(record: Record, instrument: SnifferSpec, state: _State) -> _State:
    """Return the state linearised about the properties that the record shows."""
    rounds = _ROUNDS if state.all_stated else _ROUNDS_FREE
    for number in range(rounds):
        state, found = _with_slope_anew(state)
        if state.all_stated:
            place = state.place + found.properties
        else:
            place, _ = state.properties_found()
        place = np.where(state.stated, np.clip(place, -_PLACE_MOST, _PLACE_MOST), place)
        most = np.array([_STEP_MOST[item.name] / item.unit for item in state.properties])
        place = state.place + np.clip(place - state.place, -most, most)
        settled = bool(np.all(np.abs(place - state.place) < _SETTLED))
        if settled or number == rounds - 1:
            return state
        moved = replace(state, place=place)
        data = block_record(record, moved.moved(instrument), state.properties)
        if data is None or not data.windows:
            return state
        state = replace(moved, data=data)
    return state


def _with_slope_anew(state: _State) -> tuple[_State, Slope]:
    """Return the state with variances and slope found anew, and that slope."""
    slope = max(SLOPE_LEAST, state.unweighted_slope())
    state = replace(state, slope=slope).refitted()
    found = state.solved()
    return state.with_slope(found), found


def _with_likeliest_t90(
    record: Record, instrument: SnifferSpec, state: _State
) -> tuple[SnifferSpec, _State]:
    """Return the instrument with the t90 of SO2 of the largest likelihood, and the state.

    Steps of the linearisation lead away from the true t90 of a cell in which passes overlap: there
    another t90 changes SO2 almost as another slope does.
    """
    so2 = instrument.known("so2")
    log_t90 = math.log(so2.t90_s)

    def with_t90(log_t90: float, deviation: float) -> SnifferSpec:
        return instrument.with_channel(replace(so2, t90_s=math.exp(log_t90), t90_sd=deviation))

    for _ in range(_SEARCHES):
        known = with_t90(log_t90, 0.0)
        begun = _begun(record, known)
        if begun is None:
            return instrument, state
        found = _linearised(record, known, begun)
        before, log_t90 = log_t90, _least(found.cost_of_t90, log_t90)
        if abs(log_t90 - before) < _T90_SETTLED:
            break
    # With t90 of SO2 again, the first of the properties.
    instrument = with_t90(log_t90, math.inf)
    state = replace(found, properties=state.properties, place=np.insert(found.place, 0, 0.0))
    data = block_record(record, state.moved(instrument), state.properties)
    return instrument, _with_slope_anew(replace(state, data=data or found.data))[0]


def _least(cost_of_t90: Callable[[float], float], log_t90: float) -> float:
    """Return the logarithm of the t90 of the least cost near another, on a grid and then beside its
    least: there are several minima.
    """
    from scipy.optimize import minimize_scalar

    def cost(value: float) -> float:
        return cost_of_t90(math.exp(value))

    least, most = math.log(T90_LEAST), math.log(T90_MOST)
    grid = np.clip(log_t90 + _T90_GRID, least, most)
    best = float(grid[np.argmin([cost(value) for value in grid])])
    step = float(np.diff(_T90_GRID)[0])
    beside = max(least, best - step), min(most, best + step)
    found = minimize_scalar(
        cost, bounds=beside, method="bounded", options={"xatol": _T90_TOLERANCE}
    )
    return float(found.x)


def _of_passes_that_stand_out(
    record: Record, instrument: SnifferSpec, state: _State
) -> tuple[_State, tuple[str, ...]]:
    """Return the state with the passes that stand out of the background, and the problem of a
    record without such passes.

    Peaks of the background are selected by their height, so that (7) would not correct them.
    """
    data = state.data
    operator = line_operator(len(data.read), data.windows)
    high = stands_out(operator, data.windows, data.read, state.read_errors)
    if not high[state.own].any():
        return state, (_HAZE,)
    high[list(state.foreign)] = True
    if high.all():
        return state, ()
    kept = np.flatnonzero(high)
    windows = [data.windows[i] for i in kept]
    fewer = block_record(record, state.moved(instrument), state.properties, windows)
    if fewer is None:
        return state, ()
    foreign = tuple(int(np.searchsorted(kept, i)) for i in state.foreign)
    state = replace(state, data=fewer, foreign=foreign).refitted()
    return state.with_slope(state.solved()), ()


def stands_out(
    operator: Array, windows: Sequence[Window], read: Array, errors: Array
) -> npt.NDArray[np.bool_]:
    """Return which passes are higher over their lines than errors of CO2 reach by chance.

    Parameters
    ----------
    operator : Q of (5)
    read, errors : CO2 of all blocks [ppm], and the covariance of its errors [ppm^2]
    """
    rows = operator[[window.peak for window in windows]]
    deviations = np.sqrt(np.einsum("ij,ij->i", rows @ errors, rows))
    return np.asarray(rows @ read > _STANDS_OUT * deviations)


def _without_foreign(state: _State) -> tuple[_State, Array, float]:
    """Return the state without passes whose slope is very different, P, and the agreement of the
    others.

    Passes of one fuel may differ by ``ALIKE``.
    """
    most = int(FOREIGN_MOST * len(state.data.windows))
    while True:
        state = state.with_between(ALIKE * abs(state.slope))
        own = state.data.passes[:, state.own]
        inverse = state.inverse(state.fixed, own)
        state = state.with_slope(state.solved(own))
        against = own.T @ (inverse @ state.residual)
        inner = own.T @ (inverse @ own)
        strength = np.abs(against) / np.sqrt(np.maximum(np.diagonal(inner), 1e-12))
        worst = int(np.argmax(strength))
        too_few = len(state.data.windows) < _COMPARED_LEAST or len(state.foreign) >= most
        if too_few or strength[worst] < FOREIGN_SIGMA:
            return state, inverse, _agreement(state, inverse)
        state = replace(state, foreign=(*state.foreign, state.own[worst])).refitted()


def _agreement(state: _State, inverse: Array) -> float:
    """Return the probability that passes of one fuel differ as much as these, in ratio or in time.

    Another plume that overlaps the ship's is hardly ever at the same place in every pass. So it
    changes, from pass to pass, the ratio and the place of SO2 relative to CO2. A difference that
    all passes have in common, as of slope, t90 or delay, does not count.

    Parameters
    ----------
    inverse : P of (3) in which slopes of passes may differ by ``ALIKE``
    """
    own = state.data.passes[:, state.own]
    if own.shape[1] < 2:
        return math.nan
    later = state.later(own)
    inverse = _with_columns(inverse, TOGETHER * state.slope * later)
    common = orthonormal(np.hstack([own.sum(axis=1, keepdims=True), state.data.columns]))
    weighted = inverse @ common
    inverse = inverse - weighted @ np.linalg.solve(common.T @ weighted, weighted.T)
    residual = inverse @ state.residual
    # Ratios are also tested alone: together with as many places, differences of the ratios are less
    # significant.
    chances = [
        _chance_of_scores(columns.T @ residual, columns.T @ (inverse @ columns))
        for columns in (own, np.hstack([own, _PASS_S * later]))
    ]
    return min(1.0, len(chances) * min(chances))


def _chance_of_scores(scores: Array, covariance: Array) -> float:
    """Return the probability of scores at least as large as these, given their covariance."""
    values, vectors = np.linalg.eigh(covariance)
    telling = values > 1e-4 * values[-1]
    squares = (vectors.T @ scores)[telling] ** 2 / values[telling]
    return float(chdtrc(int(telling.sum()), float(squares.sum())))


def _with_columns(inverse: Array, columns: Array) -> Array:
    """Return P of (3) after the outer product of columns has been added to V."""
    weighted = inverse @ columns
    inner = np.eye(columns.shape[1]) + columns.T @ weighted
    return np.asarray(inverse - weighted @ np.linalg.solve(inner, weighted.T))


def _disagreement(state: _State, inverse: Array, agreement: float) -> tuple[str, ...]:
    """Return the problem of passes that are not of one fuel, with their ratios."""
    count = len(state.data.windows)
    full = len(state.foreign) >= max(1, int(FOREIGN_MOST * count))
    change, chance = _change_of_slope(state, inverse)
    if not (full or agreement < DISAGREE or chance < CHANGE):
        return ()
    if chance < CHANGE and chance < agreement:
        first, last = _times(state, change)
        return (
            "passes show at least two ratios: a change of fuel, or another ship's plume, between"
            f" {first:.0f} and {last:.0f} s (p = {chance:.1g}); analyse both parts as two logs",
        )
    shown = f"p = {agreement:.1g}"
    if full:
        times = ", ".join(f"{item.time_s:.0f}" for item in _excluded(state))
        shown = f"those at {times} s differ from the others"
    return (
        f"passes show at least two ratios: another ship's plume, or a change of fuel ({shown})",
    )


def _times(state: _State, change: int) -> tuple[float, float]:
    """Return the times of the passes before and after a change [s] since the first sample."""
    own, time = state.own, state.data.blocks.time
    before, after = (state.data.windows[own[i]].peak for i in (change - 1, change))
    start = float(state.data.signals.record.time[0])
    return float(time[before]) - start, float(time[after]) - start


def _change_of_slope(state: _State, inverse: Array) -> tuple[int, float]:
    """Return the first pass after the largest change of slope, and the probability of that change.

    It is the probability that the largest of all changes is as large by chance: at most the number
    of changes times the probability of one.
    """
    own = state.data.passes[:, state.own]
    count = own.shape[1]
    if count < _COMPARED_LEAST:
        return 0, 1.0
    # A common slope of the later passes, in addition to the slope of all passes.
    later = np.cumsum(own[:, ::-1], axis=1)[:, ::-1]
    weighted = inverse @ later
    inner = later.T @ weighted
    free = inner - np.outer(inner[:, 0], inner[0]) / inner[0, 0]
    scores = weighted.T @ state.residual
    scores = scores - inner[:, 0] * scores[0] / inner[0, 0]
    found = scores[1:] ** 2 / np.maximum(np.diagonal(free)[1:], 1e-9 * inner[0, 0])
    change = 1 + int(np.argmax(found))
    return change, min(1.0, (count - 1) * float(chdtrc(1, float(found[change - 1]))))


def _result(
    instrument: SnifferSpec,
    state: _State,
    found: Slope,
    corrected: float,
    agreement: float,
    problems: Sequence[str],
) -> Fit:
    """Return the fit with its figures."""
    data, stated = state.data, state.stated
    t90_sd_s, delay_sd_s = _timing_deviations(instrument, state)
    by_searched = 0.0
    if state.all_stated:
        by_others = float(np.sum(found.by_property**2))
    else:
        # The parts of the noise that D adds.
        effects = state.distortions.T @ found.weights
        own, z = data.passes[:, state.own], state.instrument_column
        least, whole = (
            1.0 / float(z @ state.only(kept).inverse(state.fixed, own) @ z)
            for kept in (stated, ~state.searched)
        )
        by_others = float(np.sum(effects[stated] ** 2))
        by_others += found.deviation**2 * max(0.0, 1.0 - least / whole)
        _, covariance = state.properties_found()
        by_searched = float(effects**2 @ (np.diagonal(covariance) * state.searched))
    response = by_others + by_searched
    noise = math.sqrt(max(0.0, found.deviation**2 - by_others) + corrected**2)
    size = background_of_co2(data, state.variances, state.slope)
    return Fit(
        slope=state.slope,
        noise=noise,
        response=math.sqrt(response),
        residuals=_residuals(state, size),
        background_ppb=state.variances.background,
        background_ppm=size,
        background_s=state.variances.length,
        agreement=agreement,
        excluded=_excluded(state),
        groups=_groups(state),
        t90_sd_s=t90_sd_s,
        delay_sd_s=delay_sd_s,
        instrument=_with_found_timing(instrument, state),
        problems=tuple(problems),
        _state=state,
        _weights=found.weights,
    )


def _residuals(state: _State, size: float) -> Residuals:
    """Return the residuals of the slope, given the size of CO2's background [ppm]."""
    data = state.data
    slow = data.blocks.mean(data.signals.basis)[data.known]
    basis = orthonormal(np.hstack([state.fixed, slow]))

    def beside(values: Array) -> Array:
        return np.asarray(values - basis @ (basis.T @ values))

    columns = state.distortions[:, state.stated]
    shown = columns @ state.place[state.stated]
    residual = beside(data.so2 - state.slope * data.co2 - shown)
    noise = beside(beside(data.noise(state.slope)).T)
    kernel = beside(beside(data.background(state.variances.length)).T)
    expected = noise + (state.slope * size) ** 2 * kernel
    squares = float(np.vdot(expected, expected))
    return Residuals(
        energy=float(residual @ residual),
        noise=float(np.trace(noise)),
        background=(state.slope * size) ** 2 * float(np.trace(kernel)),
        instrument=float(np.sum(beside(columns) ** 2)),
        freedom=float(np.trace(expected)) ** 2 / squares if squares > 0.0 else 1.0,
    )


def _excluded(state: _State) -> tuple[ExcludedPass, ...]:
    """Return the passes of other fuels, with slopes that are fitted together with the ship's."""
    if not state.foreign:
        return ()
    columns = state.data.passes[:, list(state.foreign)]
    slopes, deviations = _own_slopes(state, columns)
    times = [state.data.blocks.time[state.data.windows[i].peak] for i in state.foreign]
    found = [
        ExcludedPass(time_s=float(time), slope=slope, deviation=deviation)
        for time, slope, deviation in zip(times, slopes, deviations, strict=True)
    ]
    return tuple(sorted(found, key=lambda item: item.time_s))


_GROUPS_MAX = 8
"""Largest number of groups of passes: single passes overlap in a slow sensor and have large errors.
"""

_TELLING = 0.1
"""Least CO2 of a group, relative to the median group [-]."""


def _groups(state: _State) -> tuple[tuple[float, float], ...]:
    """Return slope and noise of groups of neighbouring passes, fitted together."""
    count = len(state.data.windows)
    if count < 2:
        return ()
    parts = np.array_split(np.arange(count), min(_GROUPS_MAX, count))
    columns = np.stack([state.data.passes[:, part].sum(axis=1) for part in parts], axis=1)
    norms = np.linalg.norm(columns, axis=0)
    columns = columns[:, norms > _TELLING * np.median(norms)]
    sizes = np.linalg.svd(columns, compute_uv=False)
    if columns.shape[1] < 2 or sizes[-1] <= 1e-6 * sizes[0]:
        return ()
    return tuple(zip(*_own_slopes(state, columns), strict=True))


def _own_slopes(state: _State, columns: Array) -> tuple[list[float], list[float]]:
    """Return slopes of passes or groups and their noise, fitted together with the slope of all
    others.
    """
    inverse = state.inverse(state.data.fixed)
    weighted = inverse @ columns
    covariance = np.linalg.pinv(columns.T @ weighted, hermitian=True)
    differences = covariance @ (weighted.T @ state.residual)
    deviations = np.sqrt(np.maximum(np.diagonal(covariance), 0.0))
    return [float(state.slope + d) for d in differences], [float(d) for d in deviations]


# Response and delay that are not stated


def _with_found_timing(instrument: SnifferSpec, state: _State) -> SnifferSpec:
    """Return the instrument, with the record's values of the properties that are not stated."""
    for item, units in zip(state.properties, state.place, strict=True):
        if not item.stated:
            instrument = item.moved(instrument, float(units))
    return instrument


def _timing_deviations(instrument: SnifferSpec, state: _State) -> tuple[float, float]:
    """Return the standard deviations of t90 of SO2, and of its delay after CO2 [s].

    Where they are stated, these are the stated ones.
    """
    so2, co2 = instrument.known("so2"), instrument.known("co2")
    t90_sd_s = so2.t90_s * so2.t90_sd
    delay_sd_s = math.hypot(so2.delay_sd_s, co2.delay_sd_s)
    if math.isfinite(t90_sd_s) and math.isfinite(delay_sd_s):
        return t90_sd_s, delay_sd_s
    _, covariance = state.properties_found()
    units = np.array([item.unit for item in state.properties])
    covariance = covariance * np.outer(units, units)
    names = [(item.gas, item.name) for item in state.properties]
    if math.isinf(so2.t90_sd):
        i = names.index(("so2", "t90_s"))
        found = _with_found_timing(instrument, state).known("so2").t90_s
        t90_sd_s = found * math.sqrt(max(0.0, covariance[i, i]))
    if math.isinf(so2.delay_sd_s):
        after = np.array(
            [{"so2": 1.0, "co2": -1.0}[gas] * (name == "delay_s") for gas, name in names]
        )
        delay_sd_s = math.sqrt(max(0.0, float(after @ covariance @ after)))
    return t90_sd_s, delay_sd_s
