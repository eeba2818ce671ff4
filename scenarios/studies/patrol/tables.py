"""Tables of a patrol: their files, their columns, and what a patrol's row says."""

import math
from collections.abc import Sequence
from typing import Any

from common.physics import SECONDS_PER_HOUR
from scenarios.engine.task import Row
from scenarios.experiment.draws import speed_ratios
from scenarios.simulation.outcome import Outcome
from scenarios.studies.patrol.legs import Leg
from scenarios.studies.patrol.ships import Patrol

LOST = (Outcome.AIRCRAFT_LOST.value, Outcome.DIVERGED.value)
"""Outcomes of flights whose aircraft does not come back."""

PATROL_COLUMNS = (
    "flight_id", "seed", "wind_speed_mps", "wind_from_deg", "ships", "served", "verdicts", "correct", "wrong", "open",
    "oracle_verdicts", "told_verdicts", "served_per_hour", "duration_s", "transit_s", "beside_s", "unused_s",
    "keepout_violations", "min_distance_m", "others_distance_min_m", "kept_out", "aircraft_lost", "outcome", "message",
    "criteria_met", "wall_time_s",
)  # fmt: skip
"""Of ``summary.csv``: a row per patrol. Distances are those beside the ship that is served, and to
every other ship.
"""

SHIP_COLUMNS = (
    "flight_id", "patrol", "ship", "position", "north_m", "east_m", "vessel_speed_mps", "vessel_course_deg",
    "plume_source_height_m", "emission_load", "nu", "fsc_fuel_percent", "truth", "verdict", "correct", "fsc_percent",
    "leaves_s", "reached_s", "orbit_at_s", "time_to_find_s", "settling_time_s", "ended_s", "enough", "outcome", "message",
    "keepout_violations", "min_distance_m", "kept_out", "others_distance_min_m", "altitude_outside_s", "told_service_s",
    "told_verdict",
    "oracle_position", "oracle_ended_s",
)  # fmt: skip
"""Of ``ships.csv``: a row per ship. Times of the patrol are counted from its start, those of a
flight from that of the flight.
"""

PHASE_COLUMNS = (
    "flight_id", "patrol", "ship", "phase", "begins_s", "ends_s", "from_north_m", "from_east_m", "to_north_m", "to_east_m",
)  # fmt: skip
"""Of ``phases.csv``: a row per stretch of a patrol, in its order."""

TRANSIT, APPROACH, SEARCHING, MEASURING, LEAVING = (
    "transit",
    "approach",
    "searching",
    "measuring",
    "leaving",
)
"""Phases: the way to a ship; beside her to the orbit; until the plume is found; until there is a
verdict; and away.
"""


def ship_row(patrol: Patrol, number: int, limit: float) -> Row:
    """Return what is known of a ship before the patrol; ``limit`` is that of the verdict [% m/m]."""
    ship = patrol.ships[number]
    scenario, place = ship.scenario, ship.mover.place
    return {
        "flight_id": flight_name(patrol, number),
        "patrol": patrol.name,
        "ship": number,
        "north_m": place.real,
        "east_m": place.imag,
        "vessel_speed_mps": scenario.vessel_speed,
        "vessel_course_deg": scenario.vessel.course_deg,
        "plume_source_height_m": scenario.source_height,
        "emission_load": scenario.emission.load,
        "nu": speed_ratios(scenario)[0],
        "truth": "above" if ship.sulphur_percent > limit else "below",
        "fsc_fuel_percent": ship.sulphur_percent,
    }


def flight_name(patrol: Patrol, number: int) -> str:
    """Return what the flight beside a ship is called."""
    return f"{patrol.name}_ship_{number}"


def verdict_of(row: Row) -> str:
    """Return the verdict of a flight by all of its looks, its end among them; open without one."""
    return str(row.get("sulphur_verdict", "open"))


def wind_row(patrol: Patrol) -> Row:
    """Return the wind of a patrol, as it is given: one for all of its ships."""
    wind = patrol.ships[0].scenario.wind
    return {
        "wind_speed_mps": wind.speed_mps,
        "wind_from_deg": wind.from_deg % 360.0 if wind.speed_mps else 0.0,
    }


