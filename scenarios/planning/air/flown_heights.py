"""Heights at which a flight may be: guard and mission have to reckon with the wind at all of them."""

import math

import numpy as np

from aircraft.atmosphere.wind import WindField
from gnc.errors import InfeasibleError
from scenarios.planning.limits import omega_max
from scenarios.schema.scenario import Scenario
from scenarios.world.faults import NOT_OF_AIRCRAFT
from scenarios.world.vessel import VesselTruth
from scenarios.world.world import mean_wind, wind_past

_RADII, _BEYOND, _TURN_RADII = 3.0, 1000.0, 4.0
"""How far from the vessel an inclined plume is climbed along at most: keep-out radii [-], or beyond one so far [m] and as many turn
radii [-], if that is more. Orbits lie nearer, unless their distance is given or a vessel has been silent for minutes."""

_SEA = 1.0
"""Height at which a gliding aircraft has come down [m]: below it, it is down within a second."""

_LOOKED_AT = 30
"""Heights at which the wind past the vessel is looked at [-]."""


def climbed_along(scenario: Scenario) -> float:
    """Return the distance from the vessel up to which an inclined plume is climbed along [m]."""
    radius, turn = scenario.keepout.radius_m, scenario.guidance.airspeed_mps / omega_max(scenario.guidance)
    return max(_RADII * radius, radius + _BEYOND + _TURN_RADII * turn, scenario.reference.standoff_radius_m or 0.0)


def flown_heights(scenario: Scenario, distance: float | None = None) -> list[float]:
    """Return the heights that are flown: at the start, the lowest and the highest, and the sea's if it may glide there [m].

    Parameters
    ----------
    scenario : the flight
    distance : from the vessel, up to which its plume is climbed along; the largest if not given [m]
    """
    flight = scenario.flight
    if scenario.emission.ship is not None:
        heights = [scenario.altitude, flight.altitude_min_m, flight.altitude_max_m]
    else:
        climb = math.tan(math.radians(scenario.plume.elevation_deg))
        risen = climb * (climbed_along(scenario) if distance is None else distance)
        heights = [scenario.altitude, scenario.source_height, scenario.source_height + risen]
    return [*heights, _SEA] if glides(scenario) else heights


def glides(scenario: Scenario) -> bool:
    """Return whether a part of the aircraft may fail, after which it leaves the vessel gliding."""
    return not scenario.declared_faults <= NOT_OF_AIRCRAFT


def check_not_outrun(scenario: Scenario, vessel: VesselTruth, distance: float) -> None:
    """Refuse a vessel that outruns the UAV through the air at a height that is flown.

    Parameters
    ----------
    scenario, vessel : the flight
    distance : from the vessel, up to which its plume is climbed along [m]

    Raises
    ------
    InfeasibleError : it does
    """
    wind: WindField = mean_wind(scenario, vessel)
    if wind.constant:
        # That is checked at the height of the funnel.
        return
    heights = flown_heights(scenario, distance)
    speed, ratio = scenario.guidance.airspeed_mps, scenario.following.speed_ratio_max
    looked_at = np.unique([*heights, *np.linspace(min(heights), max(heights), _LOOKED_AT)]).tolist()
    fastest, height = max((wind_past(scenario, vessel, height).greatest, height) for height in looked_at)
    if fastest >= ratio * speed:
        why = "to which it glides if a part of it fails" if height < min(flown_heights(scenario)[:3]) else "which is flown"
        raise InfeasibleError(
            f"at a height of {height:.0f} m, {why}, the vessel moves at up to {fastest:.1f} m/s through the air,"
            f" nu = {fastest / speed:.2f}; the UAV at {speed:g} m/s follows up to nu = {ratio:g}: fly faster, in less wind, or at"
            " another height"
        )
