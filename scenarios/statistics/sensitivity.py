"""Sensitivity of a figure to the random variables: Borgonovo's delta and the first-order index.

Delta is half the mean distance between the figure's density and its density for a known input: 0 if
the input does not matter, 1 if it determines the figure, in whatever form. E. Borgonovo, "A new
uncertainty importance measure", Reliability Engineering & System Safety 92 (2007). The first-order
index S1 is the fraction of the figure's variance that the input explains by itself. Delta is
estimated by SALib from given data: E. Plischke, E. Borgonovo and C. L. Smith, "Global sensitivity
measures from given data", European Journal of Operational Research 226 (2013). S1 is not: within
SALib's classes of an input its mean is taken to be constant, so that a dominant input comes out too
low by more than its interval; ``first_order`` has no such classes.

In a finite sample the indices of an input without any effect are not 0. So the indices of some
random inputs without effect are estimated as well, and the largest of them is the noise floor.
Flights of one sample, as those at the points of a sweep are, have the same inputs and much the same
figure: they share the values of these random inputs, too, and are resampled together.
"""

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pandas as pd

from scenarios.statistics.first_order import first_order_index, functions_for

FLIGHTS_MIN = 200
"""Least number of flights: with fewer, the classes of an input hold fewer than 50 each, too few for
a density.
"""

FLIGHTS_MAX = 2000
"""Largest number of flights that are used, sampled at random from more: an index then takes a tenth
of a second.
"""

RESAMPLES = 20
"""Bootstrap samples for the interval of delta: they give its width to 16 %, 1/sqrt(2 19) for 20
values.
"""

DUMMIES = 5
"""Random inputs without effect: another one would exceed all of them one time in six."""

_GRID = 100
"""Number of points at which densities are compared, as in SALib."""

_CLASSES_MAX = 48
"""Largest number of classes of an input, as in SALib."""

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]


@dataclass(frozen=True, slots=True, kw_only=True)
class InputIndices:
    """Sensitivity of a figure to one input.

    Attributes
    ----------
    key : key of the input
    delta, first_order : the indices [-]
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
    flights : number of flights that were used
    known : number of flights that have the figure
    inputs : indices of the inputs, the largest delta first
    delta_floor, first_order_floor : the noise floors [-]; not a number without indices
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
    inputs : a row per flight, a column per input; numbers, or words, which are categories without
        an order
    figure : figure of each flight, shape (n,); flights where it is not a number are left out
    confidence : confidence of the intervals, between 0 and 1; that of delta is of a normal
        distribution with the bootstrap's deviation
    seed : seed of the choice of flights, the noise floor and the bootstrap
    samples : number of the sample that each flight is of, shape (n,); each is one of its own if not
        given
    """
    generator = np.random.default_rng(seed)
    known = np.flatnonzero(np.isfinite(figure))
    # In random order even if all are used: flights with equal inputs are put into classes by their
    # order.
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
    """Return the flights of the samples that were picked, by the sample that each flight is of."""
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
    # A spread near the limit of double precision is rounding, which has no density.
    if np.ptp(figure) <= 1e-12 * np.max(np.abs(figure)):
        return "the figure is the same in every flight"
    return ""


def _coded(values: "pd.Series[float]") -> Array:
    """Return an input as numbers, a different one for each category."""
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
    """Return the indices of one input, delta corrected for its bootstrap bias (Plischke et al., eq.
    30).
    """
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

    ``SALib.analyze.delta.analyze`` uses the same function. But its classes have equal size whatever
    the input, so that some hold two categories and an input of two categories loses a fifth of its
    index; and it uses numpy's global generator.

    Raises
    ------
    numpy.linalg.LinAlgError : the figure is the same everywhere
    """
    from SALib.analyze.delta import calc_delta

    grid = np.linspace(figure.min(), figure.max(), _GRID)
    with warnings.catch_warnings():
        # SALib warns of classes with a single figure, such as a rare category; they add nothing to
        # delta.
        warnings.simplefilter("ignore")
        return float(calc_delta(figure, grid, values, _class_bounds(values)))


def _class_bounds(values: Array) -> Array:
    """Return the number of flights below each class of an input, and of all flights: one class per
    value if there are few values, else classes of equal size, as many as SALib uses."""
    count = len(values)
    classes = min(
        math.ceil(count ** (2.0 / (7.0 + math.tanh((1500.0 - count) / 500.0)))), _CLASSES_MAX
    )
    _, of_each = np.unique(values, return_counts=True)
    if len(of_each) <= classes:
        return np.concatenate([[0.0], np.cumsum(of_each)])
    return np.linspace(0.0, count, classes + 1)
