"""First-order index S1: the share of a figure's variance that one input explains by itself.

S1 = Var(E[Y | X]) / Var(Y) = 1 - E[Var(Y | X)] / Var(Y), from flights whose inputs were sampled at
random. Nothing else is assumed of the figure Y than that its mean over X is fairly smooth.

Unexplained variance
    A cubic spline in X with knots at its quantiles fits E[Y | X], or a mean per value where X has
    few. The residual of a flight is too small, as the fit follows that flight; its prediction error
    by a fit without its sample is too large. Their product has the residual variance as its
    mean, to the first order in the leverage, whatever that variance is at each X (J. G. MacKinnon
    and H. White, "Some heteroskedasticity-consistent covariance matrix estimators", Journal of
    Econometrics 29 (1985), their HC2). So a spline may have many functions, which
    keeps what it cannot follow small, and they do not raise the index as classes or a
    series without this correction do. Var(Y) is the same product for a fit by the mean alone.
Interval
    S1 = 1 - R/T, with R and T the means of these products, R_i and T_i. A flight's influence on
    it is (R_i - (1 - S1) T_i)/T, that of the efficient estimator (S. Da Veiga and F. Gamboa,
    "Efficient estimation of sensitivity indices", Journal of Nonparametric Statistics 25 (2013)),
    and the sum of squares of the influences is the variance of the index. A figure with a heavy tail
    has few flights that decide on it: Student's t has as many degrees of freedom as flights of
    equal influence would have the same sum of squares and of fourth powers.
What the spline cannot follow
    A spline with half as many functions has a larger error of this kind. How far the two indices
    are apart is taken for a further standard deviation.
"""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

SAMPLES_PER_FUNCTION = 10
"""Samples for each function of a spline: the correction then costs 5 % of the interval's width."""

FUNCTIONS_MAX = 60
"""Largest number of functions: 60 leave a jump's hundredth unexplained at most."""

_DEGREE = 3
"""Degree of the spline."""

_FUNCTIONS_MIN = _DEGREE + 2
"""Least number of functions of the spline: two cubics that meet."""

_DEPENDENT = 1e-10
"""Eigenvalue of functions' products, over the largest, of a function that depends on others [-]."""

_OWN_FIT = 1e-8
"""Share of a flight's deviation that its own fit leaves, below which nothing else predicts it [-]."""

_ROUNDING = 1e-9
"""Least half width, as the index of an input that determines the figure has errors of rounding."""

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]


@dataclass(frozen=True, slots=True, kw_only=True)
class FirstOrderIndex:
    """Share of a figure's variance that an input explains.

    Attributes
    ----------
    index : estimate [-]; scatter may make it negative
    half_width : of its interval, 1 at most [-]
    """

    index: float
    half_width: float


def functions_for(samples: int) -> int:
    """Return how many functions fit a figure over an input of so many samples."""
    return max(_FUNCTIONS_MIN, min(samples // SAMPLES_PER_FUNCTION, FUNCTIONS_MAX))


def first_order_index(
    values: Array, figure: Array, *, confidence: float, samples: Indices | None = None
) -> FirstOrderIndex:
    """Return the first-order index of an input with its interval.

    Parameters
    ----------
    values : input of each flight, shape (n,)
    figure : figure of each flight, shape (n,), not the same in all
    confidence : of the interval, between 0 and 1
    samples : sample that each flight is of, from 0 without a gap, shape (n,); flights of one sample
        count together. Each flight is a sample of its own if not given.
    """
    from scipy.stats import t as student

    of = np.arange(len(figure)) if samples is None else samples
    count = int(of.max()) + 1
    functions = functions_for(count)
    variance = _residual_products(np.ones((len(figure), 1)), figure, of)
    total = float(variance.mean())

    def unexplained(functions: int) -> Array:
        products = _residual_products(_basis(values, functions), figure, of)
        # No other flight predicts this one: nothing of it is explained.
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
    """Return the functions of an input at each flight, shape (n, count at most).

    One per value if there are few values; otherwise a cubic spline's, with as many flights between
    one knot and the next.
    """
    distinct = np.unique(values)
    if len(distinct) <= count:
        return np.asarray(values[:, np.newaxis] == distinct, dtype=np.float64)
    from scipy.interpolate import BSpline

    scaled = (values - distinct[0]) / (distinct[-1] - distinct[0])
    # Values that occur, so that a flight which is there twice does not move them.
    shares = np.linspace(0.0, 1.0, count - _DEGREE + 1)
    inner = np.unique(np.quantile(scaled, shares, method="inverted_cdf"))
    knots = np.concatenate([np.zeros(_DEGREE), inner, np.ones(_DEGREE)])
    found: Array = BSpline.design_matrix(scaled, knots, _DEGREE).toarray()
    return found


def _residual_products(functions: Array, figure: Array, of: Indices) -> Array:
    """Return each flight's residual times its prediction error by a fit without its sample.

    With the hat matrix H of the fit and e its residuals, the prediction errors of a sample are
    (I - H_cc)^-1 e_c, of the block of its flights. NaN for flights that only their own sample
    predicts.

    Parameters
    ----------
    functions : shape (n, p)
    figure : shape (n,)
    of : sample of each flight, shape (n,)
    """
    # Splines are near to orthogonal, so that their products keep the digits that a fit needs.
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
