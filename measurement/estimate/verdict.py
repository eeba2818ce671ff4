"""Verdicts on limits: probability that the fuel is above, guard bands (JCGM 106), and their words.

Probabilities and the interval are of one distribution: the normal one of content and standard
uncertainty, cut at 0, as no fuel has less. It describes a content of which nothing is known before
the reading but that it is not negative (ISO 11929-1).
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Literal

from scipy.special import log_ndtr, ndtr, ndtri, ndtri_exp

from measurement.gases import MASS_PERCENT, limit_words

Side = Literal["above", "below", "open"]

ABOVE: Side = "above"
BELOW: Side = "below"
OPEN: Side = "open"

LIMITS_PERCENT = (0.10, 0.50)
"""MARPOL Annex VI, regulation 14: inside an emission control area and outside [% m/m]."""

CONFIDENCE = 0.95
"""Least probability of a verdict."""

GUARD, COVERAGE = float(ndtri(CONFIDENCE)), float(ndtri(0.5 + 0.5 * CONFIDENCE))
"""Standard uncertainties of a guard band, 1.645, and of half an interval, 1.960."""

_REJECTED = "C"
"""Quality of records that have no verdict."""

_COUNTED = {
    ABOVE: "above the limit",
    BELOW: "below the limit",
    OPEN: "with an open verdict",
    _REJECTED: "without a verdict (quality C)",
}
"""Words for several records, by their verdict, or by the quality that has none."""


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """Verdict on a limit.

    Attributes
    ----------
    limit_percent : [% m/m]
    verdict : "above", "below" or "open"
    probability_above : that the fuel's sulphur content is above the limit, given the reading and
        that it is not negative
    """

    limit_percent: float
    verdict: Side
    probability_above: float


def probability_above(limit: float, fsc: float, deviation: float) -> float:
    """Return the probability of a sulphur content above a limit [% m/m]."""
    if not (math.isfinite(fsc) and deviation > 0.0):
        return math.nan
    return math.exp(float(log_ndtr((fsc - limit) / deviation) - log_ndtr(fsc / deviation)))


def judged(limit: float, fsc: float, deviation: float, *, admitted: bool) -> Verdict:
    """Return the verdict on a limit; it is open for a record that is not ``admitted``.

    "above" needs a reading beyond the limit by a guard band of 1.645 standard deviations, so that
    at most 5 % of the fuels at the limit are called above; "below" needs a probability of at most
    5 %.
    """
    probability = probability_above(limit, fsc, deviation)
    verdict = OPEN
    if admitted and math.isfinite(probability):
        if fsc > limit + GUARD * deviation:
            verdict = ABOVE
        elif probability < 1.0 - CONFIDENCE:
            verdict = BELOW
    return Verdict(limit_percent=limit, verdict=verdict, probability_above=probability)


def interval(fsc: float, deviation: float) -> tuple[float, float]:
    """Return the shortest interval that holds the sulphur content with 95 % [% m/m].

    Far from 0 it is the estimate with 1.960 standard uncertainties to either side. Where it begins
    at 0, the content is above its end with 5 % (ISO 11929-1, shortest coverage interval).
    """
    if math.isnan(fsc + deviation):
        return math.nan, math.nan
    if not (math.isfinite(fsc) and deviation > 0.0):
        return max(0.0, fsc), max(0.0, fsc)
    kept = float(ndtr(fsc / deviation))
    half = deviation * float(ndtri(0.5 + 0.5 * CONFIDENCE * kept))
    if fsc > half:
        return fsc - half, fsc + half
    # In logarithms, as almost nothing of the normal distribution is above 0 for a reading far
    # below it.
    beyond = math.log(1.0 - CONFIDENCE) + float(log_ndtr(fsc / deviation))
    return 0.0, fsc - deviation * float(ndtri_exp(beyond))


# Words, the same on consoles and in reports


def probability(share: float) -> str:
    """Return a probability in percent, never as certain."""
    if math.isnan(share):
        return "not known"
    if share > 0.999:
        return "more than 99.9 %"
    if share < 0.001:
        return "less than 0.1 %"
    return f"{100.0 * share:.1f} %"


def content_words(fsc_percent: float, low_percent: float, high_percent: float) -> str:
    """Return a sulphur content with its 95 % interval [% m/m]; below 0 with a remark."""
    content = f"{fsc_percent:z.3f}"
    interval = f"95 % interval {low_percent:z.3f} to {high_percent:z.3f} %"
    if float(content) < 0.0:
        return (
            f"{content} {MASS_PERCENT}, which is below 0; {interval}, given that no fuel has less"
            " than 0"
        )
    return f"{content} {MASS_PERCENT}, {interval}"


def verdict_words(
    verdict: str, limit_percent: float, probability_above: float, quality: str = "A"
) -> str:
    """Return a verdict with its limit and probability; for quality C, that there is no verdict.

    Parameters
    ----------
    limit_percent : [% m/m]
    probability_above : that the fuel's sulphur content is above the limit
    """
    limit = limit_words(limit_percent)
    if quality == _REJECTED:
        return f"no verdict on the limit of {limit}: quality {_REJECTED} gives none"
    side = "not shown to be above or below" if verdict == OPEN else verdict
    return f"{side} the limit of {limit}; probability above it: {probability(probability_above)}"


def needed(probability_above: float) -> str:
    """Return why a verdict is open."""
    if probability_above > CONFIDENCE:
        return "the result is within the guard band"
    return "95 % or 5 % are needed"


def next_step(
    quality: str,
    *,
    passes: int,
    undecided: bool,
    noise: float,
    errors: Mapping[str, float],
) -> str:
    """Return what to do for a record with an open verdict or none; otherwise an empty text.

    Parameters
    ----------
    undecided : whether a verdict is open
    noise, errors : standard uncertainty by noise, and by each error that further passes do not
        lower, by its words [% m/m]
    """
    if quality == _REJECTED and not passes:
        return "Next: check the CO2 sensor, and measure again in the plume."
    if quality == _REJECTED:
        return (
            "Next: correct the reason for quality C (record longer, if it is a short record); or"
            " analyse the parts of the log that are free of it as separate logs, each with a whole"
            " crossing of the plume; or measure again."
        )
    if not undecided:
        return ""
    largest = max(errors, key=lambda name: errors[name], default="")
    if not largest or noise > errors[largest]:
        return "Next: measure more passes: most of the uncertainty is noise, which falls with them."
    return (
        "Next: state this part of the uncertainty more narrowly, as by a calibration:"
        f" {largest}. Further passes do not lower it."
    )


def counted_verdicts(records: Iterable[tuple[str, str]]) -> str:
    """Return how many records have each verdict, given verdict and quality of each."""
    called = [quality if quality == _REJECTED else verdict for verdict, quality in records]
    return ", ".join(
        f"{called.count(verdict):,} {words}"
        for verdict, words in _COUNTED.items()
        if verdict in called
    )
