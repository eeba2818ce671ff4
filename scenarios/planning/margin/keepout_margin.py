"""The keep-out margin of a flight in operational conditions: where its orbit lies, and what the
keep-out guard keeps off.
"""

import math
from dataclasses import dataclass

from common.physics import SECONDS_PER_HOUR
from gnc.estimation.error_budget import deviations
from gnc.estimation.vessel import FilterParameters, Tube, VesselLimits, VesselReport, tube
from scenarios.planning.margin.report_scatter import mean_interval, scatter_allowance
from scenarios.planning.margin.tracking_spread import CALM_AIR_SPREAD, SpreadTable, planned_margin
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.equipment import VesselReportsConfig
from scenarios.vehicles.sensors import NAVIGATION_TIME

VESSEL_ACCELERATION, VESSEL_MEMORY = 0.02, 40.0
"""Standard deviation [m/s^2] and time constant [s] of the acceleration that the vessel's filter
reckons with: a ship's.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class KeepoutMargin:
    """A planned margin.

    Attributes
    ----------
    tracking_sigma : predicted standard deviation of the tracking error towards the vessel [m]
    total : that the orbit keeps from the keep-out area [m]
    reach : how far the vessel may be from where it is taken to be, as long as its reports are not
        overdue [m]
    """

    tracking_sigma: float
    total: float
    reach: float


def filter_parameters(reports: VesselReportsConfig) -> FilterParameters:
    """Return the filter for a vessel's reports."""
    return FilterParameters(
        position_sigma=0.0 if reports.exact else reports.position_sigma_m,
        velocity_sigma=0.0 if reports.exact else reports.velocity_sigma_mps,
        acceleration=VESSEL_ACCELERATION,
        memory=VESSEL_MEMORY,
    )


def vessel_limits(scenario: Scenario, horizon: float) -> VesselLimits:
    """Return what the vessel and its reports keep within.

    Errors are normally distributed and so have no limit; the one taken is exceeded as often as the
    keep-out area may be touched.

    Parameters
    ----------
    scenario : the flight
    horizon : duration of a turn away [s]
    """
    f, reports = scenario.following, scenario.reports
    known = filter_parameters(reports)
    return VesselLimits(
        acceleration=f.vessel_acceleration_mps2,
        speed_max=math.inf if f.vessel_speed_max_mps is None else f.vessel_speed_max_mps,
        position_sigma=math.hypot(known.position_sigma, scenario.sensors.position_sigma_m),
        velocity_sigma=known.velocity_sigma,
        deviations=_deviations(scenario),
        horizon=horizon,
    )


def _deviations(scenario: Scenario) -> float:
    """Return how many standard deviations errors exceed as often as the keep-out area may be
    touched [-].
    """
    flight, reports = scenario.flight, scenario.reports
    # A flight begins with a report, however rare they are.
    reported = SECONDS_PER_HOUR / flight.duration_max_s
    if not reports.exact:
        reported += SECONDS_PER_HOUR / mean_interval(reports.interval_s)
    wanders = scenario.sensors.position_sigma_m > 0.0
    return deviations(
        scenario.following.touches_per_hour,
        ageing=reported,
        correlation_times=(NAVIGATION_TIME,) if wanders else (),
    )


def widest_tube(
    limits: VesselLimits, reports: VesselReportsConfig, *, plan_period: float, noise: float = 0.0
) -> Tube:
    """Return the disc about a vessel whose newest report is as old as it becomes where none is
    missing, centre in the origin.

    It is as much larger as discs reach farther because reports scatter
    (``scenarios.planning.margin.report_scatter``), or, about a vessel that is known exactly, because the
    vehicle's own position and velocity do.

    Parameters
    ----------
    limits, reports : what vessel and reports keep within, and how often reports come
    plan_period : time between looks at them [s]
    noise : how much nearer noise of satellite navigation takes the vehicle
        (``scenarios.planning.margin.satellite_noise``) [m]
    """
    age = plan_period + (0.0 if reports.exact else reports.interval_s[1] + reports.latency_max_s)
    oldest = tube(VesselReport(-age, 0.0, 0.0, 0.0, 0.0), limits, 0.0)
    if reports.exact:
        return oldest._replace(radius=oldest.radius + noise)
    allowance = scatter_allowance(
        limits,
        filter_parameters(reports),
        reports.interval_s,
        reports.latency_max_s,
        plan_period=plan_period,
        planned=oldest.reach(limits.horizon),
    )
    return oldest._replace(radius=oldest.radius + allowance)


def tracking_level(
    scenario: Scenario, spreads: SpreadTable | None, nu: float
) -> tuple[float, float]:
    """Return the standard deviation of the tracking error towards the vessel, and what it exceeds
    as rarely as allowed [m].
    """
    spread = spreads.at(nu) if spreads else CALM_AIR_SPREAD
    return spread.radial, planned_margin(
        spread, touches_per_hour=scenario.following.touches_per_hour
    )
