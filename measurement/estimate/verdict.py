"""Verdicts on limits, and rules by which ships are reported, with guard bands, error rates and
texts.

Guard bands are those of JCGM 106 (2012), "The role of measurement uncertainty in conformity
assessment". A verdict that is looked at repeatedly needs wider ones: ``repeated``.

Probabilities and the interval follow from one distribution: the normal distribution of the content
with its standard uncertainty, truncated at 0, as no content is negative. This is the distribution
without any prior knowledge except that the content is not negative (ISO 11929-1).
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any, Literal, TypeVar

from scipy.special import log_ndtr, ndtr, ndtri, ndtri_exp

from measurement.gases import MASS_PERCENT, limit_words
from measurement.rules import DecisionRule

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

MISSED_OVER_LIMIT = 2.0
"""Content for which the misses of a rule are stated, over the limit [-]."""

_FAR = 1000.0
"""Number of deviations beyond which a normal distribution's asymptotic forms are used [-]."""

REJECTED = "C"
"""Quality of records without a verdict."""

_COUNTED = {
    ABOVE: "above the limit",
    BELOW: "below the limit",
    OPEN: "with an open verdict",
    REJECTED: "without a verdict (quality C)",
}
"""Texts for several records, by their verdict, or by the quality without a verdict."""


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """Verdict on the limit of a figure, in the unit of the figure: % m/m for a sulphur content.

    Attributes
    ----------
    limit : limit of the figure
    verdict : "above", "below" or "open"
    probability_above : that the figure is above the limit, given the reading and that it is not
        negative
    above_from, below_to : estimates beyond which the verdict is "above" and "below" with this
        standard uncertainty
    false_alarm, miss : shares of ships at the limit that one look calls above and below [-]
    """

    limit: float
    verdict: Side
    probability_above: float
    above_from: float = math.nan
    below_to: float = math.nan
    false_alarm: float = math.nan
    miss: float = math.nan

    @property
    def limit_percent(self) -> float:
        """Limit of a sulphur content [% m/m]."""
        return self.limit

    @property
    def above_from_percent(self) -> float:
        """Sulphur content from which the verdict is "above" [% m/m]."""
        return self.above_from

    @property
    def below_to_percent(self) -> float:
        """Sulphur content up to which the verdict is "below" [% m/m]."""
        return self.below_to

    def percent_record(self) -> dict[str, Any]:
        """Return the verdict on a sulphur content for JSON, with the unit in its names."""
        in_percent = ("limit", "above_from", "below_to")
        return {
            f"{name}_percent" if name in in_percent else name: value
            for name, value in asdict(self).items()
        }


@dataclass(frozen=True, kw_only=True)
class Decision:
    """The decision of a rule on an estimate.

    Attributes
    ----------
    rule, title, limit_percent : of the rule
    suspect_from_percent : estimate from which the ship is suspect [% m/m]
    suspect : whether the ship is suspect; None for a record without a verdict
    false_alarm : share of fuels at the limit that the rule reports, with this uncertainty [-]
    missed_percent : content for which ``miss`` is stated [% m/m]
    miss : share of fuels of that content that the rule does not report [-]
    """

    rule: str
    title: str
    limit_percent: float
    suspect_from_percent: float
    suspect: bool | None
    false_alarm: float
    missed_percent: float
    miss: float


_Recorded = TypeVar("_Recorded", Verdict, Decision)


def from_record(kind: type[_Recorded], record: Mapping[str, Any]) -> _Recorded:
    """Return a verdict on a sulphur content, or a decision, from its record in JSON, where NaN is
    None.
    """
    names = {field.name for field in fields(kind)}
    values: dict[str, Any] = {
        name if name in names else name.removesuffix("_percent"): (
            math.nan if value is None and name != "suspect" else value
        )
        for name, value in record.items()
    }
    return kind(**values)


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
    if not deviation > 0.0 or not math.isfinite(deviation):
        return Verdict(limit=limit, verdict=verdict, probability_above=probability)
    below = _below_to(limit, deviation)
    return Verdict(
        limit=limit,
        verdict=verdict,
        probability_above=probability,
        above_from=limit + GUARD * deviation,
        below_to=below,
        false_alarm=float(ndtr(-GUARD)),
        miss=float(ndtr((below - limit) / deviation)),
    )


def _below_to(limit: float, deviation: float) -> float:
    """Return the estimate for which the content is above the limit with 5 % probability [% m/m].

    With r deviations from 0 to the limit it lies x deviations below the limit, where Phi(-x) = 5 %
    Phi(r - x). The right side is at most 5 %, so that x is at least 1.645.
    """
    from scipy.optimize import brentq

    reach = min(limit / deviation, _FAR)
    tolerated = -math.log(1.0 - CONFIDENCE)
    if reach < 1.0 / _FAR:
        # Far below 0 the content is exponential, with the mean deviation/(x - r).
        return limit - deviation * (0.5 * reach + tolerated / reach)

    def excess(below: float) -> float:
        return tolerated + float(log_ndtr(-below) - log_ndtr(reach - below))

    most = GUARD + reach + 4.0 / reach
    return limit - deviation * float(brentq(excess, GUARD - 1e-9, most))


