"""The keep-out margin of a flight over the real sea: what turbulence, navigation and the vessel's reports may take from it."""

import math
from dataclasses import dataclass

from gnc.estimation.vessel_filter import VesselFilter, VesselReport
from scenarios.margin.tracking_spread import Spread, planned_margin
from scenarios.schema.sea_config import Reports, SeaScenario
from scenarios.vehicles.sensors import NAVIGATION_TIME

_MANOEUVRE, _MANOEUVRE_MEMORY = 0.02, 40.0
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
class SpreadTable:
    """Predicted spread of the tracking error.

    Attributes
    ----------
    speed_ratios : nu, ascending [-]
    spreads : at each of them
    """

    speed_ratios: tuple[float, ...]
    spreads: tuple[Spread, ...]

    def at(self, nu: float) -> Spread:
        """Return the spread at the nearest speed ratio."""
        return min(zip(self.speed_ratios, self.spreads, strict=True), key=lambda entry: abs(entry[0] - nu))[1]


STILL = Spread(along=0.0, across=0.0, radial=0.0, radial_rate=0.0, airspeed=0.0, airspeed_rate=0.0, airspeed_limit=1.0)
"""The spread in air that does not move."""


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


def vessel_filter(reports: Reports) -> VesselFilter:
    """Return a fresh filter for a vessel's reports."""
    return VesselFilter(
        position_sigma=0.0 if reports.exact else reports.position_sigma_m,
        velocity_sigma=0.0 if reports.exact else reports.velocity_sigma_mps,
        acceleration=_MANOEUVRE,
        memory=_MANOEUVRE_MEMORY,
    )


def keepout_margin(scenario: SeaScenario, spreads: SpreadTable | None, nu: float) -> KeepoutMargin:
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
    spread = spreads.at(nu) if spreads else STILL
    navigation = scenario.sensors.position_sigma_m
    seen, drift = _seen(reports), 0.5 * f.vessel_acceleration_mps2 * (reports.interval_s[1] + reports.latency_max_s) ** 2
    between = max(1.0, 0.5 * sum(reports.interval_s))
    sigma, rate = math.hypot(seen, navigation), math.hypot(seen / between, navigation / NAVIGATION_TIME)
    random = planned_margin(spread, other_sigma=sigma, other_sigma_rate=rate, touches_per_hour=f.touches_per_hour)
    unseen = planned_margin(STILL, other_sigma=sigma, other_sigma_rate=rate, touches_per_hour=f.touches_per_hour)
    guard = _SEEN_SHARE * (drift + unseen) + _FLOWN_SHARE * (random - unseen + f.margin_min_m)
    # The guard's disc swells as it looks ahead; the orbit leaves it that much room where it turns.
    room = (f.speed_error_mps + 0.5 * f.vessel_acceleration_mps2 * _GUARD_AHEAD) * _GUARD_AHEAD
    return KeepoutMargin(tracking_sigma=spread.radial, total=drift + random + f.margin_min_m + room, guard=guard)


def _seen(reports: Reports) -> float:
    """Return the standard deviation of the vessel's place just before a report, after many at their longest interval [m]."""
    if reports.exact:
        return 0.0
    found, interval = vessel_filter(reports), reports.interval_s[1]
    for i in range(_STEADY):
        found.report(VesselReport(i * interval, 0.0, 0.0, 0.0, 0.0))
    return found.at(_STEADY * interval + reports.latency_max_s).sigma
