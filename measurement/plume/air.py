"""Turbulence and density of the air over the sea, from the true wind."""

import math
from dataclasses import dataclass, field

from measurement.emission.emission import (
    AIR_PRESSURE,
    AIR_TEMPERATURE,
    GAS_CONSTANT,
    GRAVITY,
    check_air,
)
from measurement.errors import MeasurementError

KARMAN = 0.4
"""Von Karman's constant [-], as AERMOD takes it."""

_VISCOSITY = 1.5e-5
"""Kinematic viscosity of air [m2/s] at 15 degC."""

_CALM = 0.5
"""Wind below which turbulence is that of this wind [m/s]: the logarithmic profile has no limit at
calm; an assumption.
"""

_WIND_MAX = 40.0
"""Largest wind [m/s]; no UAV flies in more, and the drag of the sea is not that of Charnock."""

_ROUNDS = 60
"""Rounds of the fixed point of the friction velocity; each takes at least half of what is left, and
the last does not move it.
"""


@dataclass(frozen=True, kw_only=True)
class MarineAir:
    """The air over the sea: neutral, or stable above.

    u* = 0.4 U10/ln(10/z0) with z0 = alpha u*^2/g + 0.11 nu/u*; sigma_v = 1.9 u* and sigma_w = 1.3
    u*, eps = u*^3/(0.4 z), and the mechanical mixing height is 2300 u*^1.5. Turbulence belongs to
    the true wind, dilution to the apparent wind.

    Attributes
    ----------
    wind_speed : true wind at 10 m [m/s], 0 to 40
    temperature, pressure : [K, Pa]
    brunt_vaisala : N of the air that the plume rises through [1/s], 0 for neutral
    charnock : alpha [-]; the range over sea is 0.011 to 0.018
    friction_velocity : u* [m/s], which follows

    Raises
    ------
    MeasurementError : a value is out of its range

    Sources: Charnock's alpha = 0.0144, J. R. Garratt, Monthly Weather Review 105 (1977); sigma_v^2
    = 3.6 u*^2, AERMOD, EPA-454/R-03-004, eq. 41, where 3 to 5 is the range (Panofsky and Dutton);
    sigma_w = 1.3 u*, there too, from memory. Both are taken without their decay with height.
    """

    wind_speed: float
    temperature: float = AIR_TEMPERATURE
    pressure: float = AIR_PRESSURE
    brunt_vaisala: float = 0.0
    charnock: float = 0.0144
    friction_velocity: float = field(init=False)

    def __post_init__(self) -> None:
        check_air(self.temperature, self.pressure)
        if not 0.0 <= self.wind_speed <= _WIND_MAX:
            raise MeasurementError(
                f"true wind is {self.wind_speed:g} m/s at 10 m; give 0 to {_WIND_MAX:g}"
            )
        if not 0.0 <= self.brunt_vaisala <= 0.1:
            raise MeasurementError(
                f"stability N is {self.brunt_vaisala:g} 1/s; give 0 (neutral) to 0.1, usually below 0.03"
            )
        if not 0.005 <= self.charnock <= 0.05:
            raise MeasurementError(
                f"Charnock's constant is {self.charnock:g}; give 0.005 to 0.05, over sea 0.011 to 0.018"
            )
        object.__setattr__(self, "friction_velocity", self._friction_velocity())

    @property
    def sigma_v(self) -> float:
        """Standard deviation of the wind across [m/s]."""
        return 1.9 * self.friction_velocity

    @property
    def sigma_w(self) -> float:
        """Standard deviation of the wind's vertical component [m/s]."""
        return 1.3 * self.friction_velocity

    @property
    def mixing_height(self) -> float:
        """Mechanical mixing height [m] (Venkatram, as in AERMOD)."""
        return float(2300.0 * self.friction_velocity**1.5)

    @property
    def molar_density(self) -> float:
        """Moles of air per volume, p/RT [mol/m3]."""
        return self.pressure / (GAS_CONSTANT * self.temperature)

    def dissipation(self, height: float) -> float:
        """Return the rate of dissipation [m2/s3] at a ``height`` above 0 [m]."""
        return self.friction_velocity**3 / (KARMAN * height)

    def _friction_velocity(self) -> float:
        wind = max(self.wind_speed, _CALM)
        friction = 0.03 * wind
        for _ in range(_ROUNDS):
            roughness = self.charnock * friction**2 / GRAVITY + 0.11 * _VISCOSITY / friction
            friction = KARMAN * wind / math.log(10.0 / roughness)
        return friction
