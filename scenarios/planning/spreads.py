"""The spread of the tracking error that turbulence will cause in a trial's flights."""

from aircraft.atmosphere.turbulence import TURBULENCE
from aircraft.simulation.fdm import Fdm
from aircraft.spec import AircraftSpec
from aircraft.units import METRES_PER_FOOT
from innerloop.analysis.dryden import low_altitude_turbulence
from innerloop.designs.cache import Designed
from scenarios.margin.keepout_margin import SpreadTable
from scenarios.margin.tracking_spread import tracking_spread
from scenarios.planning.reference import oscillation_at
from scenarios.planning.sea_parameters import speed_hold, tracking_parameters
from scenarios.schema.sea_config import SeaScenario
from scenarios.vehicles.sea_airframe import Airframe

SPREAD_RATIOS = (0.1, 0.3, 0.5, 0.7, 0.9)
"""Speed ratios at which the spread is predicted [-]; it hardly depends on them."""


def predicted_spreads(scenario: SeaScenario, found: Designed | None, airframe: Airframe) -> dict[str, SpreadTable]:
    """Return the predicted spread at each level of turbulence that flights of a trial may have; none for a kinematic vehicle."""
    if found is None or scenario.fidelity == "kinematic":
        return {}
    drawn = next((draw.choice for draw in scenario.draws if draw.key == "turbulence.level" and draw.choice), None)
    levels = [str(level) for level in drawn or (scenario.turbulence.level,) if level != "none"]
    return {level: _spread_table(scenario, found, airframe, level) for level in levels}


def _spread_table(scenario: SeaScenario, found: Designed, airframe: Airframe, level: str) -> SpreadTable:
    schedule = found.design.schedule
    air = low_altitude_turbulence(scenario.plume.source_height_m, TURBULENCE[level].wind_at_20ft)
    guidance, hold, span = tracking_parameters(scenario, airframe), speed_hold(scenario, airframe), _wing_span(schedule.spec)
    spreads = [
        tracking_spread(schedule, air, oscillation_at(scenario.guidance, nu), guidance, hold, span=span) for nu in SPREAD_RATIOS
    ]
    return SpreadTable(speed_ratios=SPREAD_RATIOS, spreads=tuple(spreads))


def _wing_span(spec: AircraftSpec) -> float:
    """Return the wing's span [m]."""
    return Fdm(spec).read("metrics/bw-ft") * METRES_PER_FOOT
