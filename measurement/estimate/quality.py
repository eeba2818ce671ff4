"""Quality of a record: A, B or C (measurement.md, section 4.6)."""

import math
from collections.abc import Sequence

from measurement.estimate.result import Quality

SNR_GOOD = 20.0
"""Signal to noise of CO2 for class A."""

UNCERTAINTY_GOOD = 0.2
"""Largest standard uncertainty over the lowest limit for class A."""

PASSES_GOOD = 3
"""Passes for class A."""

AGREEMENT_LEAST = 0.01
"""Least probability that passes of one fuel differ as much, for class A."""

MISFIT_MOST, EXPLAINED_LEAST = 4.0, 2.0
"""Mean square of the residuals over that of the noise, and what the plume explains of SO2 over the residuals: beyond the one and
under the other the instrument is not the one that is stated. In a strong plume residuals are always larger than the noise, as a
response is never known exactly."""

NEGATIVE_SIGMA = 3.0
"""A result below 0 by so many standard uncertainties contradicts them."""


def judged_quality(
    *,
    problems: Sequence[str],
    snr: float,
    passes: int,
    fsc: float,
    deviation: float,
    agreement: float,
    misfit: float,
    so2_snr: float,
    limit: float,
) -> tuple[Quality, tuple[str, ...]]:
    """Return the quality class and why it is not A.

    Parameters
    ----------
    problems : of the record, each of which makes it C
    snr, passes : of CO2, median of the passes, and how many there are
    fsc, deviation : result and its standard uncertainty [% m/m]
    agreement : probability that passes differ as much
    misfit : mean square of the residuals over that of the stated noise
    so2_snr : standard deviation of the SO2 that the plume explains, over that of the residuals
    limit : lowest limit [% m/m]
    """
    rejected = list(problems)
    if passes and not math.isfinite(fsc):
        rejected.append("the CO2 excess is not above its noise")
    if math.isfinite(fsc) and fsc < -NEGATIVE_SIGMA * deviation:
        rejected.append(
            f"the result is {fsc:.3f} %, negative by more than {NEGATIVE_SIGMA:g} standard uncertainties: check the corrections"
        )
    if misfit > MISFIT_MOST and so2_snr < EXPLAINED_LEAST:
        rejected.append(
            f"residuals are {math.sqrt(misfit):.1f} times the stated noise, and more than half of what CO2 explains: check the"
            " instrument's noise, response and other gases"
        )
    if rejected:
        return "C", tuple(rejected)
    reasons = []
    if snr < SNR_GOOD:
        reasons.append(f"CO2 signal to noise is {snr:.1f}; class A needs {SNR_GOOD:g}")
    if deviation > UNCERTAINTY_GOOD * limit:
        reasons.append(f"standard uncertainty is {deviation:.3f} %; class A needs {UNCERTAINTY_GOOD * limit:.3f} %")
    if passes < PASSES_GOOD:
        reasons.append(f"{passes} {'pass' if passes == 1 else 'passes'} through the plume; class A needs {PASSES_GOOD}")
    if math.isfinite(agreement) and agreement < AGREEMENT_LEAST:
        reasons.append(f"passes differ more than their noise explains (p = {agreement:.1g}; class A needs {AGREEMENT_LEAST:g})")
    return ("B" if reasons else "A"), tuple(reasons)
