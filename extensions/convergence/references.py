"""Many references that circle, oscillate, wander or fly straight, and the time to approach them."""

from typing import Any, Self

import numpy as np
import numpy.typing as npt
from scipy.special import j0

from gnc.paper import LookAhead

Array = npt.NDArray[np.float64]


class TurningReferences:
    """Courses of n references, in closed form: heading rates are a constant and a sum of sinusoids.

    omega_r = c + sum_k a_k sin(w_k t + p_k), so that chi_r = chi_r0 + c t - sum_k a_k/w_k (cos(w_k
    t + p_k) - cos p_k). A circle has c alone, the oscillation of equation (2) one term a = -A, w =
    omega_0, p = phi_0, a wandering course several terms, and a straight course nothing. The heading
    rate is bounded by |c| + sum |a_k|, its derivative by sum |a_k| w_k.

    Parameters
    ----------
    course : chi_r0, at time 0, shape (n,) [rad]
    rate : c, shape (n,) [rad/s]
    amplitude, frequency, phase : a_k [rad/s], w_k [rad/s] and p_k [rad], shape (terms, n);
        frequencies above 0
    """

    def __init__(
        self,
        *,
        course: npt.ArrayLike,
        rate: npt.ArrayLike,
        amplitude: npt.ArrayLike,
        frequency: npt.ArrayLike,
        phase: npt.ArrayLike,
    ) -> None:
        self.course: Array = np.array(course, dtype=float)
        self.rate: Array = np.array(rate, dtype=float)
        self.amplitude: Array = np.array(amplitude, dtype=float)
        self.frequency: Array = np.array(frequency, dtype=float)
        self.phase: Array = np.array(phase, dtype=float)
        self.swing: Array = self.amplitude / self.frequency
        self.mean_course: Array = self.course + (self.swing * np.cos(self.phase)).sum(axis=0)

    def __len__(self) -> int:
        return len(self.course)

    @property
    def anisotropy(self) -> Array:
        """Mean of cos 2(chi_r - mean course), shape (n,), from -1 to 1 [-].

        It is 0 for a circle, 1 for a straight course, and the product of J_0(2 a_k/w_k) for terms
        whose frequencies are incommensurable.
        """
        product: Array = np.prod(j0(2.0 * self.swing), axis=0)
        return np.where(self.rate == 0.0, product, 0.0)

    def take(self, which: npt.NDArray[Any]) -> Self:
        """Return the references that an index or mask selects."""
        return type(self)(
            course=self.course[which],
            rate=self.rate[which],
            amplitude=self.amplitude[:, which],
            frequency=self.frequency[:, which],
            phase=self.phase[:, which],
        )

    def course_at(self, time: Array) -> Array:
        """Return chi_r [rad], not wrapped, at a time of each reference, shape (n,) [s]."""
        course: Array = self.mean_course + self.rate * time
        if len(self.swing):
            course -= (self.swing * np.cos(self.frequency * time + self.phase)).sum(axis=0)
        return course

    def heading_rate_at(self, time: Array) -> Array:
        """Return omega_r [rad/s] at a time of each reference, shape (n,) [s]."""
        if not len(self.amplitude):
            return self.rate
        swinging = self.amplitude * np.sin(self.frequency * time + self.phase)
        rate: Array = self.rate + swinging.sum(axis=0)
        return rate


def averaged_settling_time(
    look_ahead: LookAhead,
    speed: float,
    references: TurningReferences,
    to_reference: npt.ArrayLike,
    distance: float,
) -> Array:
    """Return the time until d is ``distance``, by the averaged motion, shape (n,) [s].

    It is 0 where d starts there, and infinite for straight courses.

    With phi = 0 and d well below delta, only the part of d across chi_r decays, at the rate
    V/delta. On average over the reference's courses the part along the mean course decays at
    V/(2 delta) (1 - m), the part across it at V/(2 delta) (1 + m), with m the anisotropy. In the
    time tau with d tau = V/delta dt both decay exponentially. For a circle, m = 0, the time from
    d_0 to d_1 is [2 R ln(d_0/d_1) + epsilon (d_0^2 - d_1^2)]/V. The average is wrong for a slow
    oscillation, and the expansion is rough near d = delta.

    Parameters
    ----------
    look_ahead, speed : of the vehicles [m/s]
    references : of n vehicles
    to_reference : d at the start, north and east, shape (2, n) [m]
    distance : at the end, above 0 [m]
    """
    north, east = np.asarray(to_reference, dtype=float)
    cos_m, sin_m = np.cos(references.mean_course), np.sin(references.mean_course)
    anisotropy = references.anisotropy
    along, across = (north * cos_m + east * sin_m) ** 2, (east * cos_m - north * sin_m) ** 2
    along_rate, across_rate = 1.0 - anisotropy, 1.0 + anisotropy
    target = distance * distance
    start = along + across
    settled = start <= target
    slowest = np.minimum(along_rate, across_rate)
    possible = (slowest > 0.0) & ~settled
    # Bisection for the tau at which d^2 is the target; d^2 decays at least at the slowest rate.
    later = np.zeros_like(start)
    np.divide(np.log(np.maximum(start / target, 1.0)), slowest, out=later, where=possible)
    earlier = np.zeros_like(start)
    for _ in range(60):
        middle = 0.5 * (earlier + later)
        squared = along * np.exp(-along_rate * middle) + across * np.exp(-across_rate * middle)
        above = squared > target
        earlier = np.where(above, middle, earlier)
        later = np.where(above, later, middle)
    # The integral of d^2 over tau.
    area = np.zeros_like(start)
    for part, rate in ((along, along_rate), (across, across_rate)):
        area += part * np.divide(-np.expm1(-rate * later), rate, out=later.copy(), where=rate > 0.0)
    time: Array = (look_ahead.radius * later + look_ahead.epsilon * area) / speed
    return np.where(settled, 0.0, np.where(possible, time, np.inf))
