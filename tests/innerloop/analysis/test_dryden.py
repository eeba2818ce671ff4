"""Filters of the turbulence against the spectra of MIL-F-8785C, written out here from the standard."""

import math

import control
import numpy as np
import pytest

from common.physics.units import METRES_PER_FOOT
from innerloop.analysis.dryden import dryden_filters
from innerloop.analysis.gust_response import GUSTS
from innerloop.analysis.gust_statistics import low_altitude_turbulence

AIRSPEED, SPAN = 19.42, 2.1
LIGHT = low_altitude_turbulence(60.0, 7.717)  # 15 knots at 20 ft


def spectrum(name, frequency, air=LIGHT):
    """Power spectral density over positive frequencies [unit^2 s/rad], MIL-F-8785C 3.7.1.2 with
    Omega = omega/V; p after Yeager.
    """
    v = AIRSPEED
    along, down = air.horizontal_length / v * frequency, air.vertical_length / v * frequency
    transverse = {
        "gust_right": air.horizontal**2
        * air.horizontal_length
        / (math.pi * v)
        * (1 + 3 * along**2)
        / (1 + along**2) ** 2,
        "gust_down": air.vertical**2
        * air.vertical_length
        / (math.pi * v)
        * (1 + 3 * down**2)
        / (1 + down**2) ** 2,
    }
    if name in transverse:
        return transverse[name]
    if name == "gust_along":
        return air.horizontal**2 * 2.0 * air.horizontal_length / (math.pi * v) / (1 + along**2)
    if name == "gust_p":
        reach = math.sqrt(air.vertical_length * SPAN)
        sigma, length = 1.9 * air.vertical / reach, reach / 2.6
        return sigma**2 * 2.0 * length / (math.pi * v) / (1 + (length * frequency / v) ** 2)
    source, share = {"gust_q": ("gust_down", 4.0), "gust_r": ("gust_right", 3.0)}[name]
    slope = (frequency / v) ** 2 / (1 + (share * SPAN * frequency / (math.pi * v)) ** 2)
    return slope * transverse[source]


@pytest.fixture(scope="module")
def filters():
    return dryden_filters(LIGHT, airspeed=AIRSPEED, span=SPAN)


@pytest.mark.parametrize("name", GUSTS)
def test_a_filter_has_the_spectrum_of_the_standard(filters, name):
    frequencies = np.logspace(-3, 2, 11)
    response = filters(1j * frequencies)[GUSTS.index(name)]
    # White noise of intensity 1 has the density 1/pi over positive frequencies. Same formula, so
    # rounding alone.
    found = np.sum(np.abs(response) ** 2, axis=0) / math.pi
    assert found == pytest.approx([spectrum(name, w) for w in frequencies], rel=1e-9)


@pytest.mark.parametrize("name", GUSTS)
def test_the_covariance_of_the_filters_is_the_integral_of_the_spectrum(filters, name):
    covariance = filters.C @ control.lyap(filters.A, filters.B @ filters.B.T) @ filters.C.T
    frequencies = np.logspace(-7, 8, 40_000)
    by_integral = np.trapezoid([spectrum(name, w) for w in frequencies], frequencies)
    i = GUSTS.index(name)
    # Trapezoids 0.09 % wide are good to 1e-7; beyond the ends lies 2/pi times frequency over
    # corner, 7e-7 of the slowest.
    assert covariance[i, i] == pytest.approx(by_integral, rel=3e-6)


def test_velocities_are_as_strong_as_the_standard_says(filters):
    covariance = filters.C @ control.lyap(filters.A, filters.B @ filters.B.T) @ filters.C.T
    deviations = np.sqrt(np.diag(covariance))
    assert deviations[:3] == pytest.approx(
        [LIGHT.horizontal, LIGHT.horizontal, LIGHT.vertical], rel=1e-9
    )


def test_at_a_thousand_feet_low_altitude_turbulence_is_the_same_in_every_direction():
    # MIL-F-8785C, figures 10 and 11: there 0.177 + 0.000823 h is 1, so all deviations are 0.1 W20,
    # and all lengths 1,000 ft.
    air = low_altitude_turbulence(1000.0 * METRES_PER_FOOT, 20.0)
    assert (air.horizontal, air.vertical) == pytest.approx((2.0, 2.0), rel=1e-12)
    assert (air.horizontal_length, air.vertical_length) == pytest.approx((304.8, 304.8), rel=1e-12)


@pytest.mark.parametrize(("altitude", "wind"), [(305.0, 7.7), (math.nan, 7.7)])
def test_other_turbulence_is_refused(altitude, wind):
    with pytest.raises(ValueError, match="altitude"):
        low_altitude_turbulence(altitude, wind)
