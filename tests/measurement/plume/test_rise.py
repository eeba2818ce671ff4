from dataclasses import replace

import numpy as np
import pytest
from plume_cases import EMISSION

from measurement.plume.spread import downwash, rise

WIND = np.array([2.0, 5.0, 10.0, 20.0])
AGE = 30.0


def test_buoyancy_alone_is_briggs_two_thirds_law():
    emission = replace(EMISSION, momentum_flux=0.0)
    distance = WIND * AGE
    # 1.609 = (3/(2 0.6^2))^(1/3), section 1.3 of the specification; Briggs' 1.6. Four digits are
    # printed.
    expected = 1.609 * 49.6 ** (1 / 3) * distance ** (2 / 3) / WIND
    np.testing.assert_allclose(rise(emission, WIND, np.array(AGE)), expected, rtol=4e-4)


def test_momentum_alone_is_briggs_one_third_law():
    emission = replace(EMISSION, buoyancy_flux=0.0)
    # (3 Fm x/(b^2 U^2))^(1/3) with b = 0.6.
    expected = (3.0 * 124.0 * WIND * AGE / (0.36 * WIND**2)) ** (1 / 3)
    np.testing.assert_allclose(rise(emission, WIND, np.array(AGE)), expected, rtol=1e-12)


def test_without_either_nothing_rises():
    emission = replace(EMISSION, buoyancy_flux=0.0, momentum_flux=0.0)
    assert not rise(emission, WIND, np.array(AGE)).any()
    assert not rise(emission, WIND, np.array(AGE), 0.02).any()


def test_stable_air_ends_the_rise_at_its_crest():
    still = replace(EMISSION, momentum_flux=0.0)
    age = np.linspace(0.0, 1000.0, 2001)
    height = rise(still, np.array(5.0), age, 0.02)
    # AERMOD, SBLRIS: 2.66 (2 F/(N^2 U))^(1/3) where the cosine is -1, at t = pi/(0.7 N) = 224 s,
    # and held.
    final = 2.66 * (2.0 * 49.6 / (0.02**2 * 5.0)) ** (1 / 3)
    assert height[-1] == pytest.approx(final, rel=1e-12)
    assert (np.diff(height) >= 0.0).all()
    assert (height[age > np.pi / 0.014] == height[-1]).all()


def test_stable_air_never_lifts_more_than_neutral_air_and_weak_stability_not_less():
    age = np.linspace(0.0, 300.0, 601)
    neutral = rise(EMISSION, np.array(5.0), age)
    assert (rise(EMISSION, np.array(5.0), age, 0.02) <= neutral).all()
    for almost_neutral in (1e-4, 1e-9):
        np.testing.assert_array_equal(rise(EMISSION, np.array(5.0), age, almost_neutral), neutral)


def test_the_tip_draws_down_what_leaves_slowly():
    # 2 d (1.5 - w/U) with d = 1.5 m and w = 20 m/s: 1.5 m at 20 m/s, nothing up to 13.3 m/s.
    # AERMOD, HSPRIM.
    np.testing.assert_allclose(downwash(EMISSION, WIND), [0.0, 0.0, 0.0, 1.5])
