"""A made plume that keeps to the filter's own model, and ways across it."""

import math
from dataclasses import dataclass

import numpy as np

from gnc.estimation.plume.estimator import PlumeEstimator
from gnc.estimation.plume.prior import BUOYANT_SPREAD, GasSensor, PlumePrior

SENSOR = GasSensor(interval=0.2, delay=1.0, time_constant=0.43, noise=0.5)

PRIOR = PlumePrior(
    distance=230.0,
    apparent_wind=8.0,
    source_height=40.0,
    source_deviation=8.0,
    height=65.0,
    height_deviation=12.0,
    bearing_deviation=0.06,
    sigma_y=9.0,
    sigma_z=9.0,
    sigma_deviation=0.2,
    meander_y=5.0,
    meander_z=4.0,
    meander_length=1e3,
    meander_time=12.0,
    peak=120.0,
    peak_deviation=0.5,
    sensor=SENSOR,
    lowest=20.0,
    highest=120.0,
)

SWING, PERIOD = 60.0, 18.0
"""Half-width of the way across [m], and its period [s]: two passes, at 21 m/s on the axis."""


@dataclass
class MadePlume:
    """A Gaussian plume whose centre is drawn anew for each pass, and its sensor: height and offset
    of the mean axis [m], and peak at the expected height [ppm].
    """

    height: float
    offset: float = 0.0
    peak: float = 120.0
    prior: PlumePrior = PRIOR
    seed: int = 0
    meander: float = 1.0

    def fly(
        self,
        estimator: PlumeEstimator,
        altitudes: list[float],
        *,
        mirrored: bool = False,
        broken: float | None = None,
    ) -> None:
        """Fly a pass at each altitude; a sensor that is ``broken`` reads that value [ppm]."""
        generator = np.random.default_rng(self.seed)
        step, sensor, prior = 0.05, self.prior.sensor, self.prior
        every, late = round(sensor.interval / step), round(sensor.delay / step)
        lagged, waiting = 0.0, [0.0] * late
        # A plume that rises less is narrower and stronger.
        narrower = spread_at(prior, self.height) / prior.sigma_z
        meander = self.meander * np.array([prior.meander_y, prior.meander_z])
        for number, altitude in enumerate([*altitudes, altitudes[-1]]):
            middle, height = [self.offset, self.height] + meander * generator.standard_normal(2)
            up = (altitude - height) / (narrower * prior.sigma_z)
            for i in range(round(0.5 * PERIOD / step)):
                across = SWING * math.cos(math.pi * (number + i * step / (0.5 * PERIOD)))
                off = (across - middle) / (narrower * prior.sigma_y)
                waiting.append(self.peak / narrower**2 * math.exp(-0.5 * (off**2 + up**2)))
                lagged += (waiting.pop(0) - lagged) * -math.expm1(-step / sensor.time_constant)
                estimator.predict(step)
                reading = 420.0 + lagged + sensor.noise * generator.standard_normal()
                if i % every:
                    reading = math.nan
                elif broken is not None:
                    reading = broken
                estimator.update(prior.distance, -across if mirrored else across, altitude, reading)


def spread_at(prior: PlumePrior, height: float) -> float:
    """Return the spread in height of an axis so high [m]: the part that buoyancy makes goes with
    the rise.
    """
    climbed, expected = float(prior.rise_of(height)), float(prior.rise_of(prior.height))
    return math.sqrt(prior.sigma_z**2 + BUOYANT_SPREAD**2 * (climbed**2 - expected**2))


def estimated(plume: MadePlume, altitudes: list[float]) -> PlumeEstimator:
    """Return the estimator after passes at some altitudes."""
    estimator = PlumeEstimator(plume.prior)
    plume.fly(estimator, altitudes)
    return estimator
