"""Tables of a patrol: their files, their columns, and the contents of a patrol's row."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from common.columns import Column, Table, described
from common.physics import SECONDS_PER_HOUR
from extensions.patrol import PHASES, SHIPS
from extensions.patrol.route import Leg
from extensions.patrol.ships import Patrol
from scenarios.engine.task import Row
from scenarios.experiment.draws import speed_ratios
from scenarios.flight.outcome import Outcome
from scenarios.instruments.fuel_estimate import FIGURES as FUEL_COLUMNS
from scenarios.measures.columns import FINDING_COLUMNS, SUMMARY_COLUMNS

LOST = (Outcome.AIRCRAFT_LOST.value, Outcome.DIVERGED.value)
"""Outcomes of flights whose aircraft is lost."""

_FLIGHT = SUMMARY_COLUMNS | FINDING_COLUMNS | FUEL_COLUMNS


def _as_flights(*names: str) -> dict[str, Column]:
    """Return columns with the same meaning as in studies of flights."""
    return {name: _FLIGHT[name] for name in names}


_NAMED: dict[str, Column | str] = {
    "flight_id": Column(
        "name of the patrol, or of the flight beside a ship", title="Flight", kind="text"
    ),
    "patrol": Column("name of the patrol", kind="text"),
    "ship": "number of the ship, from 0",
}

PATROL_COLUMNS = described(
    {
        **_as_flights("flight_id"),
        "seed": Column("seed of the patrol", digits=0),
        "wind_speed_mps": Column("mean wind", title="Wind speed", digits=1),
        **_as_flights("wind_from_deg"),
        "ships": "number of ships",
        "served": "ships that the UAV flew beside",
        "verdicts": "served ships with a verdict",
        "correct": Column("verdicts that agree with the fuel", kind="any"),
        "wrong": "verdicts that do not agree with the fuel",
        "open": "served ships without a verdict",
        "oracle_verdicts": "correct verdicts of an oracle, which knows how long each ship takes",
        "known_axis_verdicts": "ships with a correct verdict if each is served alone and the UAV"
        " knows the plume's true axis",
        "served_per_hour": "ships served in an hour",
        "duration_s": Column("duration of the patrol", title="Flight time", digits=1, adds_up=True),
        "transit_s": "time on the way between ships",
        "beside_s": "time beside ships",
        "unused_s": "endurance left at the end",
        **_as_flights("keepout_violations", "min_distance_m"),
        "others_distance_min_m": "closest approach to any other ship, including on the way",
        **_as_flights("kept_out"),
        "aircraft_lost": Column("whether the aircraft was lost", kind="truth"),
        "outcome": Column("completed or aircraft_lost", kind="text"),
        "message": Column(
            "why no ship was served, or which keep-out area was entered, or how the aircraft was"
            " lost",
            kind="text",
        ),
        "criteria_met": Column(
            "whether it kept out everywhere and the aircraft was not lost", kind="truth"
        ),
        **_as_flights("wall_time_s"),
    }
)
"""Of ``summary.csv``: a row per patrol. Its violations are those of the areas of the ships that it
serves and, once each, of the ships that it passes nearer than r_min beside one or on the way to
one; it has kept out if it did so of all. ``min_distance_m`` is that to ships that are served.
"""

SHIP_COLUMNS = described(
    {
        **_NAMED,
        "position": "place in the order in which ships were served, from 0; empty for a ship that"
        " was not",
        "north_m": "place of the ship at the start of the patrol",
        "east_m": "place of the ship at the start of the patrol",
        "vessel_speed_mps": "its speed",
        "vessel_course_deg": "its course",
        "plume_source_height_m": "height of its funnel",
        "emission_load": "load of its engine",
        **_as_flights("nu", "fsc_fuel_percent"),
        "truth": Column("above or below the limit", kind="text"),
        "verdict": Column("above, below or open", kind="text"),
        "correct": Column("whether the verdict agrees with the fuel", kind="any"),
        **_as_flights("fsc_percent"),
        "leaves_s": "time of the patrol at which the UAV set out for it",
        "reached_s": "time of the patrol at which the flight beside it began",
        **_as_flights("orbit_at_s", "time_to_find_s", "settling_time_s"),
        "ended_s": "time of the patrol at which the UAV left it",
        **_as_flights(
            "enough", "outcome", "message", "keepout_violations", "min_distance_m", "kept_out"
        ),
        "others_distance_min_m": "closest approach to any other ship, including on the way",
        **_as_flights("altitude_outside_s"),
        "known_axis_service_s": "duration of the flight beside it if the UAV knows the plume's true"
        " axis",
        "known_axis_verdict": Column("verdict of that flight", kind="text"),
        "oracle_position": "place in the order of the oracle, from 0; empty for a ship that it"
        " leaves out",
        "oracle_ended_s": "time of the patrol at which the oracle leaves it",
    }
)
"""Of ``ships.csv``: a row per ship. Times of the patrol are counted from its start, those of a
flight from that of the flight.
"""

PHASE_COLUMNS = described(
    {
        **_NAMED,
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

TABLES: Mapping[str, Table] = {
    "summary.csv, of patrols": PATROL_COLUMNS,
    SHIPS: SHIP_COLUMNS,
    PHASES: PHASE_COLUMNS,
}

TRANSIT, APPROACH, SEARCHING, MEASURING, LEAVING = (
    "transit",
    "approach",
    "searching",
    "measuring",
    "leaving",
)
"""Phases: the way to a ship; beside it to the orbit; until the plume is found; until there is a
verdict; and away.
"""


def ship_row(patrol: Patrol, number: int, limit: float) -> Row:
    """Return the prior knowledge of a ship; ``limit`` is that of the verdict [% m/m]."""
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
    """Return the name of the flight beside a ship."""
    return f"{patrol.name}_ship_{number}"


def verdict_of(row: Row) -> str:
    """Return the verdict of a flight by all of its looks, including the one at its end; open
    without a look.
    """
    return str(row.get("sulphur_verdict", "open"))


def wind_row(patrol: Patrol) -> Row:
    """Return the given wind of a patrol, the same for all of its ships."""
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
    # A ship without a flight, because its start was refused, is not served.
    served = [row for row in ships if "position" in row and "keepout_violations" in row]
    judged = [row for row in served if row["verdict"] != "open"]
    duration = max((row["ends_s"] for row in stretches), default=0.0)
    transit = sum(row["ends_s"] - row["begins_s"] for row in stretches if row["phase"] == TRANSIT)
    passed = [row["others_distance_min_m"] for row in served if "others_distance_min_m" in row]
    others = min(passed, default=math.inf)
    lost = any(row["outcome"] in LOST for row in served)
    # On each way to a ship and beside it, a violation of another ship counts once.
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
    """Return why a patrol served no ship, or did not keep out with its aircraft; empty if it
    succeeded.

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
    """Return the end of the flight beside a ship: its outcome, its violations and its message."""
    inside = int(row.get("keepout_violations", 0))
    violations = f"{inside} keep-out violation{'s' * (inside > 1)}" if inside else ""
    ended = (
        ""
        if inside and row["outcome"] == Outcome.COMPLETED.value
        else str(row["outcome"]).replace("_", " ")
    )
    return ": ".join(words for words in (ended, violations, str(row.get("message") or "")) if words)