def phase_row(named: Row, phase: str, leg: Leg) -> Row:
    """Return the row of a stretch of a patrol; ``named`` has its flight, patrol and ship."""
    places = zip(("from", "to"), (leg.start, leg.end), strict=True)
    ends = {
        f"{end}_{axis}_m": value
        for end, at in places
        for axis, value in (("north", at.real), ("east", at.imag))
    }
    return named | {"phase": phase, "begins_s": leg.begins, "ends_s": leg.ends} | ends


def patrol_figures(
    ships: Sequence[Row], stretches: Sequence[Row], *, endurance: float, keepout_radius: float
) -> Row:
    """Return the figures of a patrol.

    Parameters
    ----------
    ships, stretches : its rows of the tables of ships and of phases
    endurance : of the UAV [s]
    keepout_radius : r_min [m]
    """
    # A ship beside which nothing was flown, as a start was refused, is not served.
    served = [row for row in ships if "position" in row and "keepout_violations" in row]
    judged = [row for row in served if row["verdict"] != "open"]
    duration = max((row["ends_s"] for row in stretches), default=0.0)
    transit = sum(row["ends_s"] - row["begins_s"] for row in stretches if row["phase"] == TRANSIT)
    passed = [row["others_distance_min_m"] for row in served if "others_distance_min_m" in row]
    others = min(passed, default=math.inf)
    lost = any(row["outcome"] in LOST for row in served)
    # On each way to a ship and beside her, that of other ships counts once.
    violations = sum(int(row.get("keepout_violations", 0)) for row in served) + sum(
        int(near < keepout_radius) for near in passed
    )
    kept_out = all(row.get("kept_out", False) for row in served) and others >= keepout_radius
    figures: dict[str, Any] = {
        "ships": len(ships),
        "served": len(served),
        "verdicts": len(judged),
        "correct": sum(row["correct"] for row in judged),
        "wrong": sum(not row["correct"] for row in judged),
        "open": len(served) - len(judged),
        "duration_s": duration,
        "transit_s": transit,
        "beside_s": duration - transit,
        # The last step may end a little after the endurance.
        "unused_s": max(0.0, endurance - duration),
        "keepout_violations": violations,
        "kept_out": kept_out,
        "aircraft_lost": lost,
        "outcome": (Outcome.AIRCRAFT_LOST if lost else Outcome.COMPLETED).value,
        "message": _message(served, others, keepout_radius),
        "criteria_met": kept_out and not lost,
    }
    near = [row["min_distance_m"] for row in served if "min_distance_m" in row]
    figures |= {"min_distance_m": min(near)} if near else {}
    figures |= {"others_distance_min_m": others} if math.isfinite(others) else {}
    return figures | (
        {"served_per_hour": SECONDS_PER_HOUR * len(served) / duration} if duration else {}
    )


def _message(served: Sequence[Row], others: float, keepout_radius: float) -> str:
    """Return why a patrol served no ship, or did not keep out with its aircraft; no word if it did.

    Parameters
    ----------
    served : rows of the ships that were served
    others : closest approach to any other ship [m]
    keepout_radius : r_min [m]
    """
    if not served:
        return "no ship can be served within patrol.endurance_s"
    failed = [row for row in served if row["outcome"] in LOST or not row.get("kept_out", False)]
    near = [f"came within {others:.0f} m of another ship"] if others < keepout_radius else []
    return "; ".join([*near, *(f"ship {row['ship']}: {_ended(row)}" for row in failed)])


def _ended(row: Row) -> str:
    """Return how the flight beside a ship ended: its outcome, its violations and its message."""
    inside = int(row.get("keepout_violations", 0))
    violations = f"{inside} keep-out violation{'s' * (inside > 1)}" if inside else ""
    ended = (
        ""
        if inside and row["outcome"] == Outcome.COMPLETED.value
        else str(row["outcome"]).replace("_", " ")
    )
    return ": ".join(words for words in (ended, violations, str(row.get("message") or "")) if words)
