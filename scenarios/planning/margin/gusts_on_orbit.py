"""Turbulence as an aircraft meets it that flies an orbit: its course swings through air whose gusts
do not swing with it.

A gust along a fixed direction is one along the path times the cosine of the course between them.
With exp(i course) as a Fourier series of coefficients c_n over the orbit, the mean over the phases
of cos(course now - course tau ago) is the sum of
|c_n|^2 cos(n omega_0 tau): slow gusts come back as sidebands of the orbit's frequency, with these weights. For the sinusoid
eta cos(omega_0 t + phase) they are J_n(eta)^2, and the mean is J_0(2 eta sin(omega_0 tau/2)) by
Graf's addition theorem.
"""

import functools

import control
import numpy as np
import numpy.typing as npt

from aircraft.weather import GustStatistics
from gnc.reference.reference import Orbit
from innerloop.gusts import GUSTS, dryden_filters

_SIDEBANDS = np.arange(-12, 13)
"""J_13(2.4)^2 is below 1e-15, and eta is no more than 2.405; a course whose roll rate jumps leaves
below 1e-6 beyond.
"""

_TURNED = (("gust_along", "gust_right"), ("gust_p", "gust_q"))
"""Components that the course turns into each other."""

Array = npt.NDArray[np.float64]


def gusts_on_orbit(
    turbulence: GustStatistics,
    oscillation: Orbit,
    frequencies: Array,
    *,
    airspeed: float,
    span: float,
) -> Array:
    """Return the power spectral densities of ``GUSTS`` in the axes of the path, shape (frequencies,
    6), averaged over the orbit.

    The variance is the integral over positive frequencies over pi. Components are taken as
    independent: those that the course turns into each other are so in the mean over the orbit, up
    to the difference between their spectra.

    Parameters
    ----------
    turbulence, airspeed, span : same as ``innerloop.gusts.dryden_filters``, in axes that do
        not turn
    oscillation : of the reference's course
    frequencies : [rad/s], above 0
    """
    weights = tuple(oscillation.sidebands(_SIDEBANDS).tolist())
    return _on_orbit(
        turbulence, airspeed, span, oscillation.omega_0, weights, tuple(frequencies.tolist())
    )


@functools.lru_cache(maxsize=64)
def _on_orbit(
    turbulence: GustStatistics,
    airspeed: float,
    span: float,
    omega_0: float,
    weights: tuple[float, ...],
    at: tuple[float, ...],
) -> Array:
    """Return what ``gusts_on_orbit`` does; kept, for trials in the same turbulence ask for the
    same.
    """
    filters, frequencies = _filters(turbulence, airspeed=airspeed, span=span), np.array(at)
    spectra = _spectra(filters, frequencies)
    shifted = [_spectra(filters, np.abs(frequencies - n * omega_0)) for n in _SIDEBANDS]
    for pair in _TURNED:
        columns = [GUSTS.index(name) for name in pair]
        mean = sum(
            weight * s[:, columns].mean(axis=1) for weight, s in zip(weights, shifted, strict=True)
        )
        spectra[:, columns] = np.asarray(mean)[:, None]
    spectra.flags.writeable = False
    return spectra


_filters = functools.lru_cache(maxsize=8)(dryden_filters)


def _spectra(filters: control.StateSpace, frequencies: Array) -> Array:
    response = np.moveaxis(filters(1j * frequencies, squeeze=False), -1, 0)
    return np.asarray(np.sum(np.abs(response) ** 2, axis=2))
