from dataclasses import replace

import numpy as np
import pytest
from plume_cases import EMISSION, HEIGHT, air

from measurement.plume.spread import STEP, PlumeSettings, spreads

WIND = np.array([5.0, 10.0, 20.0])
COLD_POINT = replace(
    EMISSION, buoyancy_flux=0.0, momentum_flux=0.0, stack_diameter=1e-4, wake_spread=0.0
)


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
