from dataclasses import replace

import numpy as np
import pytest
from plume_cases import EMISSION, HEIGHT, air

from measurement.errors import MeasurementError
from measurement.plume.spread import STEP, MarineAir, PlumeSettings, downwash, rise, spreads

WIND = np.array([5.0, 10.0, 20.0])
COLD_POINT = replace(
    EMISSION, buoyancy_flux=0.0, momentum_flux=0.0, stack_diameter=1e-4, wake_spread=0.0
)
RISE_WIND = np.array([2.0, 5.0, 10.0, 20.0])
RISE_AGE = 30.0


@pytest.mark.parametrize(
    ("wind", "friction"), [(3.0, 0.095), (5.0, 0.164), (7.0, 0.242), (10.0, 0.371), (15.0, 0.612)]
)
def test_friction_velocity_over_the_sea(wind, friction):
    # Section 1.4 of the specification, three digits.
    assert MarineAir(wind_speed=wind).friction_velocity == pytest.approx(friction, abs=6e-4)


def test_turbulence_follows_from_friction():
    of = MarineAir(wind_speed=10.0)
    # Section 1.4: 1.9 u*, 1.3 u*, 2300 u*^1.5, u*^3/(0.4 z).
    assert of.sigma_v == pytest.approx(1.9 * of.friction_velocity)
    assert of.sigma_w == pytest.approx(1.3 * of.friction_velocity)
    assert of.mixing_height == pytest.approx(2300.0 * of.friction_velocity**1.5)
    assert of.dissipation(70.0) == pytest.approx(of.friction_velocity**3 / 28.0)


def test_the_air_of_the_worked_example_has_42_moles_a_cubic_metre():
    # 101325/(8.314 288) = 42.3 mol/m3.
    assert air(7.0).molar_density == pytest.approx(42.3, abs=0.05)


def test_in_a_calm_turbulence_is_that_of_half_a_metre_a_second():
    assert (
        MarineAir(wind_speed=0.0).friction_velocity
        == MarineAir(wind_speed=0.5).friction_velocity
        > 0.0
    )


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"wind_speed": -1.0}, "true wind is -1 m/s"),
        ({"wind_speed": 41.0}, "true wind is 41 m/s"),
        ({"wind_speed": 7.0, "temperature": 15.0}, "air temperature is 15 K"),
        ({"wind_speed": 7.0, "pressure": 1013.0}, "air pressure is 1013 Pa"),
        ({"wind_speed": 7.0, "brunt_vaisala": 1.0}, "stability N is 1 1/s"),
        ({"wind_speed": 7.0, "charnock": 0.5}, "Charnock's constant is 0.5"),
    ],
)
def test_air_that_cannot_be_is_refused(options, said):
    with pytest.raises(MeasurementError, match=said):
        MarineAir(**options)


def test_buoyancy_alone_is_briggs_two_thirds_law():
    emission = replace(EMISSION, momentum_flux=0.0)
    distance = RISE_WIND * RISE_AGE
    # 1.609 = (3/(2 0.6^2))^(1/3), section 1.3 of the specification; Briggs' 1.6. Four digits are
    # printed.
    expected = 1.609 * 49.6 ** (1 / 3) * distance ** (2 / 3) / RISE_WIND
    np.testing.assert_allclose(rise(emission, RISE_WIND, np.array(RISE_AGE)), expected, rtol=4e-4)


def test_momentum_alone_is_briggs_one_third_law():
    emission = replace(EMISSION, buoyancy_flux=0.0)
    # (3 Fm x/(b^2 U^2))^(1/3) with b = 0.6.
    expected = (3.0 * 124.0 * RISE_WIND * RISE_AGE / (0.36 * RISE_WIND**2)) ** (1 / 3)
    np.testing.assert_allclose(rise(emission, RISE_WIND, np.array(RISE_AGE)), expected, rtol=1e-12)


def test_without_either_nothing_rises():
    emission = replace(EMISSION, buoyancy_flux=0.0, momentum_flux=0.0)
    assert not rise(emission, RISE_WIND, np.array(RISE_AGE)).any()
    assert not rise(emission, RISE_WIND, np.array(RISE_AGE), 0.02).any()


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
    i = round(40.0 / STEP)
    of = [
        spreads(EMISSION, air(7.0), HEIGHT, WIND[:1], 60.0, PlumeSettings(richardson=c)).relative_y[
            0, i
        ]
        for c in (0.1, 0.6)
    ]
    # Section 0, item 8: 15.4 to 16.5 m for C_r 0.1 to 0.6, at 200 m and 5 m/s; three digits.
    assert of == pytest.approx([15.4, 16.5], abs=0.06)


def test_spreads_of_a_table_do_not_depend_on_its_other_winds_and_ages():
    alone = spreads(EMISSION, air(7.0), HEIGHT, WIND[1:2], 60.0, PlumeSettings())
    among = spreads(EMISSION, air(7.0), HEIGHT, WIND, 120.0, PlumeSettings())
    np.testing.assert_array_equal(alone.relative_y[0, :600], among.relative_y[1, :600])
    np.testing.assert_array_equal(alone.meander_z[0, :600], among.meander_z[1, :600])


def test_stable_air_is_narrower_and_lower():
    neutral, stable = (
        spreads(EMISSION, air(7.0, brunt_vaisala=n), HEIGHT, WIND, 200.0, PlumeSettings())
        for n in (0.0, 0.02)
    )
    assert (stable.height[:, -1] < neutral.height[:, -1]).all()
    assert (
        np.hypot(stable.relative_z, stable.meander_z)[:, -1]
        < np.hypot(neutral.relative_z, neutral.meander_z)[:, -1]
    ).all()


def test_halving_the_step_of_the_axis_changes_nothing_that_is_printed():
    coarse = spreads(EMISSION, air(7.0), HEIGHT, WIND, 100.0, PlumeSettings())
    fine = spreads(EMISSION, air(7.0), HEIGHT, WIND, 100.0, PlumeSettings(), step=0.5 * STEP)
    # Euler's rule is of first order: a step of 0.1 s is 0.1 % of what is left of 100 s.
    np.testing.assert_allclose(
        coarse.relative_y[:, 100:1000], fine.relative_y[:, 200:2000:2], rtol=2e-3
    )
