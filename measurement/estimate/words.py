"""The verdict on a limit in words, the same on consoles and in reports."""

import math
from collections.abc import Iterable, Mapping

from measurement.estimate.result import Quality
from measurement.estimate.verdict import ABOVE, BELOW, CONFIDENCE, OPEN
from measurement.gases import MASS_PERCENT, limit_words

_WITHOUT = "C"
"""Quality of records that are given no verdict."""

_COUNTED = {
    ABOVE: "above the limit",
    BELOW: "below the limit",
    OPEN: "with an open verdict",
    _WITHOUT: "without a verdict (quality C)",
}
"""What is said of several records, by their verdict, or by the quality that gives none."""


def probability(share: float) -> str:
    """Return a probability in percent, never as certain."""
    if math.isnan(share):
        return "not known"
    return (
        "more than 99.9 %"
        if share > 0.999
        else "less than 0.1 %"
        if share < 0.001
        else f"{100.0 * share:.1f} %"
    )


def content_words(fsc_percent: float, low_percent: float, high_percent: float) -> str:
    """Return a sulphur content with its 95 % interval; of one below 0 that no fuel has less.

    Parameters
    ----------
    fsc_percent, low_percent, high_percent : the estimate, and the interval that its verdict rests
        on [% m/m]
    """
    content, interval = (
        f"{fsc_percent:z.3f}",
        f"95 % interval {low_percent:z.3f} to {high_percent:z.3f} %",
    )
    if float(content) < 0.0:
        return f"{content} {MASS_PERCENT}, which is below 0; {interval}, given that no fuel has less than 0"
    return f"{content} {MASS_PERCENT}, {interval}"


def verdict_words(
    verdict: str, limit_percent: float, probability_above: float, quality: Quality | str = "A"
) -> str:
    """Return a verdict with its limit and probability; for a record of quality C, that there is no
    verdict.

    Parameters
    ----------
    verdict : "above", "below" or "open"
    limit_percent : [% m/m]
    probability_above : that the fuel's sulphur content is above the limit
    quality : of the record
    """
    limit = limit_words(limit_percent)
    if quality == _WITHOUT:
        return f"no verdict on the limit of {limit}: quality {_WITHOUT} gives none"
    side = "not shown to be above or below" if verdict == OPEN else verdict
    return f"{side} the limit of {limit}; probability above it: {probability(probability_above)}"


def needed(probability_above: float) -> str:
    """Return what an open verdict needs to be none."""
    return (
        "the result is within the guard band"
        if probability_above > CONFIDENCE
        else "95 % or 5 % are needed"
    )


def next_step(
    quality: Quality | str,
    *,
    passes: int,
    undecided: bool,
    noise: float,
    errors: Mapping[str, float],
) -> str:
    """Return what to do where a record has no verdict, or one that is open; no word of another.

    Parameters
    ----------
    quality, passes : of the record
    undecided : whether a verdict is open
    noise, errors : standard uncertainty by noise, and by each error that further passes leave as it
        is, by its words [% m/m]
    """
    if quality == _WITHOUT and not passes:
        return "Next: check the CO2 sensor, and measure again in the plume."
    if quality == _WITHOUT:
        return (
            "Next: correct what the reason for quality C names, or record longer where it is that the record is short; or analyse"
            " apart, as logs of their own, those parts of the log that are free of it, each with a whole crossing of the plume; or"
            " measure again."
        )
    if not undecided:
        return ""
    largest = max(errors, key=lambda name: errors[name], default="")
    if not largest or noise > errors[largest]:
        return "Next: measure more passes: most of the uncertainty is noise, which falls with them."
    return f"Next: state this part of the uncertainty more narrowly, as by a calibration: {largest}. Further passes do not lower it."


def counted_verdicts(records: Iterable[tuple[str, str]]) -> str:
    """Return how many of several records were called what.

    Parameters
    ----------
    records : verdict and quality of each
    """
    called = [quality if quality == _WITHOUT else verdict for verdict, quality in records]
    return ", ".join(
        f"{called.count(verdict):,} {words}"
        for verdict, words in _COUNTED.items()
        if verdict in called
    )
