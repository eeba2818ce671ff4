"""An estimate in words."""

import math
from collections.abc import Iterator

import numpy as np

from measurement.estimate.flight_log.analysis import Analysis
from measurement.estimate.flight_log.csv_file import LoggedFlight
from measurement.estimate.flight_log.gaps import found_gaps
from measurement.estimate.result import FscEstimate
from measurement.estimate.verdict import OPEN
from measurement.estimate.words import content_words, needed, next_step, verdict_words
from measurement.gases import ASSUMED_LEAST, FUEL_SULPHUR_MOST, GASES
from measurement.sniffer.sniffer import Readings
from measurement.sniffer.spec import SnifferSpec

ERRORS = {
    "calibration": "calibration of SO2 and CO2",
    "no": "correction for NO",
    "no2": "correction for NO2",
    "response": "response time and delay",
    "carbon": "carbon content of the fuel",
    "overlap": "passes that overlap",
    "sampling": "time between readings",
}
"""Common errors by name."""


def summary(analysis: Analysis, name: str) -> Iterator[str]:
    """Yield the lines of a summary of a flight called ``name``."""
    found, figures = analysis.estimate, analysis.estimate.figures
    passes = "1 pass" if figures.passes == 1 else f"{figures.passes} passes"
    every = f" every {figures.interval_s:.1f} s" if figures.passes > 1 else ""
    yield f"{name}, with: {analysis.instrument.title}"
    yield f"{figures.duration_s:.0f} s, {passes}{every}, CO2 signal to noise {figures.co2_snr:.0f}"
    yield result(found)
    if assumed := assumed_words(found.assumed_percent):
        yield assumed
    if math.isfinite(found.total_percent):
        yield f"standard uncertainty (1 sigma) {found.total_percent:.4f} %, of which"
        yield f"  noise {found.noise_percent:.4f}"
        for key, size in by_size(found):
            yield f"  {ERRORS.get(key, key)} {size:.4f}"
    yield f"quality {found.quality}" + (
        f": {'; '.join(found.quality_reasons)}" if found.quality_reasons else ""
    )
    for verdict in found.verdicts:
        chance = verdict.probability_above
        words = verdict_words(verdict.verdict, verdict.limit_percent, chance, found.quality)
        yield (
            f"{words}; {needed(chance)}"
            if verdict.verdict == OPEN and found.quality != "C"
            else words
        )
    told = {ERRORS.get(key, key): size for key, size in found.common_percent.items()}
    undecided = any(verdict.verdict == OPEN for verdict in found.verdicts)
    if step := next_step(
        found.quality,
        passes=figures.passes,
        undecided=undecided,
        noise=found.noise_percent,
        errors=told,
    ):
        yield step


def lacking(flight: LoggedFlight, analysis: Analysis) -> Iterator[str]:
    """Yield a line each on rows without a new reading, missing readings, gaps, and places that
    count as missing, if any.
    """
    gaps = found_gaps(flight.readings, analysis.estimate.signals, flight.about.readings)
    yield from (f"{what.lower()}: {words}" for what, words in gaps.told.items())
    if flight.about.place_remark:
        yield f"places: {flight.about.place_remark}"


def unused(readings: Readings, instrument: SnifferSpec) -> Iterator[str]:
    """Yield a line per gas that a flight has readings of, SO2 responds to, and the instrument has
    no channel for.
    """
    so2 = instrument.known("so2")
    for i, gas in enumerate(GASES):
        known = instrument.channel(gas) or not np.isfinite(readings.values[:, i]).any()
        if not known and (so2.cross.get(gas) or so2.cross_sd.get(gas)):
            yield f"{gas.upper()} is not used to correct SO2: '{instrument.name}' has no channel for it; add a table channels.{gas}"


def result(found: FscEstimate) -> str:
    """Return the result in words, with its 95 % interval."""
    if not found.total_percent <= FUEL_SULPHUR_MOST:
        return "fuel sulphur content: none can be given"
    return f"fuel sulphur content {content_words(found.fsc_percent, found.low_percent, found.high_percent)}"


def assumed_words(assumed_percent: float) -> str:
    """Return how much of a result corrects for NO and NO2 that were not measured [% m/m]; nothing
    if none of it does.
    """
    if not abs(assumed_percent) >= ASSUMED_LEAST:
        return ""
    return f"of it {assumed_percent:+.3f} % correct SO2 for NO and NO2 that the log does not have, as ships emit them on average"


def by_size(found: FscEstimate) -> list[tuple[str, float]]:
    """Return the common errors, the largest first."""
    return sorted(found.common_percent.items(), key=lambda item: -item[1])
