"""The readings of the UAV's sensors: the truth, with errors that are sampled for a whole flight at
once.
"""

import math
from itertools import accumulate

import numpy as np

from gnc.estimation.navigation import MeasuredMotion, SatelliteFix
from scenarios.scenario.sections.equipment import SensorsConfig

NAVIGATION_TIME = 60.0
"""Time constant with which the error of satellite navigation wanders [s]."""

Reading = tuple[SatelliteFix | None, float, float]
"""Satellite navigation, or None while it is lost; airspeed [m/s]; heading [rad]."""


class SensorErrors:
    """Errors of one flight's sensors.

    Parameters
    ----------
    sensors : how large they are
    steps : number of readings
    time_step : between them [s]
    generator : of their random numbers

    Attributes
    ----------
    airspeed_bias : of this flight [m/s]
    """

    def __init__(
        self,
        sensors: SensorsConfig,
        *,
        steps: int,
        time_step: float,
        generator: np.random.Generator,
    ) -> None:
        self.airspeed_bias = float(generator.uniform(-1.0, 1.0)) * sensors.airspeed_bias_mps
        heading_bias = math.radians(float(generator.uniform(-1.0, 1.0)) * sensors.heading_bias_deg)
        white = generator.standard_normal((6, steps))
        kept = math.exp(-time_step / NAVIGATION_TIME)
        before = generator.standard_normal(2)
        kicks = math.sqrt(1.0 - kept**2) * white[:2]
        # scipy.signal, which has such filters, takes longer to import than a flight needs.
        wander = [
            [*accumulate(row.tolist(), lambda error, kick: kept * error + kick, initial=first)][1:]
            for row, first in zip(kicks, before.tolist(), strict=True)
        ]
        errors = [
            sensors.position_sigma_m * np.array(wander).T,
            sensors.velocity_sigma_mps * white[2:4].T,
            self.airspeed_bias + sensors.airspeed_sigma_mps * white[4],
            heading_bias + math.radians(sensors.heading_sigma_deg) * white[5],
        ]
        self._errors: list[list[float]] = np.column_stack(errors).tolist()

    def read(
        self,
        step: int,
        motion: MeasuredMotion,
        airspeed: float,
        heading: float,
        *,
        satellites: bool,
    ) -> Reading:
        """Return the readings at a step.

        Parameters
        ----------
        step : number of the reading
        motion : true one
        airspeed, heading : true ones [m/s, rad]
        satellites : whether satellite navigation works
        """
        north, east, v_north, v_east, air, turned = self._errors[step]
        fix = None
        if satellites:
            fix = SatelliteFix(
                motion.north + north,
                motion.east + east,
                motion.velocity_north + v_north,
                motion.velocity_east + v_east,
            )
        return fix, airspeed + air, heading + turned
