"""The path of any periodic course, where there is no closed form: its Fourier series, and its place
by a spline.
"""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
from scipy.interpolate import CubicHermiteSpline

from gnc.reference.reference import Array

Course = Callable[[float], float]
"""Course offset at a phase [rad], of period 2 pi but for whole turns."""

_PIECES = 1024
"""Pieces of a period [-]: a cubic over each is good to 1e-7 of V_r/omega_0, also where the roll
rate jumps.
"""

_SAMPLES = 128
"""Of a Fourier series [-]: its coefficients fall with the third power, so that 1e-6 is left."""


def fourier_coefficients(course: Course) -> npt.NDArray[np.complex128]:
    """Return c_n of exp(i course) = sum of c_n exp(i n phase), in the order of ``numpy.fft.fft``,
    shape (128,).
    """
    phases = (2.0 * np.pi / _SAMPLES * np.arange(_SAMPLES)).tolist()
    return np.asarray(
        np.fft.fft(np.exp(1j * np.array([course(phase) for phase in phases]))) / _SAMPLES
    )


class CoursePath:
    """Where a point of unit speed is that flies a periodic course, seen from a point of its mean
    velocity.

    Parameters
    ----------
    course : over the phase

    Attributes
    ----------
    mean : of exp(i course), the mean velocity: its real part is along [-]
    """

    __slots__ = ("_along", "_right", "mean")

    def __init__(self, course: Course) -> None:
        phases = np.linspace(0.0, 2.0 * np.pi, 2 * _PIECES + 1)
        velocity = np.exp(1j * np.array([course(phase) for phase in phases.tolist()]))
        step = 2.0 * np.pi / _PIECES
        pieces = step / 6.0 * (velocity[:-1:2] + 4.0 * velocity[1::2] + velocity[2::2])
        self.mean = complex(np.sum(pieces)) / (2.0 * np.pi)
        knots = phases[::2]
        place = np.concatenate([[0.0], np.cumsum(pieces)]) - self.mean * knots
        slope = velocity[::2] - self.mean
        self._along = CubicHermiteSpline(knots, place.real, slope.real)
        self._right = CubicHermiteSpline(knots, place.imag, slope.imag)

    def offset(self, phase: npt.ArrayLike) -> tuple[Array, Array]:
        """Return the place at phases of any shape, along and to the right, from that of phase 0
        [V_r/omega_0].
        """
        within = np.mod(phase, 2.0 * np.pi)
        return np.asarray(self._along(within)), np.asarray(self._right(within))

    def half_widths(self) -> tuple[float, float]:
        """Return how far the path reaches from the place of phase 0, along and across
        [V_r/omega_0].
        """
        return _farthest(self._along), _farthest(self._right)


def _farthest(part: "CubicHermiteSpline[np.float64]") -> float:
    turns = part.derivative().roots(extrapolate=False)
    return float(np.max(np.abs(part(turns[np.isfinite(turns)])), initial=0.0))