def decide(rule: DecisionRule, fsc: float, deviation: float, *, admitted: bool) -> Decision:
    """Return the decision of a rule on an estimate with its standard uncertainty [% m/m].

    Parameters
    ----------
    admitted : whether the quality of the record admits a verdict
    """
    suspect_from = rule.suspect_percent
    if suspect_from is None:
        suspect_from = rule.limit_percent + GUARD * deviation
    missed = MISSED_OVER_LIMIT * rule.limit_percent
    known = math.isfinite(fsc) and deviation > 0.0
    return Decision(
        rule=rule.name,
        title=rule.title,
        limit_percent=rule.limit_percent,
        suspect_from_percent=suspect_from,
        suspect=fsc >= suspect_from if admitted and known else None,
        false_alarm=float(ndtr((rule.limit_percent - suspect_from) / deviation))
        if known
        else math.nan,
        missed_percent=missed,
        miss=float(ndtr((suspect_from - missed) / deviation)) if known else math.nan,
    )


def interval(fsc: float, deviation: float) -> tuple[float, float]:
    """Return the shortest interval that holds the sulphur content with 95 % [% m/m].

    Far from 0 it is the estimate with 1.960 standard uncertainties to either side. Where it begins
    at 0, the content is above its end with 5 % probability (ISO 11929-1, shortest coverage
    interval).
    """
    if math.isnan(fsc + deviation):
        return math.nan, math.nan
    if not (math.isfinite(fsc) and deviation > 0.0):
        return max(0.0, fsc), max(0.0, fsc)
    kept = float(ndtr(fsc / deviation))
    half = deviation * float(ndtri(0.5 + 0.5 * CONFIDENCE * kept))
    if fsc > half:
        return fsc - half, fsc + half
    # In logarithms, because almost nothing of the normal distribution is above 0 for a reading far
    # below 0.
    beyond = math.log(1.0 - CONFIDENCE) + float(log_ndtr(fsc / deviation))
    return 0.0, fsc - deviation * float(ndtri_exp(beyond))


# Words, the same on consoles and in reports


def probability(share: float) -> str:
    """Return a probability in percent, never 0 or 100 %."""
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
    """Return a verdict with its limit and probability; for quality C, a text that there is no
    verdict.

    Parameters
    ----------
    limit_percent : [% m/m]
    probability_above : that the fuel's sulphur content is above the limit
    """
    limit = limit_words(limit_percent)
    if quality == REJECTED:
        return f"no verdict on the limit of {limit}: quality {REJECTED} gives none"
    side = "not shown to be above or below" if verdict == OPEN else verdict
    return f"{side} the limit of {limit}; probability above it: {probability(probability_above)}"


def repeated_words(looks: float, guard: float) -> str:
    """Return the number of looks at a verdict and the resulting guard band; empty without repeated
    looks.
    """
    if not looks > 0 or math.isnan(guard):
        return ""
    return (
        f"; by {looks:.0f} look{'s' * (looks > 1)}, the last of which needed {guard:.2f} standard"
        " uncertainties from the limit"
    )


def rate_words(verdict: Verdict) -> str:
    """Return the estimates at which verdicts begin, and their error rates for a fuel at the
    limit.
    """
    if math.isnan(verdict.false_alarm):
        return "no guard band: the uncertainty is not known"
    above, below = probability(verdict.false_alarm), probability(verdict.miss)
    return (
        f"guard band: above from {verdict.above_from_percent:.3f} %, below to"
        f" {verdict.below_to_percent:z.3f} %; of fuels at the limit {above} are called above and"
        f" {below} below"
    )


def suspect_words(suspect: float | None, false_alarm: float, miss: float) -> str:
    """Return whether a flight's rule reports the ship, with the rule's error rates; empty without a
    rule.

    Parameters
    ----------
    suspect : true or false; None or NaN without a rule, or for a record of quality C
    """
    if suspect is None or math.isnan(suspect) or math.isnan(false_alarm):
        return ""
    return (
        f"{'suspect' if suspect else 'not suspect'} by the rule of the flight, which reports"
        f" {probability(false_alarm)} of fuels at its limit and misses {probability(miss)} of fuels"
        f" of {MISSED_OVER_LIMIT:g} times that"
    )


def decision_words(decision: Decision) -> str:
    """Return the decision of a rule on an estimate, and the rule's error rates."""
    called = {True: "suspect", False: "not suspect", None: "no decision"}[decision.suspect]
    words = (
        f"rule {decision.rule} ({decision.title}), suspect from"
        f" {decision.suspect_from_percent:.3f} % on: {called}"
    )
    if math.isnan(decision.false_alarm):
        return words
    return (
        f"{words}; with this uncertainty it reports {probability(decision.false_alarm)} of fuels at"
        f" the limit of {limit_words(decision.limit_percent)} and misses"
        f" {probability(decision.miss)} of fuels of {limit_words(decision.missed_percent)}"
    )


def needed(probability_above: float) -> str:
    """Return the reason why a verdict is open."""
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
    """Return advice for a record with an open verdict or without one; otherwise an empty text.

    Parameters
    ----------
    undecided : whether a verdict is open
    noise, errors : standard uncertainty by noise, and by each error that further passes do not
        reduce, by its name [% m/m]
    """
    if quality == REJECTED and not passes:
        return "Next: check the CO2 sensor, and measure again in the plume."
    if quality == REJECTED:
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
    """Return the number of records with each verdict, given verdict and quality of each."""
    called = [quality if quality == REJECTED else verdict for verdict, quality in records]
    return ", ".join(
        f"{called.count(verdict):,} {words}"
        for verdict, words in _COUNTED.items()
        if verdict in called
    )
