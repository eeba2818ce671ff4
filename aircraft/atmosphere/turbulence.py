"""Low-altitude turbulence of MIL-F-8785C: how strong it is and how long its waves are.

Source: MIL-F-8785C, figures 10 and 11: between 10 and 1,000 ft, with the height h [ft] and the wind
at 20 ft, sigma_w = 0.1 W20, sigma_u = sigma_v = sigma_w / (0.177 + 0.000823 h)^0.4, L_w = h and L_u
= L_v = h / (0.177 + 0.000823 h)^1.2.

JSBSim computes the same from the height above mean sea level, and shapes them with a filter that
``atmosphere/turb-type`` chooses. Type 4 has the standard's Dryden spectra, across and vertical ones
with their second-order denominators. Type 3 keeps the standard deviations and replaces those two
spectra by first-order ones of half the time constant (MIL-STD-1797A as Yeager quotes it), which
moves energy from slow waves to fast ones; so type 4 is used here. One thing differs from the
standard in both: JSBSim turns the waves along and across the wind by the wind's direction the wrong
way. As the two are equally strong and long, only the shapes of their spectra change places, and not
at all in a wind along one of the four cardinal directions.
"""

import math
from dataclasses import dataclass

from aircraft.errors import AircraftError
from common.physics.units import METRES_PER_FOOT, METRES_PER_SECOND_PER_KNOT

JSBSIM_TYPE = 4
"""JSBSim's number for the Dryden spectra of MIL-F-8785C in Tustin's discretisation."""

_ALTITUDE_MIN_FT, _ALTITUDE_MAX_FT = 10.0, 1000.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Turbulence:
    """Strength of the turbulence.

    Attributes
    ----------
    wind_at_20ft : mean wind 20 ft above the surface that stirs it, W20 [m/s]; it need not be the
        wind that the aircraft drifts with
    severity : curve of figure 7 of MIL-F-8785C, 1 to 7, which JSBSim goes by above 1,000 ft; below,
        any of them switches it on

    Raises
    ------
    AircraftError : a value out of range
    """

    wind_at_20ft: float
    severity: int = 3

    def __post_init__(self) -> None:
        if not (math.isfinite(self.wind_at_20ft) and self.wind_at_20ft > 0.0):
            raise AircraftError(
                f"turbulence: wind_at_20ft is {self.wind_at_20ft} m/s; it must be finite and above 0; leave turbulence out for none"
            )
        if self.severity not in range(1, 8):
            raise AircraftError(
                f"turbulence: severity is {self.severity}; MIL-F-8785C has curves 1 to 7"
            )


TURBULENCE = {
    "light": Turbulence(wind_at_20ft=15.0 * METRES_PER_SECOND_PER_KNOT, severity=3),
    "moderate": Turbulence(wind_at_20ft=30.0 * METRES_PER_SECOND_PER_KNOT, severity=4),
    "severe": Turbulence(wind_at_20ft=45.0 * METRES_PER_SECOND_PER_KNOT, severity=6),
}
"""Turbulence by name: W20 of 15, 30 and 45 knots (MIL-F-8785C, figure 9), and the severities that
JSBSim's manual gives them."""


def intensities(altitude: float, wind_at_20ft: float) -> tuple[float, float, float]:
    """Return the standard deviations sigma_u, sigma_v, sigma_w [m/s] of the wind along, across and
    down.

    Parameters
    ----------
    altitude : above the surface [m]; below 10 ft as at 10 ft
    wind_at_20ft : [m/s]

    Raises
    ------
    AircraftError : an altitude above 1,000 ft, where other laws hold
    """
    vertical = 0.1 * wind_at_20ft
    horizontal = vertical / _shape(_height_ft(altitude)) ** 0.4
    return horizontal, horizontal, vertical


def scale_lengths(altitude: float) -> tuple[float, float, float]:
    """Return the scale lengths L_u, L_v, L_w [m] of the wind along, across and down at an altitude
    [m].

    They are MIL-F-8785C's; MIL-HDBK-1797 calls half of the last two by the same names and has its
    spectra make up for it.

    Raises
    ------
    AircraftError : an altitude above 1,000 ft, where other laws hold
    """
    height = _height_ft(altitude)
    horizontal = height / _shape(height) ** 1.2 * METRES_PER_FOOT
    return horizontal, horizontal, height * METRES_PER_FOOT


def _height_ft(altitude: float) -> float:
    height = altitude / METRES_PER_FOOT
    if not height <= _ALTITUDE_MAX_FT:
        highest = _ALTITUDE_MAX_FT * METRES_PER_FOOT
        raise AircraftError(
            f"low-altitude turbulence: altitude is {altitude:g} m; it holds up to {highest:g} m"
        )
    return max(height, _ALTITUDE_MIN_FT)


def _shape(height_ft: float) -> float:
    return 0.177 + 0.000823 * height_ft
