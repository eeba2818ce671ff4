"""Quality of a record: A, B or C."""

import math
from collections.abc import Sequence

from measurement.estimate.fit.alignment import DELAY_MOST
from measurement.estimate.result import Quality
from measurement.gases import FUEL_SULPHUR_MOST
from measurement.sniffer.channel import Channel

SNR_GOOD = 20.0
"""Signal to noise of CO2 for class A."""

UNCERTAINTY_GOOD = 0.2
"""Largest standard uncertainty over the lowest limit for class A."""

PASSES_GOOD = 3
"""Passes for class A."""

AGREEMENT_LEAST = 0.01
"""Least probability that passes of one fuel differ as much, for class A.

None is so small that it makes class C: it allows for noise and response, and not for corrections
and drift that change from pass to pass: of 200 flights of ``sulphur_monte_carlo``, all of one fuel,
one has 1e-4.
"""

NOISE_USUAL = 1.0
"""Noise of a channel of SO2, NO or NO2 of which none is stated [ppb]: the presets have 0.3 to 7.5
ppb.
"""

QUIET_SHARE = 0.01
"""Readings that scatter by less than this share of their noise are in another unit, or their sensor
is dead.

In ppm it is a thousandth; a data sheet that states 2 sigma, or smoothing in the instrument, leaves
a larger share. With ``NOISE_USUAL`` it is 10 ppt: laser-induced fluorescence alone has less in a
second (2 ppt in 10 s: Rollins et al., AMT 9:4601).
"""

STRANGE_SIGMA = 4.0
"""By so many of its standard deviations each property of the instrument may differ, and the
residuals by so many of theirs, until the instrument is not the one that is stated."""

ARRIVED_SIGMA, ARRIVED_SHARE = 3.0, 0.5
"""A result above 0 by so many standard uncertainties is SO2 that has arrived; otherwise readings
must follow this share of CO2 for as long as SO2 may take."""

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
    limit: float,
    responses_stated: bool,
) -> tuple[Quality, tuple[str, ...]]:
    """Return the quality class and why it is not A.

    Parameters
    ----------
    problems : of the record, each of which makes it C
    snr, passes : of CO2, median of the passes, and how many there are
    fsc, deviation : result and its standard uncertainty [% m/m]
    agreement : probability that passes differ as much
    limit : lowest limit [% m/m]
    responses_stated : whether it is known what the SO2 channel makes of NO and NO2
    """
    rejected = list(problems)
    if passes and not math.isfinite(fsc):
        rejected.append("the CO2 excess is not above its noise")
    if math.isfinite(fsc) and fsc < -NEGATIVE_SIGMA * deviation:
        rejected.append(
            f"the result is {fsc:.3f} %, negative by more than {NEGATIVE_SIGMA:g} standard uncertainties: check the corrections"
        )
    if deviation > FUEL_SULPHUR_MOST:
        rejected.append(
            f"the standard uncertainty is {deviation:.0f} %, and no fuel has above {FUEL_SULPHUR_MOST:g} %: SO2 does not follow"
            " CO2; check its sign and its sensor"
        )
    elif math.isfinite(fsc) and fsc - NEGATIVE_SIGMA * deviation > FUEL_SULPHUR_MOST:
        rejected.append(
            f"the result is {fsc:.1f} %, and no fuel has above {FUEL_SULPHUR_MOST:g} %: check the units of SO2 and CO2"
        )
    if rejected:
        return "C", tuple(rejected)
    reasons = []
    if snr < SNR_GOOD:
        reasons.append(f"CO2 signal to noise is {snr:.1f}; class A needs {SNR_GOOD:g}")
    if deviation > UNCERTAINTY_GOOD * limit:
        why = (
            ""
            if responses_stated
            else ", as the response of SO2 to NO and NO2 is not stated (cross)"
        )
        reasons.append(
            f"standard uncertainty is {deviation:.3f} %{why}; class A needs {UNCERTAINTY_GOOD * limit:.3f} %"
        )
    if passes < PASSES_GOOD:
        reasons.append(
            f"{passes} {'pass' if passes == 1 else 'passes'} through the plume; class A needs {PASSES_GOOD}"
        )
    if math.isfinite(agreement) and agreement < AGREEMENT_LEAST:
        reasons.append(
            f"passes differ more than their noise explains (p = {agreement:.1g}; class A needs {AGREEMENT_LEAST:g})"
        )
    return ("B" if reasons else "A"), tuple(reasons)


