"""Sensitivity of a figure to the random variables: Borgonovo's delta and the first-order index.

Delta is half the mean distance between the figure's density and its density for a known input: 0 if
the input does not matter, 1 if it determines the figure. E. Borgonovo, "A new uncertainty
importance measure", Reliability Engineering & System Safety 92 (2007). The first-order index S1 is
the fraction of the figure's variance that the input explains by itself. Delta is estimated by SALib
from given data: E. Plischke, E. Borgonovo and C. L. Smith, "Global sensitivity measures from given
data", European Journal of Operational Research 226 (2013). S1 is not estimated by SALib, which
assumes a constant mean within classes of an input, so that the index of a dominant input is too low
by more than its interval; ``first_order_index`` has no classes.

In a finite sample the indices of an input without effect are not 0. Indices of some random inputs
without effect are therefore estimated as well, and the largest of them is the noise floor. Flights
of one sample, such as those at the points of a sweep, have the same inputs and similar figures.
They also share the values of these random inputs, and are resampled together.

First-order index S1 = Var(E[Y | X]) / Var(Y) = 1 - E[Var(Y | X)] / Var(Y): the fraction of the
variance of a figure Y that one input X explains, from flights with random inputs. The only
assumption is that the mean of Y over X is fairly smooth.

Unexplained variance
    A cubic spline in X with knots at quantiles fits E[Y | X], or a mean per value if X has few
    values. The residual of a flight is too small, because the fit follows the flight. Its
    prediction error by a fit without its sample is too large. The mean of their product is the
    residual variance, to the first order in the leverage, also if that variance depends on X (J. G.
    MacKinnon and H. White, "Some heteroskedasticity-consistent covariance matrix estimators",
    Journal of Econometrics 29 (1985), their HC2). A spline may therefore have many functions
    without raising the index, unlike classes or a series without this correction. Var(Y) is the
    same product for a fit by the mean alone.
Interval
    S1 = 1 - R/T, with the means R and T of these products R_i and T_i. A flight's influence on S1
    is (R_i - (1 - S1) T_i)/T, as for the efficient estimator (S. Da Veiga and F. Gamboa, "Efficient
    estimation of sensitivity indices", Journal of Nonparametric Statistics 25 (2013)), and the sum
    of squares of the influences is the variance of the index. If a figure has a heavy tail, few
    flights determine the index. Student's t therefore has as many degrees of freedom as there would
    be flights of equal influence with the same sums of squares and of fourth powers.
Error of the spline
    A spline with half as many functions has a larger error. The difference of the two indices is
    added as a further standard deviation.
"""

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pandas as pd

SAMPLES_PER_FUNCTION = 10
"""Samples per function of a spline: the correction then widens the interval by 5 %."""

FUNCTIONS_MAX = 60
"""Largest number of functions: 60 leave at most a hundredth of a jump unexplained."""

_DEGREE = 3
"""Degree of the spline."""

_FUNCTIONS_MIN = _DEGREE + 2
"""Least number of functions of the spline: two joined cubics."""

_DEPENDENT = 1e-10
"""Eigenvalue over the largest one below which functions count as dependent [-]."""

_OWN_FIT = 1e-8
"""Residual over deviation below which only the flight's own sample predicts it [-]."""

_ROUNDING = 1e-9
"""Least half-width [-], for rounding errors of the index of an input that determines a figure."""

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]


@dataclass(frozen=True, slots=True, kw_only=True)
class FirstOrderIndex:
    """Fraction of a figure's variance that an input explains.

    Attributes
    ----------
    index : estimate, which scatter may make negative [-]
    half_width : half-width of the interval, at most 1 [-]
    """

    index: float
    half_width: float


