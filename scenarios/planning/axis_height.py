"""How high the guidance expects the plume's axis to be."""

import math

from gnc.mission.axis_height import AxisHeight
from scenarios.schema.scenario import Scenario
from scenarios.world.exhaust import emission
from scenarios.world.vessel import VesselTruth


def axis_height(scenario: Scenario, vessel: VesselTruth) -> AxisHeight:
    """Return the height that the guidance expects: of exhaust at the load that the vessel's speed takes.

    Raises
    ------
    MeasurementError : the ship has no such speed
    """
    source, climb = scenario.plume.source_height_m, math.tan(math.radians(scenario.plume.elevation_deg))
    if scenario.emission.ship is None:
        return AxisHeight(source=source, climb=climb)
    _, _, v_north, v_east = vessel.motion(0.0)
    expected = emission(scenario, speed=math.hypot(v_north, v_east))
    return AxisHeight(
        source=source,
        climb=climb,
        momentum_flux=expected.momentum_flux,
        buoyancy_flux=expected.buoyancy_flux,
        lowest=scenario.flight.altitude_min_m,
        highest=scenario.flight.altitude_max_m,
    )
