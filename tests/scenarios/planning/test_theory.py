import json
import math

import pytest
from scipy.optimize import brentq

from benchmarks.crossing_limit import designed
from scenarios.planning.limits import omega_max
from scenarios.planning.theory import (
    CROSSING_LIMITS,
    crossing_limit,
    theory_over_speed_ratio,
)
from scenarios.scenario.files import load_study
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


def test_the_limit_is_that_of_the_loiter_beside_slow_vessels_and_of_the_oscillation_beside_others():
    limit = crossing_limit(GUIDANCE)
    shortest = dict(zip(limit["limit_nu"], limit["crossing_interval_limit_s"], strict=True))
    for nu, shape in (
        (0.0, "loiter"),
        (0.25, "loiter"),
        (0.5, "fastest"),
        (0.75, "fastest"),
        (0.9, "fastest"),
    ):
        # As above.
        assert designed(GUIDANCE, shape, nu) == pytest.approx(shortest[nu], rel=2e-4)
        # The issue: flown within 3 % of the limit; the reserve of the flown reference takes 1.5 %
        # of it.
        assert designed(GUIDANCE, shape, nu, reserve=GUIDANCE.reserve) <= 1.03 * shortest[nu]


@pytest.mark.parametrize("changes", [{"bank_deg": 40.0}, {"roll_rate_max_deg_s": 60.0}])
def test_limits_of_another_bank_or_roll_rate_are_not_shown(changes):
    assert crossing_limit(GuidanceConfig(**changes)) == {}
    # In its own units an aircraft of another speed flies the same.
    scaled = GuidanceConfig(airspeed_mps=38.84, roll_rate_max_deg_s=20.0)
    assert crossing_limit(scaled)["crossing_interval_limit_s"][0] == pytest.approx(
        2.0 * crossing_limit(GUIDANCE)["crossing_interval_limit_s"][0], rel=1e-12
    )


@pytest.mark.parametrize("shape", ["sinusoid", "fastest"])
def test_both_oscillations_are_shown_whichever_is_flown(shape):
    curves = theory_over_speed_ratio(load_study("sweep_nu", [f"reference.shape={shape}"]))
    assert curves["crossing_interval_predicted_s"] == curves[f"crossing_interval_{shape}_s"]
    assert all(
        fast < slow
        for fast, slow in zip(
            curves["crossing_interval_fastest_s"],
            curves["crossing_interval_sinusoid_s"],
            strict=True,
        )
    )
