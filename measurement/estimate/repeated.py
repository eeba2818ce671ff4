"""Verdicts that may be looked at repeatedly: one rate of errors for all looks together.

A flight that leaves as soon as there is a verdict looks at the same evidence many times. With the
guard band for one look, each further look adds to the probability that one of them is wrong: looks
every 15 s for ten minutes call 10 to 16 % of the fuels at the limit above, instead of the stated 5
%.

The estimate over time
    At look j the estimate is X_j with the standard uncertainty u_j. The information of later
    readings is independent of the remaining error, and the errors of the instrument are the same at
    all looks: both give Cov(X_i, X_j) = u_j^2 for i before j. So with the information I = 1/u^2 the
    score I (X - limit) of a fuel at the limit is a Wiener process at the time I: its increments are
    independent (D. O. Scharfstein, A. A. Tsiatis and J. M. Robins, "Semiparametric efficiency and
    its implication on the design and analysis of group-sequential studies", Journal of the American
    Statistical Association 92 (1997)). Information ends at that of an exact reading by this
    instrument.
Spending the errors
    A share t^1.5 of the error rate may have been spent when a share t of that information is
    available (K. K. G. Lan and D. L. DeMets, "Discrete sequential boundaries for clinical trials",
    Biometrika 70 (1983); K. Kim and D. L. DeMets, "Design and analysis of group sequential tests
    based on the type I error spending rate function", Biometrika 74 (1987)). A smaller power ends
    flights by fuels far from the limit earlier and leaves more of the others without a verdict. The
    last look spends the rest.
Guard band of a look
    z = (X - limit)/u has to exceed a_j, where P(z_1 < a_1, ..., z_j-1 < a_j-1, z_j >= a_j) is the
    share that the look may spend. The density of z on the paths that have not crossed goes from
    look to look by one integral (P. Armitage, C. K. McPherson and B. C. Rowe, "Repeated
    significance tests on accumulating data", Journal of the Royal Statistical Society A 132
    (1969)).

Every path that is ever called above crosses one of the a_j, and all crossings together have the
error rate: so the rate holds for any time at which the looks end, for any reason. The same holds
for "below"; for fuels farther from the limit the rate is lower.
"""

import functools
import math
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr, ndtri

from measurement.estimate.verdict import ABOVE, BELOW, CONFIDENCE, OPEN, Side, judged
from measurement.sniffer.lag import Array

UNDERSTATED = 1.1
"""Factor by which a standard uncertainty may be too small while one look still keeps the stated
error rate [-].

An uncertainty is only known to some tenth: estimates of simulated logs scatter by 0.86 to 1.12
times their uncertainty.
"""

SPENDING_POWER = 1.5
"""Exponent of the share of information in the share of spent errors [-]."""

GROWTH_LEAST = 0.01
"""Least relative growth of information from look to look that is reckoned with.

More growth than there is makes looks less alike than they are, and so the guard band wider than it
need be (Slepian's inequality).
"""

FINEST = 0.1
"""Uncertainty, over the limit, at which all errors are spent, if the instrument reaches a lower
one.
"""

_NODES, _LOWEST = 256, -8.0
"""Number of nodes of the integral, and its lower end: a share of 6e-16 lies below."""


@dataclass(frozen=True, slots=True)
class _Paths:
    """Estimates that have not been called above, of a fuel at the limit.

    Attributes
    ----------
    information : at their last look, relative [-]
    scores : z at the nodes
    weights : density of z, times the nodes' weights
    """

    information: float
    scores: Array
    weights: Array

    def kept(self, information: float) -> tuple[float, float]:
        """Return the correlation of z with z at more information, and the remaining deviation."""
        correlation = math.sqrt(self.information / information)
        return correlation, math.sqrt(1.0 - correlation**2)

    def crossing(self, guard: float, information: float) -> float:
        """Return the share that is above a guard band at more information, and was not before."""
        correlation, deviation = self.kept(information)
        return float(self.weights @ ndtr((correlation * self.scores - guard) / deviation))

    def density(self, scores: Array, information: float) -> Array:
        """Return the density of z at more information."""
        correlation, deviation = self.kept(information)
        apart = (scores[:, np.newaxis] - correlation * self.scores) / deviation
        found: Array = (
            np.exp(-0.5 * apart**2) @ self.weights / (deviation * math.sqrt(2.0 * math.pi))
        )
        return found


