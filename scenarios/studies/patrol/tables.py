"""Tables of a patrol: their files, their columns, and what a patrol's row says."""

import math
from collections.abc import Sequence
from typing import Any

from common.columns import Column, described
from common.physics import SECONDS_PER_HOUR
from scenarios.engine.task import Row
from scenarios.experiment.draws import speed_ratios
from scenarios.flight.outcome import Outcome
from scenarios.studies.patrol.legs import Leg
from scenarios.studies.patrol.ships import Patrol

LOST = (Outcome.AIRCRAFT_LOST.value, Outcome.DIVERGED.value)
"""Outcomes of flights whose aircraft does not come back."""

_CLOSEST = Column(
    "closest approach to the ship that is served",
    title="Closest approach",
    digits=1,
    worse="lower",
)

PATROL_COLUMNS = described(
    {
        "flight_id": Column(
            "name of the patrol, or of the flight beside a ship", title="Flight", kind="text"
        ),
        "seed": Column("seed of the patrol", digits=0),
        "wind_speed_mps": Column("mean wind", title="Wind speed", digits=1),
        "wind_from_deg": Column(
            "direction that the wind comes from, clockwise from north", title="Wind from", digits=0
        ),
        "ships": "number of ships",
        "served": "ships that the UAV flew beside",
        "verdicts": "served ships with a verdict",
        "correct": Column("verdicts that agree with the fuel", kind="any"),
        "wrong": "verdicts that do not agree with the fuel",
        "open": "served ships without a verdict",
        "oracle_verdicts": "correct verdicts of an oracle, which knows how long each ship takes",
        "told_verdicts": "ships with a correct verdict if each is served alone and the UAV is given the plume's true axis",
        "served_per_hour": "ships served in an hour",
        "duration_s": Column("duration of the patrol", title="Flight time", digits=1, adds_up=True),
        "transit_s": "time on the way between ships",
        "beside_s": "time beside ships",
        "unused_s": "endurance left at the end",
        "keepout_violations": Column(
            "number of times that it entered the keep-out area of the ship served, and number of ships beside which, or on the way to which, it came nearer than r_min to another ship",
            title="Keep-out violations",
            digits=0,
            worse="higher",
            adds_up=True,
        ),
        "min_distance_m": _CLOSEST,
        "others_distance_min_m": "closest approach to any other ship, including on the way",
        "kept_out": Column(
            "whether the UAV kept out of the keep-out areas and was observed to the end",
            kind="truth",
        ),
        "aircraft_lost": Column("whether the aircraft was lost", kind="truth"),
        "outcome": Column("completed or aircraft_lost", kind="text"),
        "message": Column(
            "why no ship was served, or which keep-out area was entered, or how the aircraft was lost",
            kind="text",
        ),
        "criteria_met": Column(
            "whether it kept out everywhere and the aircraft was not lost", kind="truth"
        ),
        "wall_time_s": Column("computing time", title="Computing time", adds_up=True),
    }
)
"""Of ``summary.csv``: a row per patrol. Distances are those beside the ship that is served, and to
every other ship.
"""

SHIP_COLUMNS = described(
    {
        "flight_id": Column(
            "name of the patrol, or of the flight beside a ship", title="Flight", kind="text"
        ),
        "patrol": Column("name of the patrol", kind="text"),
        "ship": "number of the ship, from 0",
        "position": "place in the order in which ships were served, from 0; empty for a ship that was not",
        "north_m": "place of the ship at the start of the patrol",
        "east_m": "place of the ship at the start of the patrol",
        "vessel_speed_mps": "its speed",
        "vessel_course_deg": "its course",
        "plume_source_height_m": "height of its funnel",
        "emission_load": "load of its engine",
        "nu": Column(
            "speed ratio through the air: its speed over the UAV's", title="Speed ratio", symbol="ν"
        ),
        "fsc_fuel_percent": Column(
            "sulphur in its fuel, by mass", title="Sulphur in the fuel", digits=4
        ),
        "truth": Column("above or below the limit", kind="text"),
        "verdict": Column("above, below or open", kind="text"),
        "correct": Column("whether the verdict agrees with the fuel", kind="any"),
        "fsc_percent": Column(
            "fuel sulphur content that was measured", title="Sulphur content found", digits=4
        ),
        "leaves_s": "time of the patrol at which the UAV set out for it",
        "reached_s": "time of the patrol at which the flight beside it began",
        "orbit_at_s": "time of that flight at which the UAV reached the orbit",
        "time_to_find_s": Column(
            "time on the orbit until the plume was first detected",
            title="Time to find the plume",
            digits=1,
            worse="higher",
            missing="not found",
        ),
        "settling_time_s": Column(
            "time of that flight from which it had settled",
            title="Settling time",
            digits=1,
            worse="higher",
            missing="not settled",
        ),
        "ended_s": "time of the patrol at which the UAV left it",
        "enough": Column("why the flight beside it ended early, or empty", kind="text"),
        "outcome": Column("outcome of the flight beside it, as in other studies", kind="text"),
        "message": Column("the reason of an outcome other than completed", kind="text"),
        "keepout_violations": Column(
            "number of times that it entered the keep-out area of the ship that it served",
            title="Keep-out violations",
            digits=0,
            worse="higher",
            adds_up=True,
        ),
        "min_distance_m": _CLOSEST,
        "kept_out": Column(
            "whether the UAV kept out of the keep-out areas and was observed to the end",
            kind="truth",
        ),
        "others_distance_min_m": "closest approach to any other ship, including on the way",
        "altitude_outside_s": Column(
            "time outside the limits of the altitude",
            title="Time outside the altitudes of the scenario",
            digits=1,
            worse="higher",
            adds_up=True,
        ),
        "told_service_s": "duration of the flight beside it if the UAV is given the plume's true axis",
        "told_verdict": Column("verdict of that flight", kind="text"),
        "oracle_position": "place in the order of the oracle, from 0; empty for a ship that it leaves out",
        "oracle_ended_s": "time of the patrol at which the oracle leaves it",
    }
)
"""Of ``ships.csv``: a row per ship. Times of the patrol are counted from its start, those of a
flight from that of the flight.
"""

PHASE_COLUMNS = described(
    {
        "flight_id": Column(
            "name of the patrol, or of the flight beside a ship", title="Flight", kind="text"
        ),
        "patrol": Column("name of the patrol", kind="text"),
        "ship": "number of the ship, from 0",
        "phase": Column("transit, approach, searching, measuring or leaving", kind="text"),
        "begins_s": "time of the patrol at which it begins",
        "ends_s": "time of the patrol at which it ends",
        "from_north_m": "place at its beginning",
        "from_east_m": "place at its beginning",
        "to_north_m": "place at its end",
        "to_east_m": "place at its end",
    }
)
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
