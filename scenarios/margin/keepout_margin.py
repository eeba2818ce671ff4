"""The keep-out margin of a flight in operational conditions: allowances for turbulence, navigation and the vessel's reports."""

import math
from dataclasses import dataclass

from gnc.compose import vessel_filter
from gnc.estimation.vessel_filter import VesselReport
from gnc.parameters import FilterParameters
from scenarios.margin.tracking_spread import CALM_AIR_SPREAD, SpreadTable, planned_margin
from scenarios.schema.equipment import VesselReportsConfig
from scenarios.schema.scenario import Scenario
from scenarios.vehicles.sensors import NAVIGATION_TIME

VESSEL_ACCELERATION, VESSEL_MEMORY = 0.02, 40.0
"""Standard deviation [m/s^2] and time constant [s] of the acceleration that the vessel's filter reckons with: a ship's."""

_SEEN_SHARE, _FLOWN_SHARE = 0.6, 0.5
"""Shares of the margin that the keep-out guard holds [-]: of what is not seen exactly, and of what is flown with turbulence.

An orbit that had no room beyond would meet it at every swing.
"""

_GUARD_AHEAD = 3.0
"""How far ahead the keep-out guard looks from the near side of the orbit [s]: the UAV then turns already."""

_STEADY = 40
"""Reports after which the filter's covariance no longer changes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class KeepoutMargin:
    """A planned margin.

    Attributes
    ----------
    tracking_sigma : predicted standard deviation of the tracking error towards the vessel [m]
    total : that the orbit keeps from the keep-out area [m]
    guard : the part of it that the keep-out guard holds [m]
    """

    tracking_sigma: float
    total: float
    guard: float


def filter_parameters(reports: VesselReportsConfig) -> FilterParameters:
    """Return the filter for a vessel's reports."""
    return FilterParameters(
        position_sigma=0.0 if reports.exact else reports.position_sigma_m,
        velocity_sigma=0.0 if reports.exact else reports.velocity_sigma_mps,
        acceleration=VESSEL_ACCELERATION,
        memory=VESSEL_MEMORY,
    )


def keepout_margin(scenario: Scenario, spreads: SpreadTable | None, nu: float) -> KeepoutMargin:
    """Return the margin of a flight.

    It is what random errors reach as often as is allowed, tracking, navigation and the vessel's place together; how far a vessel
    gets that begins to manoeuvre just after a report; what is kept at least; and room for the guard to look ahead.

    Parameters
    ----------
    scenario : the flight
    spreads : in its turbulence, none in still air
    nu : speed ratio [-]
    """
    f, reports = scenario.following, scenario.reports
    spread = spreads.at(nu) if spreads else CALM_AIR_SPREAD
    navigation = scenario.sensors.position_sigma_m
    seen, drift = _seen(reports), 0.5 * f.vessel_acceleration_mps2 * (reports.interval_s[1] + reports.latency_max_s) ** 2
    between = max(1.0, 0.5 * sum(reports.interval_s))
    sigma, rate = math.hypot(seen, navigation), math.hypot(seen / between, navigation / NAVIGATION_TIME)
    random = planned_margin(spread, other_sigma=sigma, other_sigma_rate=rate, touches_per_hour=f.touches_per_hour)
    unseen = planned_margin(CALM_AIR_SPREAD, other_sigma=sigma, other_sigma_rate=rate, touches_per_hour=f.touches_per_hour)
    guard = _SEEN_SHARE * (drift + unseen) + _FLOWN_SHARE * (random - unseen + f.margin_min_m)
    # The guard's disc swells as it looks ahead; the orbit leaves it that much room where it turns.
    room = (f.speed_error_mps + 0.5 * f.vessel_acceleration_mps2 * _GUARD_AHEAD) * _GUARD_AHEAD
    return KeepoutMargin(tracking_sigma=spread.radial, total=drift + random + f.margin_min_m + room, guard=guard)


def _seen(reports: VesselReportsConfig) -> float:
    """Return the standard deviation of the vessel's place just before a report, after many at their longest interval [m]."""
    if reports.exact:
        return 0.0
    found, interval = vessel_filter(filter_parameters(reports)), reports.interval_s[1]
    for i in range(_STEADY):
        found.report(VesselReport(i * interval, 0.0, 0.0, 0.0, 0.0))
    return found.at(_STEADY * interval + reports.latency_max_s).sigma