def quiet(scatter: float, channel: Channel) -> tuple[str, ...]:
    """Return the problem of a gas that scatters less than its sensor can, if it does: in clean air
    there is as much noise.

    Parameters
    ----------
    scatter : standard deviation of the readings that they show themselves [ppb]
    channel : of SO2, NO or NO2, as the analyst knows it; rounding to a step that is larger than its
        noise may hide that
    """
    stated = not math.isnan(channel.noise)
    noise = channel.noise if stated else NOISE_USUAL
    if scatter >= QUIET_SHARE * noise or channel.resolution > noise:
        return ()
    found = (
        f"scatters by {scatter:.2g} ppb from reading to reading"
        if scatter > 0.0
        else "reads the same throughout"
    )
    expected = (
        f"its noise is {noise:g} ppb"
        if stated
        else f"the noise of such sensors is about {noise:g} ppb"
    )
    return (
        f"{channel.gas.upper()} {found}, and {expected}: it is in another unit (of ppm, give a [scale] of {channel.gas} = 1000.0),"
        " or its sensor is dead",
    )


def stranger(
    misfit: float, residual_energy: float, instrument_energy: float, samples: int
) -> tuple[str, ...]:
    """Return the problem of residuals that neither noise nor the instrument's stated uncertainty
    explain, if they are such.

    Parameters
    ----------
    misfit : mean square of the residuals over that of the stated noise
    residual_energy, instrument_energy : sum of squares of the residuals, and what the instrument's
        uncertainty adds to it
    samples : of the record
    """
    if not misfit > 0.0 or residual_energy == 0.0:
        return ()
    unexplained = 1.0 / (1.0 / misfit + STRANGE_SIGMA**2 * instrument_energy / residual_energy)
    if noise_alone(unexplained, samples):
        return ()
    return (
        f"residuals are {math.sqrt(misfit):.1f} times the noise, more than the stated uncertainty of the instrument explains:"
        " check its response, delay, noise and other gases",
    )


def noise_alone(misfit: float, samples: int) -> bool:
    """Return whether the noise of so many samples explains a misfit."""
    # The mean square of white noise over so many samples has a relative standard deviation of
    # sqrt(2/samples).
    return misfit <= 1.0 + STRANGE_SIGMA * math.sqrt(2.0 / samples)


def not_arrived(
    fsc: float, deviation: float, read: Sequence[float], doses: Sequence[float]
) -> tuple[str, ...]:
    """Return the problem of SO2 whose delay is not stated, and which may not have arrived yet, if
    it may not.

    SO2 that stands out has. Without it most of the CO2 must be followed by readings for as long as
    any delay.

    Parameters
    ----------
    fsc, deviation : result and its standard uncertainty [% m/m]
    read : share of the time after each pass, in which its SO2 may come, that was read [-]
    doses : of CO2 in each pass [ppm s]
    """
    if not read or fsc > ARRIVED_SIGMA * deviation:
        return ()
    if sum(share * dose for share, dose in zip(read, doses, strict=True)) >= ARRIVED_SHARE * sum(
        doses
    ):
        return ()
    return (
        f"SO2 does not stand out, and may still come: its delay is not stated, and may be up to {DELAY_MOST:g} s; state it, or"
        " record longer after the passes",
    )


def late(stated: float, shown: float, deviation: float) -> tuple[str, ...]:
    """Return the problem of a delay of SO2 after CO2 that is not the stated one, if it is not.

    Parameters
    ----------
    stated, shown : by the instrument's figures, and as the readings fit best [s]
    deviation : standard deviation of the difference [s]
    """
    if not abs(shown - stated) > STRANGE_SIGMA * deviation:
        return ()
    side = "later" if shown > stated else "earlier"
    return (
        f"SO2 fits CO2 best {abs(shown - stated):.1f} s {side} than by the stated delays, with a standard deviation of"
        f" {deviation:.1f} s: check t90 and delay of both, and that their columns were logged by one clock",
    )
