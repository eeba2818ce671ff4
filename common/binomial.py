"""What counts of independent events say of their probability."""

CONFIDENCE = 0.95
"""Confidence of a bound where nothing else is asked for [-]."""


TINY = 1e-5
"""Probabilities below are written as powers of ten: nobody reads zeros behind a point."""

_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def upper_bound(events: int, trials: int, confidence: float = CONFIDENCE) -> float:
    """Return the exact one-sided upper bound of a probability [-].

    C. J. Clopper and E. S. Pearson, "The use of confidence or fiducial limits illustrated in the case of the binomial", Biometrika
    26 (1934). Where trials differ in their probability, as the flights of a sweep do, it bounds their mean: W. Hoeffding, "On the
    distribution of the number of successes in independent trials", Annals of Mathematical Statistics 27 (1956), theorem 4.

    Parameters
    ----------
    events, trials : number of events and of independent trials; without any trial the bound is 1
    confidence : confidence level, between 0 and 1

    Raises
    ------
    ValueError : ``events`` is not within 0 to ``trials``, or ``confidence`` not between 0 and 1
    """
    from scipy.stats import beta

    if not 0.0 < confidence < 1.0:
        raise ValueError(f"confidence is {confidence:g}; it must be between 0 and 1, such as {CONFIDENCE:g}")
    if not 0 <= events <= trials:
        raise ValueError(f"events are {events} of {trials} trials; there can be 0 to {trials}")
    return 1.0 if events == trials else float(beta.ppf(confidence, events + 1, trials - events))


def percent(fraction: float) -> str:
    """Return a fraction in per cent, to three digits, and to four where it is nearly all; below 1e-5 as a power of ten.

    No line breaks before the sign.
    """
    if 0.0 < fraction < TINY:
        mantissa, exponent = f"{fraction:.1e}".split("e")
        return f"{mantissa}·10{str(int(exponent)).translate(_RAISED)}"
    digits = 3 if fraction < 0.99 else 4
    return f"{100.0 * fraction:.{digits}g}\N{NO-BREAK SPACE}%"
