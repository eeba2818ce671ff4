"""What tests of a plume's axis share: a vehicle astern of a vessel, and exhaust that rises."""

from gnc.estimation.navigation import AirMotion
from gnc.estimation.vessel import SteadyTarget
from gnc.mission.axis_height import AxisHeight
from gnc.mission.plume_axis import Situation
from gnc.reference.moving_centre import CentreParameters, MovingCentre

SPEED, PLAN_TIME = 19.42, 0.5
RISING = AxisHeight(
    source=35.0, momentum_flux=124.0, buoyancy_flux=49.6, lowest=23.0, highest=117.0
)


def situation(*, wind=(0.0, 0.0), vessel=(8.0, 0.0)):
    """Return a vehicle astern of a vessel, whose centre of oscillation has found its place."""
    own = AirMotion(
        ground_north=-230.0, ground_east=0.0, course=0.0, wind_north=wind[0], wind_east=wind[1]
    )
    parameters = CentreParameters(
        distance_min=203.0,
        speed_ratio_max=0.97,
        along=(10.0,) * 3,
        across=(20.0,) * 3,
        plume_heading=None,
        vessel_course=0.0,
        apparent_wind_min=1.0,
        speed=SPEED,
        heading_rate_max=0.5,
    )
    centre = MovingCentre(parameters)
    still = {"acceleration_north": 0.0, "acceleration_east": 0.0, "additional_range": 0.0}
    centre.move(
        PLAN_TIME,
        vessel_north=vessel[0],
        vessel_east=vessel[1],
        wind_north=wind[0],
        wind_east=wind[1],
        **still,
    )
    return Situation(
        own=own, target=SteadyTarget(*vessel), centre=centre, speed=SPEED, plan_time=PLAN_TIME
    )
