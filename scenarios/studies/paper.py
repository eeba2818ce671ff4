"""The paper's simulations as a study: flights, and the bounds, worst states and price of a
guarantee of their law.
"""

import math
from typing import Any

import numpy as np

from gnc.analysis.worst_case_search import largest_heading_rate
from gnc.errors import InfeasibleError
from scenarios.engine.journal import Journal
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import Progress
from scenarios.engine.task import Row
from scenarios.experiment.requests import FlightRequest
from scenarios.planning.guidance import farthest_start, largest_speed, search_steering
from scenarios.planning.limits import omega_max
from scenarios.planning.missions import plan_flight
from scenarios.planning.reference import circle, oscillation_at
from scenarios.scenario.files import with_values
from scenarios.scenario.sections.guidance import GuidanceConfig
from scenarios.studies.base import FlightStudy, study
from scenarios.vehicles.vehicle_setup import kinematic_setup

SEARCH_STATES = 1_000_000
"""Random states of each search for the largest command. 10,000 find the same twelve digits for the
default look-ahead; a hundred times as many take half a second, and leave room for parameters whose
worst states are rarer.
"""

RESERVE_MAX_PERCENT, RESERVE_STEP_PERCENT = 60, 5
"""Grid of reserves; at 60 % a guarantee converges in 2.3 times the time of the default look-ahead
without one.
"""

RESERVES = (
    0.0,
    float(GuidanceConfig.model_fields["reserve"].default),
    *(
        percent / 100
        for percent in range(RESERVE_STEP_PERCENT, RESERVE_MAX_PERCENT + 1, RESERVE_STEP_PERCENT)
    ),
)
"""Fractions of omega_max that the reference leaves unused: none, as in the paper, the default, and
a grid [-].
"""


def bounds_record(requests: list[FlightRequest], seed: int) -> dict[str, Any]:
    """Return the bounds of a study's flights under law (30), and the price of a guarantee over the
    reserve.

    Parameters
    ----------
    requests : the study's flights
    seed : seed of the search for the worst states

    Returns
    -------
    guaranteed_for : speed, omega_max, and the distances between which convergence is estimated
    flown : a row per distinct set of steering parameters: the bound, and the largest command that a
        search over states finds
    guaranteed : for the last flight with a vessel a row per reserve: the parameters that converge
        fastest while no state demands more than omega_max, or why there are none
    """
    missions = [request for request in requests if not request.scenario.circles]
    last = missions[-1].scenario if missions else None
    return {
        "samples": SEARCH_STATES,
        "guaranteed_for": last
        and {
            "speed_mps": largest_speed(last),
            "heading_rate_max_rad_s": omega_max(last.guidance),
            "distance_from_m": farthest_start(last),
            "distance_to_m": last.flight.settling_band_m,
        },
        "flown": _flown(requests, np.random.default_rng(seed)),
        "guaranteed": [_guaranteed(missions[-1], reserve) for reserve in RESERVES]
        if missions
        else [],
    }


def _flown(requests: list[FlightRequest], generator: np.random.Generator) -> list[Row]:
    rows: dict[tuple[float, ...], Row] = {}
    for request in requests:
        settings = request.scenario
        try:
            plan = plan_flight(
                settings,
                flight_id=request.flight_id,
                seed=request.seed,
                setup=kinematic_setup(settings),
            )
        except InfeasibleError:
            continue
        if not math.isfinite(plan.steering.bound):
            continue
        steering, gain, speed = plan.steering, settings.guidance.gain_per_s, largest_speed(settings)
        turn = (
            plan.oscillation.amplitude if plan.oscillation else abs(circle(settings).heading_rate)
        )
        key = (speed, turn, *steering.look_ahead, gain, steering.steering_max)
        if key in rows:
            rows[key]["flights"].append(request.flight_id)
            continue
        largest = largest_heading_rate(
            steering.look_ahead,
            speed=speed,
            reference_heading_rate_max=turn,
            gain=gain,
            steering_max=steering.steering_max,
            samples=SEARCH_STATES,
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
            "bound_rad_s": steering.bound,
            "largest_found_rad_s": largest,
        }
    return list(rows.values())


def _guaranteed(request: FlightRequest, reserve: float) -> Row:
    row: Row = {"nu": request.scenario.nu_over_ground, "reserve": reserve}
    try:
        scenario = with_values(request.scenario, {"guidance.reserve": reserve})
        oscillation = oscillation_at(
            scenario.guidance, scenario.reference, request.scenario.nu_over_ground
        )
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


@study("paper")
class PaperStudy(FlightStudy):
    """Flights of cases; ``bounds.json`` bounds their commands."""

    def postprocess(self, run: RunDirectory, journal: Journal, progress: Progress) -> None:
        """Bound the commands of the flights."""
        super().postprocess(run, journal, progress)
        progress("bounding commands", self.planned, self.planned)
        ((_, scenario),) = self.trials.items()
        ((_, experiment),) = self.experiments.items()
        requests = list(experiment.requests())
        run.write_json(run.bounds, bounds_record(requests, scenario.seed))
