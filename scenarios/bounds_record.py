"""What bounds the commands of a study's flights: the bound, the worst state that a search finds, and what a guarantee costs."""

import math
from typing import Any

import numpy as np

from gnc.adversary import largest_heading_rate
from gnc.bounds import fastest_within
from gnc.delta import LookAhead
from gnc.errors import InfeasibleError
from gnc.oscillation import design_oscillation
from scenarios.config import Scenario
from scenarios.flights import FlightRequest
from scenarios.metrics import Row
from scenarios.plan import heading_rate_max, plan_flight
from scenarios.steering import largest_speed

_SAMPLES = 1_000_000
_RESERVES = (0.0, 0.015, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6)


def bounds_record(scenario: Scenario, requests: list[FlightRequest]) -> dict[str, Any]:
    """Return the bounds of a study's flights under law (30), and those of guaranteed flights over the reserve kept.

    Returns
    -------
    flown : a row per distinct steering: its parameters, the bound, the largest command that a search over states finds
    guaranteed : a row per reserve at the scenario's first speed ratio: the parameters that converge fastest while no state asks for
        more than omega_max, or why there are none
    """
    return {
        "samples": _SAMPLES,
        "flown": _flown(scenario, requests),
        "guaranteed": [_guaranteed(scenario, reserve) for reserve in _RESERVES],
    }


def _flown(scenario: Scenario, requests: list[FlightRequest]) -> list[Row]:
    rows: dict[tuple[float, ...], Row] = {}
    generator = np.random.default_rng(scenario.seed)
    for request in requests:
        settings = request.scenario
        try:
            plan = plan_flight(settings, flight_id=request.flight_id, nu=request.nu, seed=request.seed, lag=0.0)
        except InfeasibleError:
            continue
        if not math.isfinite(plan.heading_rate_bound):
            continue
        g = plan.guidance
        largest = plan.mission.oscillation.amplitude if plan.mission else abs(plan.reference.heading_rate)
        speed = largest_speed(settings)
        key = (speed, largest, *g.look_ahead, g.gain, g.rate_max)
        if key in rows:
            rows[key]["flights"].append(request.flight_id)
            continue
        found = largest_heading_rate(
            LookAhead(*g.look_ahead),
            speed=speed,
            reference_heading_rate_max=largest,
            gain=g.gain,
            steering_max=g.rate_max,
            samples=_SAMPLES,
            generator=generator,
        )
        rows[key] = {
            "flights": [request.flight_id],
            "tuning": settings.guidance.tuning,
            "speed_mps": speed,
            "reference_heading_rate_max_rad_s": largest,
            "heading_rate_max_rad_s": plan.heading_rate_max,
            "epsilon_per_m": g.look_ahead.epsilon,
            "look_ahead_m": g.look_ahead.radius,
            "steering_max_rad_s": g.rate_max,
            "bound_rad_s": plan.heading_rate_bound,
            "largest_found_rad_s": found,
        }
    return list(rows.values())


def _guaranteed(scenario: Scenario, reserve: float) -> Row:
    g, nu = scenario.guidance, scenario.sweep.nu[0]
    omega_max = heading_rate_max(scenario)
    oscillation = design_oscillation(nu=nu, speed=g.airspeed_mps, heading_rate_max=omega_max, reserve=reserve)
    row: Row = {"nu": nu, "reserve": reserve, "crossing_interval_s": oscillation.crossing_interval}
    try:
        found = fastest_within(
            speed=g.airspeed_mps,
            heading_rate_max=omega_max,
            reference_heading_rate_max=oscillation.amplitude,
            distance_from=scenario.start.distance_m[1],
            distance_to=scenario.flight.settling_band_m,
            gain=g.gain_per_s,
        )
    except InfeasibleError as error:
        return row | {"message": str(error)}
    return row | {
        "epsilon_per_m": found.look_ahead.epsilon,
        "look_ahead_m": found.look_ahead.radius,
        "steering_max_rad_s": found.steering_max,
        "bound_rad_s": found.bound,
        "convergence_time_s": found.convergence_time,
    }
