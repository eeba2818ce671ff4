"""The keep-out margin of a flight over the real sea: what turbulence, navigation and the vessel's reports may take from it."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from scenarios.sea_config import SeaScenario

SpreadTable = tuple[tuple[float, ...], tuple[float, ...]]


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


def keepout_margin(scenario: SeaScenario, spreads: Mapping[str, SpreadTable], nu: float) -> KeepoutMargin:
    """Return the margin of a flight at a speed ratio.

    Parameters
    ----------
    scenario : the flight
    spreads : of the tracking error over nu, by level of turbulence
    nu : [-]
    """
    table = spreads.get(scenario.turbulence.level)
    sigma = 0.0 if table is None else table[1][min(range(len(table[0])), key=lambda i: abs(table[0][i] - nu))]
    reports = scenario.reports
    seen = scenario.sensors.position_sigma_m
    drift = 0.0
    if not reports.exact:
        seen = math.hypot(seen, 2.3)
        drift = 0.5 * scenario.following.vessel_acceleration_mps2 * (reports.interval_s[1] + reports.latency_max_s) ** 2
    guard = 4.0 * seen + drift
    total = guard + scenario.following.margin_min_m + 4.0 * sigma
    return KeepoutMargin(tracking_sigma=sigma, total=total, guard=guard + 1.5 * sigma)
