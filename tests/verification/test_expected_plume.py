"""The expected plume, against the plume model that flights are simulated with."""

import math

import numpy as np
import pytest
from exhaust_cases import SENSOR

from gnc.estimation.plume_prior import expected_plume, rise
from measurement.emission.emission import emission_of
from measurement.emission.fuel import fuel_preset
from measurement.emission.ship import ship_preset
from measurement.gases import GASES
from measurement.plume.air import MarineAir
from measurement.plume.settings import PlumeSettings
from measurement.plume.spread import spreads

EMISSION = emission_of(ship_preset("container"), fuel_preset("mgo", 0.1), power=10e6)


@pytest.mark.parametrize(("apparent", "wind"), [(5.0, 7.0), (10.0, 10.0), (14.0, 5.0), (18.0, 8.0)])
def test_height_spreads_and_peak_are_near_those_of_the_plume_model(apparent: float, wind: float) -> None:
    distance = 220.0
    prior = expected_plume(
        distance=distance, apparent_wind=apparent, wind_speed=wind, wind_deviation=0.6, source_height=35.0, source_deviation=5.0,
        momentum_flux=EMISSION.momentum_flux, buoyancy_flux=EMISSION.buoyancy_flux, co2_rate=EMISSION.rates[GASES.index("co2")],
        load_deviation=0.3, sensor=SENSOR, lowest=20.0, highest=120.0,
    )  # fmt: skip
    age = distance / apparent
    of = spreads(EMISSION, MarineAir(wind_speed=wind), 35.0, np.array([apparent]), age, PlumeSettings())
    true = {name: float(np.interp(age, 0.1 * np.arange(getattr(of, name).shape[1]), getattr(of, name)[0])) for name in (
        "height", "relative_y", "relative_z", "meander_y", "meander_z")}  # fmt: skip
    # The tip's downwash, at most 1 m, is left out.
    assert prior.height == pytest.approx(true["height"], abs=1.5)
    # Within twice the deviation that is stated, of 25 %.
    for expected, name in (
        (prior.sigma_y, "relative_y"), (prior.sigma_z, "relative_z"), (prior.meander_y, "meander_y"), (prior.meander_z, "meander_z")
    ):  # fmt: skip
        assert abs(math.log(expected / true[name])) < 2.0 * 0.25, name
    peak = 1e6 * EMISSION.rates[1] / (2.0 * math.pi * apparent * true["relative_y"] * true["relative_z"] * 42.3)
    assert abs(math.log(prior.peak / peak)) < 2.0 * prior.peak_deviation


def test_rise_by_buoyancy_is_briggs_law() -> None:
    """1.609 F^(1/3) x^(2/3) / U: Briggs' 1.6."""
    assert rise(0.0, 49.6, 200.0, 10.0) == pytest.approx(1.609 * 49.6 ** (1 / 3) * 200.0 ** (2 / 3) / 10.0, rel=1e-3)
