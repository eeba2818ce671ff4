"""Air and readings of a flight that crosses a plume again and again, for the tests of sniffer and
estimate.
"""

from dataclasses import replace

import numpy as np

from measurement.gases import fsc_factor
from measurement.sniffer.channel import Channel
from measurement.sniffer.sniffer import Readings, Sniffer
from measurement.sniffer.spec import SnifferSpec, sensor_preset

BACKGROUND = np.array([1.0, 420.0, 0.2, 3.0])
"""SO2 [ppb], CO2 [ppm], NO [ppb], NO2 [ppb] of sea air."""

NOX = np.array([20.7, 2.3])
"""NO and NO2 per CO2 of a two-stroke engine of tier II, 14 g/kWh of NOx by EPA's ShipEF data, at 10
% of NO2 [ppb/ppm].
"""


def sniffer_of(*channels, rate_hz=1.0):
    return SnifferSpec(name="test", title="Test", rate_hz=rate_hz, channels=channels)


def plain_sniffer(so2_t90=20.0, co2_t90=4.0, *, so2_noise=0.0, co2_noise=0.0, rate_hz=1.0, **so2):
    """Return a sniffer of SO2 and CO2 that is known exactly."""
    return sniffer_of(
        Channel(gas="so2", t90_s=so2_t90, noise=so2_noise, **so2),
        Channel(gas="co2", t90_s=co2_t90, noise=co2_noise),
        rate_hz=rate_hz,
    )


def crossings(
    fsc_percent,
    *,
    duration=150.0,
    step=0.1,
    interval=9.5,
    width=0.6,
    peak=200.0,
    meander=0.6,
    seed=0,
    first=12.0,
):
    """Return the air of passes every ``interval``: Gaussians of CO2 whose height and time vary with
    ``meander``.
    """
    generator = np.random.default_rng(seed)
    time = np.arange(0.0, duration + step / 2.0, step)
    co2 = np.zeros(len(time))
    for middle in np.arange(first, duration, interval):
        height = peak * np.exp(-((meander * generator.normal()) ** 2))
        co2 += height * np.exp(
            -0.5 * ((time - middle - 0.6 * meander * generator.normal()) / width) ** 2
        )
    return BACKGROUND + co2[:, np.newaxis] * np.array([fsc_percent / fsc_factor(), 1.0, *NOX])


def read(instrument, air, *, seed=0, step=0.1):
    """Return the readings of an instrument that is as it is."""
    return Sniffer(instrument, generator=np.random.default_rng(seed), time_step=step).advance(air)


def flight(preset, fsc_percent, seed, *, duration=150.0):
    """Return readings of an instrument drawn from a preset, and the preset."""
    spec, generator = sensor_preset(preset), np.random.default_rng(seed)
    air = crossings(fsc_percent, duration=duration, seed=seed + 1000)
    return Sniffer(spec.drawn(generator), generator=generator, time_step=0.1).advance(air), spec


def changed(spec, gas, **fields):
    """Return a sniffer with fields of one channel changed."""
    return spec.with_channel(replace(spec.known(gas), **fields))


def with_column(readings, column, values):
    """Return readings with other ones of one gas, or of several."""
    other = readings.values.copy()
    other[:, column] = values
    return Readings(readings.time, other)
