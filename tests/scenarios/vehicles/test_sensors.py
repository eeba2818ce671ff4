import math

import numpy as np
import pytest

from gnc.estimation.navigation import MeasuredMotion
from scenarios.scenario.sections.equipment import SensorsConfig
from scenarios.vehicles.sensors import SensorErrors

TIME_STEP = 0.05
SENSORS = SensorsConfig(
    position_sigma_m=1.5,
    velocity_sigma_mps=0.1,
    airspeed_sigma_mps=0.3,
    airspeed_bias_mps=0.5,
    heading_sigma_deg=1.0,
    heading_bias_deg=2.0,
)
MOTION = MeasuredMotion(100.0, -50.0, 12.0, 3.0, 0.1)


def errors(sensors=SENSORS, *, steps, seed=2, time_step=TIME_STEP):
    return SensorErrors(
        sensors, steps=steps, time_step=time_step, generator=np.random.default_rng(seed)
    )


def readings(made, steps):
    """Return errors of north, east, their rates, airspeed and heading, shape (steps, 6)."""
    rows = []
    for step in range(steps):
        position, airspeed, heading = made.read(step, MOTION, 19.0, 0.5, satellites=True)
        rows.append([*np.subtract(position, MOTION[:4]), airspeed - 19.0, heading - 0.5])
    return np.array(rows)


def test_without_errors_sensors_tell_the_truth():
    position, airspeed, heading = errors(SensorsConfig(), steps=2).read(
        1, MOTION, 19.0, 0.5, satellites=True
    )
    assert (position, airspeed, heading) == (MOTION[:4], 19.0, 0.5)


def test_noise_and_biases_are_as_large_as_they_say():
    steps, biases = 4000, []
    for seed in range(60):
        made = errors(steps=steps if seed == 0 else 1, seed=seed)
        if seed == 0:
            found = readings(made, steps)
            # 4,000 of each: the deviation is known to 1.1 %; 4 sigma.
            expected = [0.1, 0.1, 0.3, math.radians(1.0)]
            np.testing.assert_allclose(found[:, 2:].std(axis=0), expected, rtol=0.045)
            # What the mean of a flight's airspeed is off by is its bias: 4 sigma of a mean of
            # 4,000.
            assert found[:, 4].mean() == pytest.approx(
                made.airspeed_bias, abs=4.0 * 0.3 / math.sqrt(4000)
            )
            assert abs(found[:, 5].mean()) <= math.radians(2.0) + 4.0 * math.radians(
                1.0
            ) / math.sqrt(4000)
        biases.append(made.airspeed_bias)
    assert np.abs(biases).max() <= 0.5
    # Even over 1 m/s: deviation 0.289 m/s; of 60, known to 5 % or so (the kurtosis of a uniform is
    # low), 4 sigma.
    assert np.std(biases) == pytest.approx(1.0 / math.sqrt(12.0), rel=0.25)


def test_the_error_of_satellite_navigation_wanders_with_a_time_constant_of_a_minute():
    # 12 s steps: the correlation from one to the next is e^(-12/60).
    found = readings(errors(steps=20_000, time_step=12.0), 20_000)[:, :2]
    for column in found.T:
        correlation = float(np.corrcoef(column[1:], column[:-1])[0, 1])
        # Standard error sqrt((1 - r^2)/n) = 0.004; 4 sigma.
        assert correlation == pytest.approx(math.exp(-0.2), abs=0.016)
        # Deviation of 20,000 correlated values: worth 2,000, known to 1.6 %; 4 sigma.
        assert column.std() == pytest.approx(1.5, rel=0.065)