class RepeatedVerdict:
    """The verdict on a limit from estimates of one flight, each from more readings than the last.

    Parameters
    ----------
    limit_percent : [% m/m]
    error_rate : largest share of fuels at the limit that are ever called above, and that are ever
        called below [-]

    Attributes
    ----------
    verdict : "open" until a look finds another one, which then stays
    looks : number of looks that could give a verdict
    guard : standard uncertainties by which the last of these had to be above or below the limit

    Examples
    --------
    >>> watched = RepeatedVerdict(0.10)
    >>> watched.look(0.18, noise=0.03, total=0.04, admitted=True)
    'open'
    >>> watched.look(0.19, noise=0.02, total=0.03, admitted=True)
    'above'
    """

    __slots__ = ("_paths", "_rate", "_spent", "guard", "limit_percent", "looks", "verdict")

    def __init__(self, limit_percent: float, *, error_rate: float = 1.0 - CONFIDENCE) -> None:
        self.limit_percent = limit_percent
        # 3.5 % of the 5 % are spent.
        self._rate = float(ndtr(UNDERSTATED * ndtri(error_rate)))
        self.verdict: Side = OPEN
        self.looks, self.guard = 0, math.nan
        self._paths: _Paths | None = None
        self._spent = 0.0

    def look(
        self, fsc: float, *, noise: float, total: float, admitted: bool, last: bool = False
    ) -> Side:
        """Return the verdict after one more look.

        Parameters
        ----------
        fsc : estimate [% m/m]
        noise, total : its standard uncertainties by noise, which falls with more readings, and by
            all errors [% m/m]
        admitted : whether its quality admits a verdict; other looks spend nothing
        last : whether no other look follows, so that the rest of the error rate may be spent
        """
        alone = judged(self.limit_percent, fsc, total, admitted=admitted)
        if self.verdict != OPEN or not admitted or math.isnan(alone.probability_above):
            return self.verdict
        floor = math.sqrt(max(0.0, total**2 - noise**2))
        share = min(1.0, max(floor, FINEST * self.limit_percent) / total) ** 2
        spent = self._rate * (1.0 if last else share**SPENDING_POWER)
        self.guard = self._next_guard((self.limit_percent / total) ** 2, spent)
        self.looks += 1
        # A single look never gives "below" for a reading that is far below 0.
        if alone.verdict != OPEN and abs(fsc - self.limit_percent) >= self.guard * total:
            self.verdict = ABOVE if fsc > self.limit_percent else BELOW
        return self.verdict

    def _next_guard(self, information: float, spent: float) -> float:
        """Return the guard band of a look, and keep the paths that it does not call above.

        Parameters
        ----------
        information : (limit/u)^2 [-]
        spent : share of the error rate, including this look
        """
        before = self._paths
        allowed = max(0.0, spent - self._spent)
        if before is None:
            guard = -float(ndtri(allowed))
        else:
            information = max(information, before.information * (1.0 + GROWTH_LEAST))
            guard = _solve(before, information, allowed)
        guard = min(guard, -_LOWEST)
        nodes, weights = _nodes()
        half = 0.5 * (guard - _LOWEST)
        scores = _LOWEST + half * (nodes + 1.0)
        if before is None:
            density = np.exp(-0.5 * scores**2) / math.sqrt(2.0 * math.pi)
        else:
            density = before.density(scores, information)
        self._paths = _Paths(information, scores, half * weights * density)
        self._spent = max(self._spent, spent)
        return guard


@functools.cache
def _nodes() -> tuple[Array, Array]:
    """Return nodes and weights of Gauss and Legendre between -1 and 1."""
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    return nodes, weights


def _solve(paths: _Paths, information: float, allowed: float) -> float:
    """Return the guard band that a share of paths crosses at more information."""
    from scipy.optimize import brentq

    def excess(guard: float) -> float:
        return paths.crossing(guard, information) - allowed

    most = -_LOWEST
    return most if excess(most) >= 0.0 else float(brentq(excess, 0.0, most, xtol=1e-6))
