"""The tuner: the same budget and the same cost for every law, on flights that the comparison does
not use.

It flies the kinematic vehicle with the aircraft's lag: a thousand settings take as long as a
hundred with the aircraft. Half of the budget is spread evenly over the ranges, the default first;
the other half is Nelder and Mead's simplex about the best.
"""

import json
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import minimize

from extensions.arena.entrants import TUNING, Entrant, draws_left
from extensions.arena.keys import ArenaConfig
from extensions.arena.window import window_figures
from scenarios.engine.task import Row
from scenarios.experiment.requests import Experiment
from scenarios.flight.closed_loop import fly, release
from scenarios.flight.ending import failure
from scenarios.planning.missions import plan_flight
from scenarios.scenario.files import with_values
from scenarios.scenario.scenario import Scenario
from scenarios.vehicles.vehicle_setup import kinematic_setup

_STEP = 0.15
"""First step of the simplex, over the range [-]."""

_FAILED = 1e3
"""Cost of a setting that cannot be flown [m]: finite, as the simplex needs it."""

Point = npt.NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Tuner:
    """Tunes the laws of an arena.

    Attributes
    ----------
    scenario : of the arena's flights
    arena : budget and cost
    lag : of the aircraft's heading rate behind its command [s]
    """

    scenario: Scenario
    arena: ArenaConfig
    lag: float

    def rows(self, entrant: Entrant) -> Iterator[Row]:
        """Yield a row for each tried setting, in order: the parameters and their cost."""
        keys = list(entrant.defaults)
        tried: list[Row] = []

        def cost(point: Point) -> float:
            parameters = self._parameters(entrant, keys, point)
            row: Row = {
                "entrant": entrant.name,
                "evaluation": len(tried),
                "parameters": json.dumps(parameters),
            }
            row |= self._flown(entrant, parameters)
            tried.append(row)
            return float(row["cost_m"])

        # A law without parameters has one setting.
        _search(
            cost,
            len(keys),
            self.arena.evaluations if keys else min(1, self.arena.evaluations),
            self.scenario.seed,
        )
        yield from tried

    def _parameters(self, entrant: Entrant, keys: list[str], point: Point) -> dict[str, float]:
        """Return the parameters at a point of the unit cube, in whose middle the defaults are."""
        spans = self.arena.tuning_range ** (2.0 * np.clip(point, 0.0, 1.0) - 1.0)
        return {
            key: float(f"{entrant.defaults[key] * span:.6g}")
            for key, span in zip(keys, spans, strict=True)
        }

    def _flown(self, entrant: Entrant, parameters: Mapping[str, float]) -> Row:
        """Return the cost of a setting: the mean error of its flights, and the weighted excess of
        their effort.
        """
        arena, errors, excesses = self.arena, [], []
        try:
            scenario = self._scenario(entrant, parameters)
            experiment = Experiment(TUNING, scenario)
            for number in range(arena.tuning_flights):
                request = experiment.request(number)
                setup = kinematic_setup(request.scenario)
                plan = plan_flight(
                    request.scenario, flight_id=request.flight_id, seed=request.noise, setup=setup
                )
                record = fly(plan, release(plan, setup))
                figures = window_figures(plan, record, window=arena.window_s)
                errors.append(figures["error_rms_m"])
                excesses.append(figures["excess_rms_rad_s"])
        except Exception as failed:  # noqa: BLE001 - one to stay away from, with its reason
            return {"cost_m": _FAILED, "message": failure(failed)["message"]}
        error, excess = float(np.mean(errors)), float(np.mean(excesses))
        counted = float(np.mean(np.minimum(errors, arena.error_max_m)))
        found = counted + arena.effort_weight_m_s * excess
        return {
            "cost_m": found if math.isfinite(found) else _FAILED,
            "error_m": error,
            "excess_rad_s": excess,
            "message": "",
        }

    def _scenario(self, entrant: Entrant, parameters: Mapping[str, float]) -> Scenario:
        arena = self.arena
        values: dict[str, object] = {
            "fidelity": "kinematic",
            "kinematic.heading_rate_lag_s": self.lag,
            "flight.duration_max_s": arena.tuning_duration_s,
            "flights": arena.tuning_flights,
            # Costs depend on the tracking alone.
            "payload.instruments": (),
            "emission.ship": None,
            **draws_left(self.scenario, arena.tuning_set),
            **arena.tuning_set,
            **entrant.values(parameters),
        }
        return with_values(self.scenario, values)


def _search(cost: Callable[[Point], float], dimension: int, budget: int, seed: int) -> None:
    """Try ``budget`` points of the unit cube."""
    if not budget:
        return
    points = [np.full(dimension, 0.5)]
    costs = [cost(points[0])]
    if budget == 1 or not dimension:
        return
    from scipy.stats import qmc

    spread = qmc.Halton(dimension, seed=seed).random(max(0, budget // 2 - 1))
    for point in spread:
        points.append(point)
        costs.append(cost(point))
    start, room = points[int(np.argmin(costs))], budget - len(points)
    # Towards the middle, so that the first simplex lies within the cube.
    steps = np.where(start < 0.5, _STEP, -_STEP) * np.eye(dimension)
    if room:
        minimize(
            cost,
            start,
            method="Nelder-Mead",
            bounds=[(0.0, 1.0)] * dimension,
            options={
                "maxfev": room,
                "maxiter": room,
                "initial_simplex": np.vstack([start, start + steps]),
                "xatol": 1e-3,
                "fatol": 1e-3,
            },
        )
