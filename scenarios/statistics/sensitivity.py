"""Which inputs drive a figure: Borgonovo's delta and the first-order index, from the flights that a study has anyway.

Delta is half the mean distance between the figure's density and its density once the input is known: 0 where the input does not
matter, 1 where it says everything, of whatever form. E. Borgonovo, "A new uncertainty importance measure", Reliability Engineering
& System Safety 92 (2007). The first-order index S1 is the share of the figure's variance that the input explains by itself. Both
are estimated by SALib from given data: E. Plischke, E. Borgonovo and C. L. Smith, "Global sensitivity measures from given data",
European Journal of Operational Research 226 (2013).

Of a finite sample the indices of an input that does nothing are not 0. So some inputs that do nothing, drawn by lot, are estimated
along with the others, and the largest of their indices is the noise floor.
"""

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pandas as pd

FLIGHTS_MIN = 200
"""With fewer flights the classes of an input hold less than 50 of them, too few for a density."""

FLIGHTS_MAX = 2000
"""So many flights are looked at, drawn by lot from more: an index takes a tenth of a second then, and so much more with more."""

RESAMPLES = 20
"""Bootstrap samples for the interval of an index, whose width is known to 16 % then: a deviation from 20 values, 1/sqrt(2 19)."""

DUMMIES = 5
"""Inputs that do nothing: another such would rise above all of them one time in six."""

_GRID = 100
"""Points that densities are compared at: SALib's."""

_CLASSES_MAX = 48
"""Classes of an input: SALib's."""

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]


@dataclass(frozen=True, slots=True, kw_only=True)
class InputIndices:
    """How one input drives a figure.

    Attributes
    ----------
    key : of the input
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
    """What drives a figure.

    Attributes
    ----------
    flights : number that was looked at
    known : number that has the figure
    inputs : those that have indices, the largest delta first
    delta_floor, first_order_floor : the noise floors [-]; not a number without indices
    left_out : why other inputs have none
    message : why no input has; empty if some do
    """

    flights: int
    known: int
    inputs: tuple[InputIndices, ...]
    delta_floor: float
    first_order_floor: float
    left_out: dict[str, str]
    message: str


def sensitivity_indices(inputs: pd.DataFrame, figure: Array, *, confidence: float, seed: int) -> Sensitivity:
    """Estimate which inputs drive a figure.

    Parameters
    ----------
    inputs : a row per flight, a column per input; figures, or words, which are taken as categories without an order
    figure : of each flight, shape (n,); flights where it is not a number are left out
    confidence : of the intervals, between 0 and 1: of a normal distribution with the bootstrap's deviation
    seed : of the flights that are looked at, the noise floor and the bootstrap
    """
    generator = np.random.default_rng(seed)
    known = np.flatnonzero(np.isfinite(figure))
    # In a random order even if all are taken: flights with equal inputs go into classes by their order.
    chosen = generator.permutation(known)[:FLIGHTS_MAX]
    left_out = {str(key): why for key in inputs if (why := _unusable(inputs[key].iloc[chosen]))}
    codes = {str(key): _coded(inputs[key].iloc[chosen]) for key in inputs if key not in left_out}
    found: list[InputIndices] = []
    dummies: list[InputIndices] = []
    message = _nothing_to_say(figure[chosen], codes)
    if not message:
        resamples = [generator.integers(len(chosen), size=len(chosen)) for _ in range(RESAMPLES)]
        nothing = [generator.random(len(chosen)) for _ in range(DUMMIES)]
        try:
            found = [_indices(key, values, figure[chosen], resamples, confidence) for key, values in codes.items()]
            dummies = [_indices("", values, figure[chosen], resamples, confidence) for values in nothing]
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


def _unusable(values: "pd.Series[float]") -> str:
    """Return why an input has no index, or nothing if it can have one."""
    if values.isna().any():
        return "not drawn for every flight"
    return "the same in every flight" if values.nunique() < 2 else ""


def _nothing_to_say(figure: Array, inputs: dict[str, Array]) -> str:
    if len(figure) < FLIGHTS_MIN:
        return f"{len(figure)} flights have this figure; indices take {FLIGHTS_MIN} at least"
    if not inputs:
        return "no input differs between flights"
    # A spread at the limit of double precision is rounding, of which no density can be made.
    if np.ptp(figure) <= 1e-12 * np.max(np.abs(figure)):
        return "the figure is the same in every flight"
    return ""


def _coded(values: "pd.Series[float]") -> Array:
    """Return an input as figures, each category's another one."""
    coded = values if pd.api.types.is_numeric_dtype(values) else pd.factorize(values.astype(str))[0]
    return np.asarray(coded, dtype=np.float64)


def _indices(key: str, values: Array, figure: Array, resamples: Sequence[Indices], confidence: float) -> InputIndices:
    """Return the indices of one input: delta without the bias that its bootstrap shows (Plischke et al., eq. 30), S1 as it is."""
    from scipy.stats import norm

    delta, first_order = _estimated(values, figure)
    again = np.array([_estimated(values[chosen], figure[chosen]) for chosen in resamples])
    delta_error, first_order_error = norm.ppf(0.5 + 0.5 * confidence) * again.std(axis=0, ddof=1)
    return InputIndices(
        key=key,
        delta=2.0 * delta - float(again[:, 0].mean()),
        delta_error=float(delta_error),
        first_order=first_order,
        first_order_error=float(first_order_error),
    )


def _estimated(values: Array, figure: Array) -> tuple[float, float]:
    """Return SALib's estimates of delta and S1 (Plischke et al., eq. 26 and below).

    ``SALib.analyze.delta.analyze`` is made of the same two functions. It takes classes of equal size whatever the input, so that
    some hold two categories and an input of two loses a fifth of its indices; and it draws from numpy's global generator.

    Raises
    ------
    numpy.linalg.LinAlgError : the figure is the same everywhere
    """
    from SALib.analyze.delta import calc_delta, sobol_first

    grid = np.linspace(figure.min(), figure.max(), _GRID)
    bounds = _class_bounds(values)
    with warnings.catch_warnings():
        # Of classes that hold one figure alone, such as a category's that is rare: it adds nothing to delta.
        warnings.simplefilter("ignore")
        return float(calc_delta(figure, grid, values, bounds)), float(sobol_first(figure, values, bounds))


def _class_bounds(values: Array) -> Array:
    """Return how many flights lie below each class of an input, and how many there are: one class per value if it has few values,
    else of equal size, as many as SALib takes."""
    count = len(values)
    classes = min(math.ceil(count ** (2.0 / (7.0 + math.tanh((1500.0 - count) / 500.0)))), _CLASSES_MAX)
    _, of_each = np.unique(values, return_counts=True)
    if len(of_each) <= classes:
        return np.concatenate([[0.0], np.cumsum(of_each)])
    return np.linspace(0.0, count, classes + 1)
