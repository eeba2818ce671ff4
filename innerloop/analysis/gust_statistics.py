"""Intensities and scale lengths of low-altitude turbulence at one altitude."""

from dataclasses import dataclass

from aircraft.weather import intensities, scale_lengths


@dataclass(frozen=True, slots=True, kw_only=True)
class GustStatistics:
    """Turbulence at one altitude.

    Attributes
    ----------
    horizontal, vertical : standard deviations of the wind along and across, and down [m/s]
    horizontal_length, vertical_length : scale lengths of the same [m]
    """

    horizontal: float
    vertical: float
    horizontal_length: float
    vertical_length: float


def low_altitude_turbulence(altitude: float, wind_at_20ft: float) -> GustStatistics:
    """Return the turbulence at an altitude [m] over a surface with a mean wind [m/s] 20 ft above
    it.

    Raises
    ------
    AircraftError : as ``aircraft.weather.intensities``
    """
    horizontal, _, vertical = intensities(altitude, wind_at_20ft)
    horizontal_length, _, vertical_length = scale_lengths(altitude)
    return GustStatistics(
        horizontal=horizontal,
        vertical=vertical,
        horizontal_length=horizontal_length,
        vertical_length=vertical_length,
    )
