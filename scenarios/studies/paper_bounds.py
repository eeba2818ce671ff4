"""What bounds the commands of a study's flights: the bound, the worst state that a search finds, and what a guarantee costs."""

import math
from typing import Any

import numpy as np

from gnc.analysis.worst_case_search import tightness
from gnc.errors import InfeasibleError
from scenarios.flights import FlightRequest
from scenarios.metrics.figures import Row
from scenarios.planning.bounded_steering import farthest_start, largest_speed, search_steering
from scenarios.planning.limits import omega_max
from scenarios.planning.planner import plan_flight
from scenarios.planning.reference import oscillation_at
from scenarios.schema.load import with_values

_SAMPLES = 1_000_000
_RESERVES = (0.0, 0.015, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6)


def bounds_record(requests: list[FlightRequest], seed: int) -> dict[str, Any]:
    """Return the bounds of a study's flights under law (30), and what they would cost over the reserve kept.

    Parameters
    ----------
    requests : the study's flights
    seed : of the search for the worst states

    Returns
    -------
    guaranteed_for : speed, omega_max, and the distances between which convergence is estimated
    flown : a row per distinct steering: its parameters, the bound, the largest command that a search over states finds
    guaranteed : for the last flight with a vessel a row per reserve: the parameters that converge fastest while no state asks for
        more than omega_max, or why there are none
    """
    missions = [request for request in requests if not math.isnan(request.nu)]
    last = missions[-1].scenario if missions else None
    return {
        "samples": _SAMPLES,
        "guaranteed_for": last
        and {
            "speed_mps": largest_speed(last),
            "heading_rate_max_rad_s": omega_max(last.guidance),
            "distance_from_m": farthest_start(last),
            "distance_to_m": last.flight.settling_band_m,
        },
        "flown": _flown(requests, np.random.default_rng(seed)),
        "guaranteed": [_guaranteed(missions[-1], reserve) for reserve in _RESERVES] if missions else [],
    }


def _flown(requests: list[FlightRequest], generator: np.random.Generator) -> list[Row]:
    rows: dict[tuple[float, ...], Row] = {}
    for request in requests:
        settings = request.scenario
        try:
            plan = plan_flight(settings, flight_id=request.flight_id, nu=request.nu, seed=request.seed, lag=0.0)
        except InfeasibleError:
            continue
        if not math.isfinite(plan.steering.bound):
            continue
        steering, gain, speed = plan.steering, settings.guidance.gain_per_s, largest_speed(settings)
        turn = plan.mission.oscillation.amplitude if plan.mission else abs(plan.reference.heading_rate)
        key = (speed, turn, *steering.look_ahead, gain, steering.steering_max)
        if key in rows:
            rows[key]["flights"].append(request.flight_id)
            continue
        found = tightness(
            steering.look_ahead,
            speed=speed,
            reference_heading_rate_max=turn,
            gain=gain,
            steering_max=steering.steering_max,
            samples=_SAMPLES,
            generator=generator,
        )
        rows[key] = {
            "flights": [request.flight_id],
            "tuning": settings.guidance.tuning,
            "speed_mps": speed,
            "reference_heading_rate_max_rad_s": turn,
            "heading_rate_max_rad_s": plan.heading_rate_max,
            "epsilon_per_m": steering.look_ahead.epsilon,
            "look_ahead_m": steering.look_ahead.radius,
            "steering_max_rad_s": steering.steering_max,
            "bound_rad_s": found.bound,
            "largest_found_rad_s": found.largest,
        }
    return list(rows.values())


def _guaranteed(request: FlightRequest, reserve: float) -> Row:
    row: Row = {"nu": request.nu, "reserve": reserve}
    try:
        scenario = with_values(request.scenario, {"guidance.reserve": reserve})
        oscillation = oscillation_at(scenario.guidance, request.nu)
        row["crossing_interval_s"] = oscillation.crossing_interval
        found = search_steering(scenario, omega_max(scenario.guidance), oscillation.amplitude)
    except InfeasibleError as error:
        return row | {"message": str(error)}
    return row | {
        "epsilon_per_m": found.look_ahead.epsilon,
        "look_ahead_m": found.look_ahead.radius,
        "steering_max_rad_s": found.steering_max,
        "bound_rad_s": found.bound,
        "convergence_time_s": found.convergence_time,
    }