def functions_for(samples: int) -> int:
    """Return the number of functions that fit a figure over an input, by number of samples."""
    return max(_FUNCTIONS_MIN, min(samples // SAMPLES_PER_FUNCTION, FUNCTIONS_MAX))


def first_order_index(
    values: Array, figure: Array, *, confidence: float, samples: Indices | None = None
) -> FirstOrderIndex:
    """Return the first-order index of an input with its interval.

    Parameters
    ----------
    values : input of each flight, shape (n,)
    figure : figure of each flight, shape (n,), not the same in all
    confidence : confidence of the interval, between 0 and 1
    samples : number of each flight's sample, from 0 without a gap, shape (n,); by default every
        flight is its own sample
    """
    from scipy.stats import t as student

    of = np.arange(len(figure)) if samples is None else samples
    count = int(of.max()) + 1
    functions = functions_for(count)
    variance = _residual_products(np.ones((len(figure), 1)), figure, of)
    total = float(variance.mean())

    def unexplained(functions: int) -> Array:
        products = _residual_products(_basis(values, functions), figure, of)
        # Without a prediction by other flights, nothing of a flight's variance is explained.
        return np.where(np.isnan(products), variance, products)

    residual = unexplained(functions)
    coarser = unexplained(max(functions // 2, _DEGREE + 1))
    share = float(residual.mean()) / total
    influence = np.bincount(of, weights=(residual - share * variance) / total) / len(figure)
    squares = influence**2
    energy = float(squares.sum())
    deciding = energy**2 / float((squares**2).sum()) if energy > 0.0 else math.inf
    deviation = math.hypot(
        math.sqrt(energy * count / (count - 1)), float(coarser.mean() - residual.mean()) / total
    )
    quantile = float(student.ppf(0.5 + 0.5 * confidence, deciding))
    half_width = min(1.0, max(_ROUNDING, quantile * deviation))
    return FirstOrderIndex(index=1.0 - share, half_width=half_width)


def _basis(values: Array, count: int) -> Array:
    """Return the fit functions of an input at each flight, shape (n, up to ``count``).

    An input with few values has one function per value. Otherwise they are those of a cubic spline,
    with equal numbers of flights between its knots.
    """
    distinct = np.unique(values)
    if len(distinct) <= count:
        return np.asarray(values[:, np.newaxis] == distinct, dtype=np.float64)
    from scipy.interpolate import BSpline

    scaled = (values - distinct[0]) / (distinct[-1] - distinct[0])
    # Knots are existing values, so that repeated flights do not move them.
    shares = np.linspace(0.0, 1.0, count - _DEGREE + 1)
    inner = np.unique(np.quantile(scaled, shares, method="inverted_cdf"))
    knots = np.concatenate([np.zeros(_DEGREE), inner, np.ones(_DEGREE)])
    found: Array = BSpline.design_matrix(scaled, knots, _DEGREE).toarray()
    return found


def _residual_products(functions: Array, figure: Array, of: Indices) -> Array:
    """Return each flight's residual times its prediction error by a fit without its sample.

    With the hat matrix H and the residuals e of the fit, the prediction errors of a sample c are (I
    - H_cc)^-1 e_c. The product is NaN for flights that only their own sample predicts.

    Parameters
    ----------
    functions : fit functions at each flight, shape (n, p)
    figure : figure of each flight, shape (n,)
    of : sample of each flight, shape (n,)
    """
    # Splines are nearly orthogonal, so the normal equations are accurate enough.
    size, directions = np.linalg.eigh(functions.T @ functions)
    kept = size > _DEPENDENT * size[-1]
    basis = functions @ (directions[:, kept] / np.sqrt(size[kept]))
    centred = figure - figure.mean()
    residual = centred - basis @ (basis.T @ centred)
    if len(np.unique(of)) == len(figure):
        left_by_fit = 1.0 - np.sum(basis**2, axis=1)
        known = left_by_fit > _OWN_FIT
        products = np.full(len(figure), np.nan)
        products[known] = residual[known] ** 2 / left_by_fit[known]
        return products
    products = np.full(len(figure), np.nan)
    members = np.split(np.argsort(of, kind="stable"), np.cumsum(np.bincount(of))[:-1])
    for flights in members:
        block = np.eye(len(flights)) - basis[flights] @ basis[flights].T
        if np.linalg.eigvalsh(block)[0] > _OWN_FIT:
            products[flights] = residual[flights] * np.linalg.solve(block, residual[flights])
    return products


FLIGHTS_MIN = 200
"""Least number of flights: with fewer, classes of an input have too few flights for a density."""

FLIGHTS_MAX = 2000
"""Largest number of flights in use, so that an index takes a tenth of a second.

More flights are sampled at random.
"""

RESAMPLES = 20
"""Bootstrap samples for the interval of delta: 20 give its width to 16 %, 1/sqrt(2 19)."""

DUMMIES = 5
"""Number of random inputs without effect: a further one exceeds all of them one time in six."""

_GRID = 100
"""Number of points at which densities are compared, as in SALib."""

_CLASSES_MAX = 48
"""Largest number of classes of an input, as in SALib."""


@dataclass(frozen=True, slots=True, kw_only=True)
class InputIndices:
    """Sensitivity of a figure to one input.

    Attributes
    ----------
    key : key of the input
    delta, first_order : indices [-]
    delta_error, first_order_error : half-widths of their intervals [-]
    """

    key: str
    delta: float
    delta_error: float
    first_order: float
    first_order_error: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Sensitivity:
    """Sensitivity of a figure to all inputs.

    Attributes
    ----------
    flights : number of flights in use
    known : number of flights that have the figure
    inputs : indices of the inputs, the largest delta first
    delta_floor, first_order_floor : noise floors [-]; NaN without indices
    left_out : reasons why other inputs have no indices
    message : reason why no input has indices; empty if some do
    """

    flights: int
    known: int
    inputs: tuple[InputIndices, ...]
    delta_floor: float
    first_order_floor: float
    left_out: dict[str, str]
    message: str


def sensitivity_indices(
    inputs: pd.DataFrame,
    figure: Array,
    *,
    confidence: float,
    seed: int,
    samples: Indices | None = None,
) -> Sensitivity:
    """Estimate the sensitivity of a figure to the inputs.

    Parameters
    ----------
    inputs : a row per flight and a column per input, with numbers, or words for unordered
        categories
    figure : figure of each flight, shape (n,); flights with NaN are left out
    confidence : confidence of the intervals, between 0 and 1; for delta a normal distribution with
        the bootstrap's standard deviation is assumed
    seed : seed of the choice of flights, the noise floor and the bootstrap
    samples : number of each flight's sample, shape (n,); by default every flight is its own sample
    """
    generator = np.random.default_rng(seed)
    known = np.flatnonzero(np.isfinite(figure))
    # The order is random even if all are used, because it assigns flights with equal inputs to
    # classes.
    chosen = generator.permutation(known)[:FLIGHTS_MAX]
    of, distinct = pd.factorize(chosen if samples is None else samples[chosen])
    left_out = {
        str(key): why
        for key in inputs
        if (why := _unusable(inputs[key].iloc[chosen], len(distinct)))
    }
    codes = {str(key): _coded(inputs[key].iloc[chosen]) for key in inputs if key not in left_out}
    found: list[InputIndices] = []
    dummies: list[InputIndices] = []
    message = _reason_for_no_indices(figure[chosen], codes)
    if not message:
        resamples = [
            _resampled(of, generator.integers(len(distinct), size=len(distinct)))
            for _ in range(RESAMPLES)
        ]
        without_effect = [generator.random(len(distinct))[of] for _ in range(DUMMIES)]
        try:
            found = [
                _indices(key, values, figure[chosen], of, resamples, confidence)
                for key, values in codes.items()
            ]
            dummies = [
                _indices("", values, figure[chosen], of, resamples, confidence)
                for values in without_effect
            ]
        except np.linalg.LinAlgError:
            found, message = [], "too few flights differ in this figure for a density of it"
    return Sensitivity(
        flights=len(chosen),
        known=len(known),
        inputs=tuple(sorted(found, key=lambda index: -index.delta)),
        delta_floor=max((dummy.delta for dummy in dummies), default=math.nan),
        first_order_floor=max((dummy.first_order for dummy in dummies), default=math.nan),
        left_out=left_out,
        message=message,
    )


def _resampled(of: Indices, picked: Indices) -> Indices:
    """Return the indices of the flights in the picked samples; ``of`` has each flight's sample."""
    members = np.split(np.argsort(of, kind="stable"), np.cumsum(np.bincount(of))[:-1])
    return np.concatenate([members[sample] for sample in picked])


def _unusable(values: "pd.Series[float]", samples: int) -> str:
    """Return why an input has no index; empty if it has one."""
    if values.isna().any():
        return "not sampled for every flight"
    kinds = values.nunique()
    if not pd.api.types.is_numeric_dtype(values) and kinds > functions_for(samples):
        return f"{kinds:,} categories in {samples:,} samples, too few of each"
    return "the same in every flight" if kinds < 2 else ""


def _reason_for_no_indices(figure: Array, inputs: dict[str, Array]) -> str:
    if len(figure) < FLIGHTS_MIN:
        return f"{len(figure)} flights have this figure; indices take {FLIGHTS_MIN} at least"
    if not inputs:
        return "no input differs between flights"
    # A spread near the limit of double precision is only rounding.
    if np.ptp(figure) <= 1e-12 * np.max(np.abs(figure)):
        return "the figure is the same in every flight"
    return ""


def _coded(values: "pd.Series[float]") -> Array:
    """Return an input as numbers; every category gets its own number."""
    coded = values if pd.api.types.is_numeric_dtype(values) else pd.factorize(values.astype(str))[0]
    return np.asarray(coded, dtype=np.float64)


def _indices(
    key: str,
    values: Array,
    figure: Array,
    of: Indices,
    resamples: Sequence[Indices],
    confidence: float,
) -> InputIndices:
    """Return the indices of one input; delta is corrected for bias (Plischke et al., eq. 30)."""
    from scipy.special import ndtri

    delta = _delta(values, figure)
    again = np.array([_delta(values[chosen], figure[chosen]) for chosen in resamples])
    first = first_order_index(values, figure, confidence=confidence, samples=of)
    return InputIndices(
        key=key,
        delta=2.0 * delta - float(again.mean()),
        delta_error=float(ndtri(0.5 + 0.5 * confidence) * again.std(ddof=1)),
        first_order=first.index,
        first_order_error=first.half_width,
    )


def _delta(values: Array, figure: Array) -> float:
    """Return SALib's estimate of delta (Plischke et al., eq. 26).

    ``SALib.analyze.delta.analyze`` uses the same function, but with classes of equal size for any
    input. Some classes then hold two categories, and an input of two categories loses a fifth of
    its index. It also uses NumPy's global generator.

    Raises
    ------
    numpy.linalg.LinAlgError : the figure is the same everywhere
    """
    from SALib.analyze.delta import calc_delta

    grid = np.linspace(figure.min(), figure.max(), _GRID)
    with warnings.catch_warnings():
        # SALib warns of classes with a single figure, such as a rare category, which add nothing.
        warnings.simplefilter("ignore")
        return float(calc_delta(figure, grid, values, _class_bounds(values)))


def _class_bounds(values: Array) -> Array:
    """Return the number of flights below each class of an input, followed by the number of all.

    An input with few values has a class per value. Otherwise classes have equal size, and are as
    many as in SALib.
    """
    count = len(values)
    classes = min(
        math.ceil(count ** (2.0 / (7.0 + math.tanh((1500.0 - count) / 500.0)))), _CLASSES_MAX
    )
    _, of_each = np.unique(values, return_counts=True)
    if len(of_each) <= classes:
        return np.concatenate([[0.0], np.cumsum(of_each)])
    return np.linspace(0.0, count, classes + 1)
