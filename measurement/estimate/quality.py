"""Quality class of a record, and the reasons that make an estimate from it unreliable."""

import math
from collections.abc import Sequence

from measurement.estimate.fit import Residuals
from measurement.estimate.result import Quality
from measurement.estimate.timing import DELAY_MOST
from measurement.gases import MASS_PERCENT
from measurement.species import SPECIES, Species

SNR_GOOD = 20.0
"""Signal to noise of CO2 for class A."""

UNCERTAINTY_GOOD = 0.2
"""Largest standard uncertainty for class A, relative to the lowest limit."""

PASSES_GOOD = 3
"""Passes for class A."""

AGREEMENT_LEAST = 0.05
"""Least probability for class A that passes of one fuel differ as much as these."""

STRANGE_SIGMA = 4.0
"""Largest difference of residuals or a property from the stated instrument [standard
deviations].
"""

_ARRIVED_SIGMA, _ARRIVED_SHARE = 3.0, 0.5
"""Least result that shows that SO2 has arrived [standard uncertainties]; otherwise, least share of
the CO2 whose SO2 would have been read by then.
"""

_NEGATIVE_SIGMA = 3.0
"""Largest distance of a result below 0, or above the largest content of a fuel [standard
uncertainties].
"""

_DIGITS_MOST = 8
"""Decimals to which an uncertainty is printed at most, so that it differs from what it exceeds."""


def quality_class(
    *,
    problems: Sequence[str],
    snr: float,
    passes: int,
    fsc: float,
    deviation: float,
    agreement: float,
    limit: float | None,
    responses_stated: bool,
    species: Species = SPECIES["so2"],
) -> tuple[Quality, tuple[str, ...]]:
    """Return the quality class, and the reasons why it is not A.

    Parameters
    ----------
    problems : of the record; each of them makes the class C
    snr, passes : of CO2, median of the passes, and their number
    fsc, deviation : result and its standard uncertainty [unit of the gas's figure]
    agreement : probability that passes of one fuel differ as much
    limit : lowest limit; None for a gas without one: then the uncertainty is compared with the
        result
    responses_stated : whether the response of the SO2 channel to NO and NO2 is known
    species : gas that is compared with CO2
    """
    rejected = [*problems, *_impossible(passes, fsc, deviation, species)]
    if rejected:
        return "C", tuple(rejected)
    reasons = []
    if snr < SNR_GOOD:
        reasons.append(f"CO2 signal to noise is {snr:.1f}; class A needs {SNR_GOOD:g}")
    good = UNCERTAINTY_GOOD * (abs(fsc) if limit is None else limit)
    if deviation > good:
        why = ", as the response of SO2 to NO and NO2 is not stated (cross)"
        digits = species.digits
        while f"{deviation:.{digits}f}" == f"{good:.{digits}f}" and digits < _DIGITS_MOST:
            digits += 1
        reasons.append(
            f"standard uncertainty is {deviation:.{digits}f} {_unit(species)}"
            f"{'' if responses_stated else why}; class A needs {good:.{digits}f} {_unit(species)}"
        )
    if passes < PASSES_GOOD:
        counted = "1 pass" if passes == 1 else f"{passes} passes"
        reasons.append(f"{counted} through the plume; class A needs {PASSES_GOOD}")
    if math.isfinite(agreement) and agreement < AGREEMENT_LEAST:
        reasons.append(
            f"passes differ more than their noise explains (p = {agreement:.1g};"
            f" class A needs {AGREEMENT_LEAST:g})"
        )
    return ("B" if reasons else "A"), tuple(reasons)


def _printed(value: float, species: Species) -> str:
    """Return a figure of a gas in the format of its limits; a sulphur content in plain %."""
    return f"{value:.{species.digits}f} {_unit(species)}"


def _unit(species: Species) -> str:
    return "%" if species.result == MASS_PERCENT else species.result


