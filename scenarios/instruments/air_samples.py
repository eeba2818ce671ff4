"""The air along a flight, sampled at even times between its samples: the same in parts, while it
goes on, as at once.
"""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from common.physics import STANDARD_GRAVITY
from measurement.gases import GASES
from measurement.plume.fluctuating_plume import PlumeSample
from scenarios.world.background import Background
from scenarios.world.exhaust import Exhaust

Array = npt.NDArray[np.float64]

TIME_STEP = 0.05
"""Between the places at which the air is sampled [s]: a metre at 20 m/s, a tenth of the narrowest
plume.
"""

CLEAN_AIR = {"so2": 0.2, "co2": 420.0, "no": 0.1, "no2": 1.0}
"""Gases in clean air over the sea, in the units of readings; assumptions. They are far below the
noise, but for CO2.
"""

CO2 = GASES.index("co2")
"""Its column."""

PLACE_COLUMNS = ("north_m", "east_m", "altitude_m")
RATE_COLUMNS = ("velocity_north_mps", "velocity_east_mps", "climb_rate_mps")
"""Columns of a flight's record that say where it goes."""

_AIR_DENSITY = 1.225
"""Of the standard atmosphere at sea level [kg/m^3]."""


@dataclass(frozen=True)
class AirSamples:
    """The air at even times.

    Attributes
    ----------
    time : shape (n,) [s]
    air : gases, shape (n, 4), in the order and the units of ``measurement.gases``
    background_co2 : CO2 without the exhaust, shape (n,) [ppm]
    pressure : in the sensors less that at the sea [hPa], shape (n,)
    above : height over the plume's mean axis [m], shape (n,)
    plume : there
    """

    time: Array
    air: Array
    background_co2: Array
    pressure: Array
    above: Array
    plume: PlumeSample

    @classmethod
    def joined(cls, parts: "list[AirSamples]") -> "AirSamples":
        """Return parts that follow each other as one."""
        if len(parts) == 1:
            return parts[0]

        def whole(of: str) -> Array:
            return np.concatenate([getattr(part, of) for part in parts])

        def of_plume(of: str) -> Array:
            return np.concatenate([getattr(part.plume, of) for part in parts])

        plume = PlumeSample(*(of_plume(name) for name in PlumeSample._fields))
        names = ("time", "air", "background_co2", "pressure", "above")
        return cls(plume=plume, **{name: whole(name) for name in names})


class AirSampler:
    """Samples the air along a path that is given in parts. Between two places the path is the cubic
    through them and their rates.

    Parameters
    ----------
    exhaust, background : in the air
    dynamic_pressure_fraction : of the dynamic pressure that the inlet passes on to the sensors [-]
    """

    def __init__(
        self,
        exhaust: Exhaust,
        background: Background,
        *,
        dynamic_pressure_fraction: float,
    ) -> None:
        self._exhaust, self._background = exhaust, background
        self._fraction, self._taken = dynamic_pressure_fraction, 0
        self._clean = np.array([CLEAN_AIR[gas] for gas in GASES])

    def advance(self, time: Array, place: Array, rate: Array, airspeed: Array) -> AirSamples:
        """Return the samples whose time has come, before the last time given.

        Parameters
        ----------
        time : from the last one given before on, shape (n,) [s]
        place, rate : north, east and altitude, shape (n, 3) [m], and what they change by [m/s]
        airspeed : shape (n,) [m/s]
        """
        from scipy.interpolate import CubicHermiteSpline

        end = max(self._taken, math.ceil(time[-1] / TIME_STEP))
        at = TIME_STEP * np.arange(self._taken, end, dtype=np.float64)
        self._taken = end
        north, east, up = CubicHermiteSpline(time, place, rate)(at).T
        plume = self._exhaust.sample(at, north, east, up)
        flown = np.interp(at, time, airspeed)
        clean = np.tile(self._clean, (len(at), 1))
        clean[:, CO2] += self._background.at(at)
        return AirSamples(
            time=at,
            air=clean + self._exhaust.excess(plume.dilution),
            background_co2=clean[:, CO2],
            pressure=_AIR_DENSITY
            * (0.5 * self._fraction * flown**2 - STANDARD_GRAVITY * up)
            / 100.0,
            above=up - plume.axis_height,
            plume=plume,
        )
