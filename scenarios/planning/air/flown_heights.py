"""Heights at which a flight may be: guard and mission have to reckon with the wind at all of them."""

import math

import numpy as np

from aircraft.wind import WindField
from gnc.errors import InfeasibleError
from scenarios.planning.limits import omega_max
from scenarios.scenario.scenario import Scenario
from scenarios.world.faults import NOT_OF_AIRCRAFT
from scenarios.world.vessel import VesselTruth
from scenarios.world.world import TRACK_MARGIN, winds_past

_RADII, _BEYOND, _TURN_RADII = 3.0, 1000.0, 4.0
"""How far from the vessel an inclined plume is climbed along at most: keep-out radii [-], or beyond
one so far [m] and as many turn radii [-], if that is more. Orbits lie nearer, unless their distance
is given or a vessel has been silent for minutes.
"""

_SEA = 1.0
"""Height at which a gliding aircraft has come down [m]: below it, it is down within a second."""

_LOOKED_AT = 30
"""Heights at which the wind past the vessel is looked at [-]."""


def climbed_along(scenario: Scenario) -> float:
    """Return the distance from the vessel up to which an inclined plume is climbed along [m]."""
    radius, turn = (
        scenario.keepout.radius_m,
        scenario.guidance.airspeed_mps / omega_max(scenario.guidance),
    )
    return max(
        _RADII * radius,
        radius + _BEYOND + _TURN_RADII * turn,
        scenario.reference.standoff_radius_m or 0.0,
    )


def flown_heights(scenario: Scenario) -> list[float]:
    """Return the heights that are flown: at the start, the lowest and the highest, and the sea's if
    it may glide there [m].
    """
    crossed = _crossed_heights(scenario, climbed_along(scenario))
    return [*crossed, _SEA] if glides(scenario) else crossed


def glides(scenario: Scenario) -> bool:
    """Return whether a part of the aircraft may fail, after which it leaves the vessel gliding."""
    return not scenario.declared_faults <= NOT_OF_AIRCRAFT


def climbs(scenario: Scenario) -> bool:
    """Return whether the altitude changes before anything has failed."""
    return len(set(_crossed_heights(scenario, climbed_along(scenario)))) > 1


def _crossed_heights(scenario: Scenario, distance: float) -> list[float]:
    """Return the height at the start, the lowest and the highest of a plume that is climbed along
    up to a distance [m].
    """
    flight, source = scenario.flight, scenario.source_height
    if scenario.emission.ship is not None:
        return [scenario.altitude, flight.altitude_min_m, flight.altitude_max_m]
    return [
        scenario.altitude,
        source,
        source + math.tan(math.radians(scenario.plume.elevation_deg)) * distance,
    ]


def check_not_outrun(
    scenario: Scenario, vessel: VesselTruth, wind: WindField, distance: float
) -> None:
    """Refuse a vessel that outruns the UAV through the air at a height that is flown.

    Parameters
    ----------
    scenario, vessel, wind : the flight, and its mean wind
    distance : from the vessel, up to which its plume is climbed along [m]

    Raises
    ------
    InfeasibleError : it does
    """
    if wind.constant:
        # That is checked at the height of the funnel.
        return
    crossed = _crossed_heights(scenario, distance)
    heights = [*crossed, _SEA] if glides(scenario) else crossed
    speed, ratio = scenario.guidance.airspeed_mps, scenario.following.speed_ratio_max
    looked_at = np.unique([*heights, *np.linspace(min(heights), max(heights), _LOOKED_AT)]).tolist()
    past = winds_past(vessel, wind, looked_at, scenario.flight.duration_max_s + TRACK_MARGIN)
    fastest, height = max((of.greatest, height) for of, height in zip(past, looked_at, strict=True))
    if fastest >= ratio * speed:
        why = (
            "to which it glides if a part of it fails"
            if height < min(crossed)
            else "which is flown"
        )
        raise InfeasibleError(
            f"at a height of {height:.0f} m, {why}, the vessel moves at up to {fastest:.1f} m/s through the air,"
            f" nu = {fastest / speed:.2f}; the UAV at {speed:g} m/s follows up to nu = {ratio:g}: fly faster, in less wind, or at"
            " another height"
        )
