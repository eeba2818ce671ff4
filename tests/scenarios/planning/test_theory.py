import json
import math

import pytest
from scipy.optimize import brentq

from benchmarks.crossing_limit import designed
from scenarios.planning.limits import omega_max
from scenarios.planning.theory import (
    CROSSING_LIMITS,
)
from scenarios.scenario.sections.guidance import GuidanceConfig

GUIDANCE = GuidanceConfig()
SOLVED = json.loads(CROSSING_LIMITS.read_text(encoding="utf-8"))


def rows(name):
    return [
        (nu, value / omega_max(GUIDANCE))
        for nu, value in zip(SOLVED["nu"], SOLVED[name], strict=True)
        if value is not None
    ]


@pytest.mark.parametrize(("name", "shape"), [("oscillating", "fastest"), ("going_round", "loiter")])
def test_the_shapes_are_the_optimum_that_was_solved_for_with_another_method(name, shape):
    for nu, interval in rows(name):
        # A roll rate that changes between 200 pieces of a period alone costs 1e-4; the loiter is
        # 7e-5 above its optimum (measured).
        assert designed(GUIDANCE, shape, nu) == pytest.approx(interval, rel=2e-4)


def test_no_solution_is_shorter_than_what_is_proven_for_an_infinite_roll_rate():
    # docs/fastest_oscillation.md: 2 A/omega_max with sin(A)/A = nu, and pi/(omega_max (1 - nu)).
    # IPOPT's tolerance is 1e-9.
    unit = omega_max(GUIDANCE)
    for nu, interval in rows("oscillating"):
        amplitude = brentq(lambda a, nu=nu: math.sin(a) / a - nu, 1e-9, 3.2)
        assert interval >= 2.0 * amplitude / unit * (1.0 - 1e-5)
    for nu, interval in rows("going_round"):
        assert interval >= math.pi / (1.0 - nu) / unit * (1.0 - 1e-5)
