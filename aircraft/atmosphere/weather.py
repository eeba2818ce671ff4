"""The air that an aircraft flies in: mean wind, turbulence and gusts."""

from dataclasses import dataclass

from aircraft.atmosphere.gusts import Gust, end_gust
from aircraft.atmosphere.turbulence import JSBSIM_TYPE, Turbulence
from aircraft.atmosphere.wind import CALM, WindField
from aircraft.errors import AircraftError
from aircraft.simulation.fdm import Fdm
from common.physics.units import METRES_PER_FOOT

_SEED_MAX = 2**31 - 1

_MILSPEC = "atmosphere/turbulence/milspec"


@dataclass(frozen=True, slots=True, kw_only=True)
class Weather:
    """The air of one flight.

    Attributes
    ----------
    wind : velocity of the air mass over time and height
    turbulence : about the wind, from the release on; None for smooth air
    gusts : discrete gusts, one at a time
    seed : of the turbulence, 0 to 2^31 - 1, which is what JSBSim holds

    Raises
    ------
    AircraftError : a value out of range
    """

    wind: WindField = CALM
    turbulence: Turbulence | None = None
    gusts: tuple[Gust, ...] = ()
    seed: int = 0

    def __post_init__(self) -> None:
        if not 0 <= self.seed <= _SEED_MAX:
            raise AircraftError(
                f"weather: seed is {self.seed}; JSBSim takes whole numbers from 0 to {_SEED_MAX}"
            )


def begin_turbulence(fdm: Fdm, weather: Weather) -> None:
    """Let the turbulence of ``weather`` rise from smooth air, if it has any; the same seed gives
    the same turbulence.

    It takes a few times ``scale_lengths()[0]`` over the airspeed to be as strong as it will be:
    some 30 s for 220 m at 20 m/s.
    """
    if weather.turbulence is None:
        return
    fdm.write("atmosphere/randomseed", weather.seed)
    fdm.write("atmosphere/turb-type", JSBSIM_TYPE)
    fdm.write(
        f"{_MILSPEC}/windspeed_at_20ft_AGL-fps", weather.turbulence.wind_at_20ft / METRES_PER_FOOT
    )
    fdm.write(f"{_MILSPEC}/severity", weather.turbulence.severity)


def end_weather(fdm: Fdm) -> None:
    """End turbulence and gusts and reset their models; the aircraft is to be placed next.

    Turbulence has to end before: JSBSim places an aircraft with a time step of 0, by which its
    turbulence divides.
    """
    fdm.write(f"{_MILSPEC}/severity", 0)
    end_gust(fdm)
    fdm.renew()