def _impossible(passes: int, value: float, deviation: float, species: Species) -> list[str]:
    """Return the reason why no fuel can have this result."""
    found, gas = [], species.title
    most = f"{species.most:g} {_unit(species)}"
    if passes and not math.isfinite(value):
        found.append("the CO2 excess is not above its noise")
    if math.isfinite(value) and value < -_NEGATIVE_SIGMA * deviation:
        found.append(
            f"the result is {_printed(value, species)}, negative by more than"
            f" {_NEGATIVE_SIGMA:g} standard uncertainties: check the corrections"
        )
    if deviation > species.most:
        found.append(
            f"the standard uncertainty is {deviation:.0f} {_unit(species)}, and no fuel has above"
            f" {most}: {gas} does not follow CO2; check its sign and its sensor"
        )
    elif math.isfinite(value) and value - _NEGATIVE_SIGMA * deviation > species.most:
        found.append(
            f"the result is {value:.1f} {_unit(species)}, and no fuel has above {most}:"
            f" check the units of {gas} and CO2"
        )
    return found


def residual_problem(residuals: Residuals, others: float) -> tuple[str, ...]:
    """Return the problem of residuals that noise and the instrument's uncertainty do not explain.

    Parameters
    ----------
    residuals : of the fit
    others : sum of squares by one standard deviation of each property that ``residuals`` do not
        include
    """
    instrument = STRANGE_SIGMA**2 * (residuals.instrument + others)
    expected = residuals.noise + residuals.background + instrument
    if residuals.energy <= expected * _chance(residuals) or residuals.noise == 0.0:
        return ()
    return (
        f"residuals are {math.sqrt(residuals.misfit):.1f} times the noise, more than the stated"
        " uncertainty of the instrument explains: check its response, delay, noise and other gases",
    )


def noise_explains(residuals: Residuals) -> bool:
    """Return whether noise and background alone explain the residuals."""
    return residuals.energy <= (residuals.noise + residuals.background) * _chance(residuals)


def _chance(residuals: Residuals) -> float:
    """Return the ratio to their expectation that residuals may reach by chance [-]."""
    # A sum of squares with n degrees of freedom has a relative standard deviation of sqrt(2/n).
    return 1.0 + STRANGE_SIGMA * math.sqrt(2.0 / residuals.freedom)


def pending_problem(
    gas: str, value: float, deviation: float, read: Sequence[float], doses: Sequence[float]
) -> tuple[str, ...]:
    """Return the problem of a gas that may not have arrived yet, where its delay is not stated.

    Parameters
    ----------
    gas : its name, in words
    value, deviation : result and its standard uncertainty, in the same unit
    read : for each pass, share that was read of the time in which its gas may arrive [-]
    doses : of CO2 in each pass [ppm s]
    """
    if not read or value > _ARRIVED_SIGMA * deviation:
        return ()
    followed = sum(share * dose for share, dose in zip(read, doses, strict=True))
    if followed >= _ARRIVED_SHARE * sum(doses):
        return ()
    return (
        f"{gas} does not stand out, and may still come: its delay is not stated, and may be up to"
        f" {DELAY_MOST:g} s; state it, or record longer after the passes",
    )


def delay_problem(gas: str, stated: float, shown: float, deviation: float) -> tuple[str, ...]:
    """Return the problem of a delay of a gas after CO2 that is not the stated one.

    Parameters
    ----------
    gas : its name, in words
    stated, shown : delay by the instrument's figures, and the one that fits the readings best [s]
    deviation : standard deviation of the difference [s]
    """
    if not abs(shown - stated) > STRANGE_SIGMA * deviation:
        return ()
    side = "later" if shown > stated else "earlier"
    return (
        f"{gas} fits CO2 best {abs(shown - stated):.1f} s {side} than by the stated delays, with a"
        f" standard deviation of {deviation:.1f} s: check t90 and delay of both, and that their"
        " columns were logged by one clock",
    )
