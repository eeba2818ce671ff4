"""The verdict on a measured fuel in words that say probability and limit."""

from typing import Any

from measurement.estimate.verdict import (
    BELOW,
    OPEN,
    Decision,
    content_words,
    decision_words,
    from_record,
    next_step,
    probability,
    verdict_words,
)
from measurement.gases import FUEL_SULPHUR_MOST, MASS_PERCENT, limit_words
from reports.document.blocks import Card, FuelCard, UndecidedCard, Verdict
from reports.document.tables import number
from reports.measurement.data import WORDS, Record, errors, value

CONTENT_NAME = "Fuel sulphur content"
"""Name of the tile of a result."""


def measurement_verdict(record: Record) -> Verdict:
    """Judge by the lowest limit: it fails where the fuel is above, and is not complete where that
    is open.
    """
    found = record["estimate"]
    verdicts = sorted(found["verdicts"], key=lambda verdict: float(verdict["limit_percent"]))
    first = verdicts[0]
    reasons = [str(reason) for reason in found["quality_reasons"]]
    known = _known(found)
    others = (
        [f"{sentence(other, found['quality'], known=True)}." for other in verdicts[1:]]
        if known
        else []
    )
    return Verdict(
        holds=first["verdict"] != "above",
        complete=first["verdict"] == "below",
        headline=sentence(first, found["quality"], known=known),
        detail=" ".join(
            filter(None, [_result(record), *others, _decision(record), _next_step(found)])
        ),
        failures=[f"quality {found['quality']}: {reason}" for reason in reasons],
        figures=_figures(record),
    )


def sentence(verdict: dict[str, Any], quality: str, *, known: bool) -> str:
    """Return a verdict in words; there is none without a result, or with quality C."""
    limit = float(verdict["limit_percent"])
    if not known:
        return f"Nothing can be said of the limit of {limit_words(limit)}: there is no result"
    words = verdict_words(verdict["verdict"], limit, value(verdict, "probability_above"), quality)
    return f"{words[0].upper()}{words[1:]}"


def _next_step(found: Record) -> str:
    parts = {name: size for name, size in errors({"estimate": found}) if name != WORDS["noise"]}
    return next_step(
        found["quality"],
        passes=int(found["figures"]["passes"]),
        undecided=any(verdict["verdict"] == OPEN for verdict in found["verdicts"]),
        noise=value(found, "noise_percent"),
        errors=parts,
    )


def _result(record: Record) -> str:
    found, figures = record["estimate"], record["estimate"]["figures"]
    if not _known(found):
        return "No fuel sulphur content can be given."
    passes = "1 pass" if figures["passes"] == 1 else f"{figures['passes']} passes"
    content = content_words(
        value(found, "fsc_percent"), value(found, "low_percent"), value(found, "high_percent")
    )
    return (
        f"Fuel sulphur content {content}, from {passes} in {figures['duration_s']:.0f} s. Quality"
        f" {found['quality']}."
    )


def _decision(record: Record) -> str:
    """Return what the rule makes of the result, if there is a rule and a result."""
    decision = record.get("decision")
    if not decision or not _known(record["estimate"]):
        return ""
    words = decision_words(from_record(Decision, decision))
    return f"{words[0].upper()}{words[1:]}."


def _known(found: Record) -> bool:
    """Return whether there is a result: one that is less sure than any fuel has sulphur is none."""
    return found["fsc_percent"] is not None and value(found, "total_percent") <= FUEL_SULPHUR_MOST


def _interval(found: Record) -> str:
    return f"{value(found, 'low_percent'):.3f} to {value(found, 'high_percent'):.3f} {MASS_PERCENT}"


def _short(share: float) -> str:
    return probability(share).replace("more than", ">").replace("less than", "<")


def fuel_card(limit_percent: float, side: str, probability_above: float, quality: str) -> Card:
    """Return the tile of a limit: how probable it is that the fuel is above it, and the verdict if
    there is one.
    """
    limit = limit_words(limit_percent)
    name = f"Probability above the limit of {limit}"
    if quality == "C":
        return Card(name, "no verdict: quality C")
    chance = _short(probability_above)
    return (
        UndecidedCard(name, chance, limit)
        if side == OPEN
        else FuelCard(name, chance, limit, side == BELOW)
    )


def _chance(verdict: Record, quality: str) -> Card:
    return fuel_card(
        float(verdict["limit_percent"]),
        verdict["verdict"],
        value(verdict, "probability_above"),
        quality,
    )


def _figures(record: Record) -> list[Card]:
    found = record["estimate"]
    chances = [_chance(verdict, found["quality"]) for verdict in found["verdicts"]]
    without = "none: quality C" if found["quality"] == "C" else "not reached"
    times = [
        Card(
            f"Time to a verdict on {limit_words(float(limit))}",
            without if seconds is None else f"{float(seconds):.0f} s",
        )
        for limit, seconds in record["time_to_verdict_s"].items()
    ]
    true = record.get("true_percent")
    return [
        Card(
            CONTENT_NAME,
            number(found["fsc_percent"] if _known(found) else None, f"{{:.3f}} {MASS_PERCENT}"),
            note=f"95 % interval {_interval(found)}" if _known(found) else "",
        ),
        *chances,
        Card("Quality", str(found["quality"])),
        *times,
        *(
            []
            if true is None
            else [Card("A perfect instrument reads", number(true, f"{{:.3f}} {MASS_PERCENT}"))]
        ),
        Card("CO2 signal to noise", number(found["figures"]["co2_snr"], "{:.0f}")),
    ]
