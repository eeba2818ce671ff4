import numpy as np
import pytest
from plume_cases import HEIGHT, straight

from measurement.plume.fluctuating_plume import Meander

pytestmark = pytest.mark.slow

SCALE = 90.0


def covariance(distance, integral_scale=SCALE):
    # Section 1.5 of the specification: (1 + |l|/L) exp(-|l|/L), whose integral scale is 2 L.
    ratio = np.abs(distance) / (0.5 * integral_scale)
    return (1.0 + ratio) * np.exp(-ratio)


def correlation(values, lag):
    return float(np.mean(values[:-lag] * values[lag:]))


def test_the_process_has_the_covariance_that_it_should():
    length, step = 4e6, 15.0
    process = Meander(length, SCALE, np.random.default_rng(5))
    values = process.at(np.arange(0.0, length, step))
    # About length/(2 SCALE) = 22,000 independent values: a standard error of 0.007 and, with
    # Bartlett's sum, of at most 0.01.
    assert np.mean(values) == pytest.approx(0.0, abs=0.03)
    assert np.var(values) == pytest.approx(1.0, abs=0.03)
    for lag in (1, 2, 4, 8, 16):
        assert correlation(values, lag) == pytest.approx(covariance(lag * step), abs=0.03)
    # Gaussian: kurtosis 3, whose standard error is sqrt(24/22,000) = 0.03.
    assert np.mean(values**4) == pytest.approx(3.0, abs=0.2)


@pytest.mark.parametrize(("name", "scale"), [("across", 2.5 * HEIGHT), ("up", 0.5 * HEIGHT)])
def test_successive_crossings_are_correlated_as_the_integral_scale_says(name, scale):
    wind, interval, until = 3.0, 9.5, 60000.0
    plume = straight(wind, 8.0, since=-100.0, until=until, age_max=60.0)
    time = np.arange(0.0, until, interval / 2.0)
    sample = plume.sample(time, wind * time - 150.0, np.zeros(len(time)), np.full(len(time), 70.0))
    centre = sample.centre_across if name == "across" else sample.centre_height - sample.axis_height
    # The centre is seldom at the sea here, where it is mirrored.
    values = centre / centre.std()
    # 60,000 s times 3 m/s over twice the integral scale: at least 1,000 independent values; three
    # standard errors are 0.1.
    for crossings in (1, 2, 4):
        assert correlation(values, 2 * crossings) == pytest.approx(
            covariance(crossings * interval * wind, scale), abs=0.1
        )
    # Paper's interval: across, successive crossings see nearly the same meander; up, hardly.
    assert correlation(values, 2) > 0.7 if name == "across" else correlation(values, 2) < 0.4
