"""References that circle, oscillate, wander or fly straight, many at once, with a course in closed
form.
"""

from typing import Any, Self

import numpy as np
import numpy.typing as npt
from scipy.special import j0

from gnc.errors import InfeasibleError

Array = npt.NDArray[np.float64]


class TurningReferences:
    """The courses of n references whose heading rates are a constant and a sum of sinusoids.

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

    Raises
    ------
    InfeasibleError : shapes that do not belong together, values that are not finite, a frequency
        that is not above 0
    """

    __slots__ = ("amplitude", "course", "frequency", "mean_course", "phase", "rate", "swing")

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
        shape = (len(self.amplitude), *self.course.shape)
        for name, values, expected in (
            ("rate", self.rate, shape[1:]),
            ("amplitude", self.amplitude, shape),
            ("frequency", self.frequency, shape),
            ("phase", self.phase, shape),
        ):
            if values.shape != expected:
                raise InfeasibleError(
                    f"{name} of the references has shape {values.shape}; for these courses it is {expected}"
                )
        if not all(
            np.isfinite(values).all()
            for values in (self.course, self.rate, self.amplitude, self.frequency, self.phase)
        ):
            raise InfeasibleError(
                "a reference's course, rate, amplitude, frequency or phase is not finite; give numbers"
            )
        if not (self.frequency > 0.0).all():
            raise InfeasibleError(
                f"frequency of a reference is {self.frequency.min():g} rad/s; it must be above 0: leave it out"
            )
        self.swing: Array = self.amplitude / self.frequency
        self.mean_course: Array = self.course + (self.swing * np.cos(self.phase)).sum(axis=0)

    def __len__(self) -> int:
        return len(self.course)

    @property
    def heading_rate_bound(self) -> Array:
        """|c| + sum |a_k|, which |omega_r| never exceeds, shape (n,) [rad/s]."""
        bound: Array = np.abs(self.rate) + np.abs(self.amplitude).sum(axis=0)
        return bound

    @property
    def anisotropy(self) -> Array:
        """How much more the reference flies along its mean course than across it, shape (n,), from
        -1 to 1 [-].

        It is the mean of cos 2(chi_r - mean course): 0 of a circle, 1 of a straight course, and the
        product of J_0(2 a_k/w_k) over terms whose frequencies have no common measure.
        """
        product: Array = np.prod(j0(2.0 * self.swing), axis=0)
        return np.where(self.rate == 0.0, product, 0.0)

    def take(self, which: npt.NDArray[Any]) -> Self:
        """Return the references of an index or mask ``which``."""
        return type(self)(
            course=self.course[which],
            rate=self.rate[which],
            amplitude=self.amplitude[:, which],
            frequency=self.frequency[:, which],
            phase=self.phase[:, which],
        )

    def course_at(self, time: Array) -> Array:
        """Return chi_r [rad], not wrapped, at each reference's own ``time``, shape (n,) [s]."""
        course: Array = self.mean_course + self.rate * time
        if len(self.swing):
            course -= (self.swing * np.cos(self.frequency * time + self.phase)).sum(axis=0)
        return course

    def heading_rate_at(self, time: Array) -> Array:
        """Return omega_r [rad/s] at each reference's own ``time``, shape (n,) [s]."""
        if not len(self.amplitude):
            return self.rate
        rate: Array = self.rate + (self.amplitude * np.sin(self.frequency * time + self.phase)).sum(
            axis=0
        )
        return rate
