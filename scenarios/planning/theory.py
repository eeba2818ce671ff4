"""Curves over the speed ratio from theory, for the reports."""

import functools
import json
import math
from pathlib import Path

import numpy as np

from common.errors import PluginError
from common.physics import bank_for_heading_rate
from gnc.errors import InfeasibleError
from gnc.paper import PlumeAxis
from scenarios.planning.limits import omega_max
from scenarios.planning.reference import distance_kept, oscillation_at
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.guidance import GuidanceConfig, ReferenceConfig
from scenarios.scenario.sections.world import KeepoutConfig

CROSSING_LIMITS = Path(__file__).parent / "crossing_limits.json"
"""Shortest crossing intervals by optimal control, written by
``python -m benchmarks.crossing_limit --write``.
"""

_RATIO_MAX, _POINTS = 0.99, 100
"""Largest speed ratio of a curve, and the number of its points."""

_OTHERS = ("guidance.", "reference.", "keepout.", "plume.", "vessel.")
"""Keys on which the curves also depend: a sweep over one of them has more than one curve."""

_OSCILLATIONS = ("sinusoid", "fastest")
"""Shapes whose crossing intervals are always shown beside each other."""

_SAME = 0.01
"""Largest relative difference of an aircraft's limits from those of the solution [-]."""


def theory_over_speed_ratio(scenario: Scenario) -> dict[str, list[float]]:
    """Return the crossing interval and r_CO over nu in still air, by names of columns; empty unless
    only nu is swept.

    Only a reference that is known in advance has a fixed r_CO; that of a steered one depends on the
    margin of each flight. Beside the flown shape's crossing interval there are those of the
    project's oscillations, and the shortest of any path.
    """
    if "nu" not in scenario.sweep.root or any(
        key.startswith(_OTHERS) for key in scenario.sweep.root
    ):
        return {}
    axis = PlumeAxis(
        heading=math.radians(scenario.plume.heading_deg),
        elevation=math.radians(scenario.plume.elevation_deg),
    )
    names = (
        "nu",
        "crossing_interval_predicted_s",
        "r_co_m",
        *(f"crossing_interval_{shape}_s" for shape in _OSCILLATIONS),
    )
    points = _points(scenario.guidance, scenario.reference, scenario.guarded_keepout, axis)
    curves = {name: [point[i] for point in points] for i, name in enumerate(names)}
    if scenario.follows:
        del curves["r_co_m"]
    return curves | crossing_limit(scenario.guidance)


@functools.lru_cache(maxsize=8)
def _points(
    guidance: GuidanceConfig, reference: ReferenceConfig, keepout: KeepoutConfig, axis: PlumeAxis
) -> tuple[tuple[float, ...], ...]:
    """Return speed ratio, crossing interval, r_CO and the other crossing intervals, remembered for
    the next study of a process.
    """
    points: list[tuple[float, ...]] = []
    for nu in np.linspace(0.0, _RATIO_MAX, _POINTS).tolist():
        try:
            orbit = oscillation_at(guidance, reference, nu)
            distance = distance_kept(guidance, keepout, orbit, axis)
            others = [_crossing_interval(guidance, shape, nu) for shape in _OSCILLATIONS]
        except (InfeasibleError, PluginError):
            # A user's shape may fail at a point; the flights there report the reason.
            break
        points.append((nu, orbit.crossing_interval, distance, *others))
    return tuple(points)


@functools.lru_cache(maxsize=len(_OSCILLATIONS) * _POINTS)
def _crossing_interval(guidance: GuidanceConfig, shape: str, nu: float) -> float:
    """Return the crossing interval of one of the project's oscillations [s], remembered for the
    next study of a process.
    """
    return oscillation_at(guidance, ReferenceConfig(shape=shape), nu).crossing_interval


def crossing_limit(guidance: GuidanceConfig) -> dict[str, list[float]]:
    """Return the shortest crossing interval of any path with two crossings a period, over the speed
    ratio.

    Returns
    -------
    curves : ``limit_nu`` [-] and ``crossing_interval_limit_s`` [s]; nothing where bank or roll rate
        differ from those of the solution
    """
    solved = json.loads(CROSSING_LIMITS.read_text(encoding="utf-8"))
    fastest = omega_max(guidance)
    bank = bank_for_heading_rate(fastest, guidance.airspeed_mps)
    ratio = math.radians(guidance.roll_rate_max_deg_s) / fastest
    if not (
        math.isclose(bank, math.radians(solved["bank_deg"]), rel_tol=_SAME)
        and math.isclose(ratio, solved["roll_rate_over_omega_max"], rel_tol=_SAME)
    ):
        return {}
    best = [
        min(x for x in pair if x is not None)
        for pair in zip(solved["oscillating"], solved["going_round"], strict=True)
    ]
    return {
        "limit_nu": solved["nu"],
        "crossing_interval_limit_s": [value / fastest for value in best],
    }
