import pytest
from plume_cases import air

from measurement.errors import MeasurementError
from measurement.plume.spread import MarineAir


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
