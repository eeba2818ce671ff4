"""A plume of smoke: the straight axis, about which it rises, disperses, meanders and bends with the
vessel's own track.
"""

import math

import numpy as np

from aircraft.wind import WindField
from measurement.emission import Emission
from measurement.plume.fluctuating_plume import FluctuatingPlume
from measurement.plume.spread import MarineAir, PlumeSettings
from scenarios.world.plume import StraightPlume, plume_model
from scenarios.world.vessel import VesselTruth

_TRACK_INTERVAL = 0.5
"""Time between the places of the vessel that the smoke comes from [s]: at 10 m/s a turn at 1 deg/s
is a chord to 6 mm.
"""


@plume_model("fluctuating")
class FluctuatingSmoke(StraightPlume):
    """Gifford's fluctuating plume about an axis that is that of ``StraightPlume`` near the vessel.

    The vessel has come on its first course and at its first speed.
    """

    SETTINGS = PlumeSettings

    def dispersion(
        self,
        emission: Emission,
        air: MarineAir,
        *,
        vessel: VesselTruth,
        wind: WindField,
        duration: float,
        source_height: float,
        settings: PlumeSettings,
        seed: int,
    ) -> FluctuatingPlume:
        """Return one realisation of the smoke, in the frame of the air mass.

        Parameters
        ----------
        emission, air : what leaves the funnel, and into what
        vessel, wind : motion of the vessel over the ground, and of the air
        duration : to be covered [s]
        source_height : of the funnel's mouth above the sea [m]
        settings, seed : of the realisation

        Raises
        ------
        MeasurementError : the apparent wind is too weak for a plume
        """
        before = math.ceil(settings.age_max / _TRACK_INTERVAL)
        steps = np.arange(-before, math.ceil(duration / _TRACK_INTERVAL) + 2, dtype=np.float64)
        time = _TRACK_INTERVAL * steps
        place = np.array([vessel.motion(t)[:2] for t in np.maximum(time, 0.0).tolist()])
        _, _, v_north, v_east = vessel.motion(0.0)
        earlier = np.minimum(time, 0.0)
        moved_north, moved_east = wind.displacement(time, source_height)
        return FluctuatingPlume(
            emission,
            air,
            time=time,
            north=place[:, 0] + earlier * v_north - moved_north,
            east=place[:, 1] + earlier * v_east - moved_east,
            source_height=source_height,
            settings=settings,
            seed=seed,
        )
