from dataclasses import replace

import numpy as np
import pytest
from plume_cases import EMISSION, HEIGHT, air

from measurement.plume.spread import STEP, MarineAir, PlumeSettings, downwash, rise, spreads

WIND = np.array([5.0, 10.0, 20.0])
COLD_POINT = replace(
    EMISSION, buoyancy_flux=0.0, momentum_flux=0.0, stack_diameter=1e-4, wake_spread=0.0
)
RISE_WIND = np.array([2.0, 5.0, 10.0, 20.0])
RISE_AGE = 30.0


def test_turbulence_follows_from_the_wind_over_the_sea():
    # Section 1.4 of the specification, three digits.
    for wind, friction in ((3.0, 0.095), (5.0, 0.164), (7.0, 0.242), (10.0, 0.371), (15.0, 0.612)):
        of = MarineAir(wind_speed=wind)
        assert of.friction_velocity == pytest.approx(friction, abs=6e-4)
    # Section 1.4: 1.9 u*, 1.3 u*, 2300 u*^1.5, u*^3/(0.4 z).
    assert of.sigma_v == pytest.approx(1.9 * of.friction_velocity)
    assert of.sigma_w == pytest.approx(1.3 * of.friction_velocity)
    assert of.mixing_height == pytest.approx(2300.0 * of.friction_velocity**1.5)
    assert of.dissipation(70.0) == pytest.approx(of.friction_velocity**3 / 28.0)
    calm, light = (MarineAir(wind_speed=wind).friction_velocity for wind in (0.0, 0.5))
    assert calm == light > 0.0


@pytest.mark.parametrize("buoyant", [True, False])
def test_buoyancy_or_momentum_alone_are_briggs_laws(buoyant):
    # 1.609 = (3/(2 0.6^2))^(1/3), section 1.3 of the specification; Briggs' 1.6. Four digits are
    # printed. By momentum (3 Fm x/(b^2 U^2))^(1/3) with b = 0.6.
    distance = RISE_WIND * RISE_AGE
    if buoyant:
        emission = replace(EMISSION, momentum_flux=0.0)
        expected = 1.609 * 49.6 ** (1 / 3) * distance ** (2 / 3) / RISE_WIND
    else:
        emission = replace(EMISSION, buoyancy_flux=0.0)
        expected = (3.0 * 124.0 * distance / (0.36 * RISE_WIND**2)) ** (1 / 3)
    np.testing.assert_allclose(rise(emission, RISE_WIND, np.array(RISE_AGE)), expected, rtol=4e-4)


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
    np.testing.assert_allclose(downwash(EMISSION, RISE_WIND), [0.0, 0.0, 0.0, 1.5])


def test_relative_spread_goes_to_the_cube_of_time_without_buoyancy():
    of = spreads(COLD_POINT, air(10.0), HEIGHT, WIND, 200.0, PlumeSettings())
    law = 0.1 * air(10.0).dissipation(2.0 * HEIGHT)
    age = 120.0
    square = of.relative_y[:, round(age / STEP)] ** 2
    # C_r eps t^3, section 1.4. The ballistic range at its start costs 0.8 s: three times that of
    # 120 s is 2 %.
    np.testing.assert_allclose(square / (law * age**3), 1.0, atol=0.025)
    earlier = of.relative_y[:, round(60.0 / STEP)] ** 2
    # The exponent itself: a factor of eight when the time is twice as long; the start costs as much
    # again.
    np.testing.assert_allclose(square / earlier, 8.0, rtol=0.02)


@pytest.mark.parametrize("buoyant", [True, False])
def test_relative_spread_and_meander_make_the_regulatory_total(buoyant):
    emission = EMISSION if buoyant else COLD_POINT
    weather = air(10.0)
    of = spreads(emission, weather, HEIGHT, WIND, 120.0, PlumeSettings(downwash=False))
    i = round(50.0 / STEP)
    rise = of.height[:, i] - HEIGHT
    final = of.height[:, round(60.0 / STEP)]
    # AERMOD's sigma_v t/(1 + t/2T)^0.3 and sigma_w t/(1 + sigma_w t/0.72 h)^0.5 of section 1.4,
    # with h the axis after a minute, and 0.283 of the rise; sigma_0^2 = d^2/8 max(w/U, 1) + 3 m
    # squared.
    scale = weather.mixing_height / (156.0 * weather.sigma_v) * final / 0.46
    across = weather.sigma_v * 50.0 / (1.0 + 50.0 / (2.0 * scale)) ** 0.3
    up = weather.sigma_w * 50.0 / np.sqrt(1.0 + weather.sigma_w * 50.0 / (0.72 * final))
    source = (
        emission.stack_diameter**2 / 8.0 * np.maximum(20.0 / WIND, 1.0) + emission.wake_spread**2
    )
    own = source + 0.08 * rise**2
    np.testing.assert_allclose(
        of.relative_y[:, i] ** 2 + of.meander_y[:, i] ** 2, across**2 + own, rtol=1e-9
    )
    np.testing.assert_allclose(
        of.relative_z[:, i] ** 2 + of.meander_z[:, i] ** 2, up**2 + own, rtol=1e-9
    )
    assert (of.meander_y[:, i] > 0.0).all()
    assert (of.meander_z[:, i] >= 0.0).all()


def test_relative_spread_hardly_depends_on_its_least_certain_constant():
    # Section 0, item 8: 15.4 to 16.5 m for C_r 0.1 to 0.6, at 200 m and 5 m/s; three digits.
    for constant, spread in ((0.1, 15.4), (0.6, 16.5)):
        settings = PlumeSettings(richardson=constant)
        of = spreads(EMISSION, air(7.0), HEIGHT, WIND[:1], 60.0, settings)
        assert of.relative_y[0, round(40.0 / STEP)] == pytest.approx(spread, abs=0.06)


def test_spreads_of_a_table_do_not_depend_on_its_other_winds_and_ages():
    alone = spreads(EMISSION, air(7.0), HEIGHT, WIND[1:2], 60.0, PlumeSettings())
    among = spreads(EMISSION, air(7.0), HEIGHT, WIND, 120.0, PlumeSettings())
    np.testing.assert_array_equal(alone.relative_y[0, :600], among.relative_y[1, :600])
    np.testing.assert_array_equal(alone.meander_z[0, :600], among.meander_z[1, :600])
