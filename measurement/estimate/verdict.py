"""Above a limit, below it, or open: by the probability that the fuel is above, with guard bands
(JCGM 106).

Probabilities and the interval are of one distribution: the normal one of content and standard
uncertainty, cut at 0, as no fuel has less. It is what a reading tells of a content of which nothing
else is known than that it is not negative (ISO 11929-1).
"""

import math
from dataclasses import dataclass
from typing import Literal

from scipy.special import log_ndtr, ndtr, ndtri, ndtri_exp

Side = Literal["above", "below", "open"]

ABOVE: Side = "above"
BELOW: Side = "below"
OPEN: Side = "open"

LIMITS_PERCENT = (0.10, 0.50)
"""MARPOL Annex VI, regulation 14: inside an emission control area and outside [% m/m]."""

CONFIDENCE = 0.95
"""Probability from which on a verdict is given."""

GUARD, COVERAGE = float(ndtri(CONFIDENCE)), float(ndtri(0.5 + 0.5 * CONFIDENCE))
"""Standard uncertainties of a guard band, 1.645, and of half an interval, 1.960."""


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """What is said of a limit.

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
    """Return the probability of a sulphur content above a limit [% m/m]: a normal distribution cut
    at 0, as no fuel has less.
    """
    if not (math.isfinite(fsc) and deviation > 0.0):
        return math.nan
    return math.exp(float(log_ndtr((fsc - limit) / deviation) - log_ndtr(fsc / deviation)))


def judged(limit: float, fsc: float, deviation: float, *, admitted: bool) -> Verdict:
    """Return the verdict on a limit.

    "above" asks for a reading beyond the limit by a guard band of 1.645 standard deviations, so
    that of fuels at the limit no more than 5 % are called above; "below" for a probability of at
    most 5 %. Without ``admitted`` the verdict is open.
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
    """Return the shortest interval that holds the sulphur content with 95 % [% m/m], of the
    distribution of ``probability_above``.

    Far from 0 it is the estimate with 1.960 standard uncertainties to either side. Where it begins
    at 0, the content is above its end with 5 % (ISO 11929-1, shortest coverage interval).
    """
    if not (math.isfinite(fsc) and deviation > 0.0):
        return (
            (math.nan, math.nan) if math.isnan(fsc + deviation) else (max(0.0, fsc), max(0.0, fsc))
        )
    kept = float(ndtr(fsc / deviation))
    half = deviation * float(ndtri(0.5 + 0.5 * CONFIDENCE * kept))
    if fsc > half:
        return fsc - half, fsc + half
    # In logarithms: of a reading far below 0 next to nothing of the normal distribution is left.
    beyond = math.log(1.0 - CONFIDENCE) + float(log_ndtr(fsc / deviation))
    return 0.0, fsc - deviation * float(ndtri_exp(beyond))
