"""The answer to a search for the plume: in how many flights it was found, how soon, and how often
it was hit, beside flights that were told where it is and those that stayed at the predicted height.
"""

import numpy as np

from reports.document.blocks import Card
from reports.finding.tables import hits_words, seconds_words
from reports.finding.variants import Variant, searching_variants
from reports.run.columns import flights_flown
from reports.run.run_data import RunData

_ANSWER = (
    "Plume found in {found:,} of {flown:,} flights, median {median} s; passes that hit: {hits}"
)


def search_answer(run: RunData) -> str:
    """Return in how many flights the plume was found, how soon, and the share of passes that hit in
    each variant; no word of a run that does not search in several flights.
    """
    variants = searching_variants(run)
    if not variants:
        return ""
    own, *others = variants
    shares = [hits_words(own), *(f"{of.name} {hits_words(of)}" for of in others)]
    return _ANSWER.format(
        found=own.found, flown=_flown(run), median=_median(own), hits=", ".join(shares)
    )


def search_cards(run: RunData) -> list[Card]:
    """Return the tiles of a search."""
    variants = searching_variants(run)
    if not variants:
        return []
    own, *others = variants
    flown = _flown(run)
    criterion = run.verdict.whole.criterion("time_to_find_s")
    judged = (f"within {criterion.limits[0]:g} s", criterion.met) if criterion.judged else ()
    beside = ", ".join(f"{of.name} {hits_words(of)}" for of in others)
    return [
        Card("Flights that found the plume", f"{own.found:,} of {flown:,}", *judged),
        Card(
            "Time to find it, median",
            f"{_median(own)} s",
            note=f"95 % quantile {seconds_words(own.latest)} s",
        ),
        Card("Passes that hit it, once found", hits_words(own), note=beside),
    ]


def _flown(run: RunData) -> int:
    return len(flights_flown(run.summary))


def _median(variant: Variant) -> str:
    return seconds_words(float(np.median(variant.times)))
