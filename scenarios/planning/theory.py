"""What theory says over the speed ratio: curves for the reports, whichever speed ratios are flown."""

import math

import numpy as np

from gnc.errors import InfeasibleError
from gnc.reference.placement import PlumeAxis
from scenarios.planning.reference import oscillation_at, placed_distance
from scenarios.schema.scenario import Scenario

_RATIO_MAX, _POINTS = 0.99, 100
"""Largest speed ratio of a curve, and the number of its points."""

_OTHERS = ("guidance.", "reference.", "keepout.", "plume.", "vessel.")
"""Keys on which the curves depend as well: where one of them is swept, there is more than one curve."""


def theory_over_speed_ratio(scenario: Scenario) -> dict[str, list[float]]:
    """Return pi/omega_0 and r_CO over nu in still air, by names of columns; nothing of a scenario that does not sweep nu alone.

    The paper's reference alone has a fixed r_CO; that of a steered one depends on the margin of each flight.
    """
    if "nu" not in scenario.sweep.root or any(key.startswith(_OTHERS) for key in scenario.sweep.root):
        return {}
    axis = PlumeAxis(heading=math.radians(scenario.plume.heading_deg), elevation=math.radians(scenario.plume.elevation_deg))
    curves: dict[str, list[float]] = {"nu": [], "crossing_interval_predicted_s": [], "r_co_m": []}
    for nu in np.linspace(0.0, _RATIO_MAX, _POINTS).tolist():
        try:
            orbit = oscillation_at(scenario.guidance, scenario.reference, nu)
            distance = placed_distance(scenario, orbit, axis)
        except InfeasibleError:
            break
        for name, value in zip(curves, (nu, orbit.crossing_interval, distance), strict=True):
            curves[name].append(value)
    if scenario.follows:
        del curves["r_co_m"]
    return curves
