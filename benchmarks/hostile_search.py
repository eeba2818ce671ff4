"""Whether laws that fly at the ship bring an aircraft into the keep-out area, over all that a
scenario may declare.

``python -m benchmarks.hostile_search --flights 2000 --out flights.csv`` draws flights, one after
the other: aircraft, bank, radius and shape of the keep-out area, mission and shape of the
reference, a ship that keeps its course, manoeuvres, or comes from a file of AIS reports, wind that
is steady, has a profile or comes from a table, turbulence, gusts, errors of sensors, and faults.
Most are steered at the ship, ahead of it, or along its keep-out area by a law that knows where the
ship is; the rest by the paper's law. A violation is printed with the premises of the guard's
theorem that did not hold. Flight n depends on the seed and n alone: ``--first n --flights 1`` flies
it again.
"""

import argparse
import csv
import math
import tempfile
import warnings
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from aircraft.fleet.find import find_spec
from common.physics import STANDARD_GRAVITY
from common.premises import EXCEEDED, TERMS, exceeded_terms, ratio_column
from gnc.reference.reference import Reference
from gnc.steering import Air, Motion
from scenarios.api.flying import fly
from scenarios.api.scenario import load
from scenarios.errors import InputError
from scenarios.flight.outcome import Outcome

AIRCRAFT = {"x8": 0.45, "aerosonde": 0.2, "c172p": 0.2, "T37": 0.15}
"""Aircraft, and the share of flights that each of them flies [-]."""

BANK_MAX_DEG = {"c172p": 35.0, "T37": 35.0}
"""Steepest bank of an autopilot that stops below 50 degrees [deg]."""

SCENARIO = {"extends": "operational", "title": "Hostile laws", "flight": {"crossings": 0}}

BEGINS = datetime(2026, 6, 1, 12, tzinfo=UTC)
"""Time of the start of flights with files."""

LATITUDE, LONGITUDE = 57.0, 11.0
"""Place of a ship from a file at the start [deg]."""

METRES_PER_DEGREE = 111_320.0
"""Of latitude: the made reports need no more [m]."""

MMSI = 219999001

NOT_FLOWN = {Outcome.INFEASIBLE.value, Outcome.TRIM_FAILED.value, Outcome.FAILED.value}
"""Outcomes of flights that are refused."""

GONE = {Outcome.AIRCRAFT_LOST.value, Outcome.DIVERGED.value}
"""Outcomes of aircraft that are lost."""

FIGURES = ("outcome", "message", "duration_s", "min_distance_m", "keepout_radius_m",
           "keepout_violations", "guard_lost_s", EXCEEDED, *map(ratio_column, TERMS))  # fmt: skip
"""Columns of a flight that are printed and written."""

Keys = dict[str, Any]


# ---------------------------------------------------------------- The law


@dataclass(frozen=True, kw_only=True)
class Hostile:
    """A steering law that flies at the ship, ahead of it, or along a tangent of its keep-out area.

    Attributes
    ----------
    track : where the ship is: north and east every ``interval_s``, one after the other [m]
    interval_s : between these [s]
    tangent_radius_m : of the disc along which it flies [m]
    attack_gain : of the course [1/s]
    lead_share : share of the way that the ship makes meanwhile that is flown ahead of it [-]
    """

    track: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0)
    interval_s: float = 1.0
    tangent_radius_m: float = 0.0
    attack_gain: float = 5.0
    lead_share: float = 0.0

    def start(self, time_step: float) -> "_HostileFlight":
        """Return the law in flight."""
        return _HostileFlight(self, time_step)

    def heading_rate(self, reference: Reference, own: Motion, air: Air) -> float:
        """Return nothing: it needs to know the time."""
        raise NotImplementedError


class _HostileFlight:
    def __init__(self, law: Hostile, time_step: float) -> None:
        self._law = law
        self._time_step = time_step
        self._steps = 0
        self._drift = np.zeros(2)
        self._track = np.reshape(law.track, (-1, 2))

    def heading_rate(self, reference: Reference, own: Motion, air: Air) -> float:
        """Return the heading rate that turns towards the ship [rad/s]."""
        del reference
        law, wind = self._law, np.array([air.wind_north, air.wind_east])
        place = self._steps * self._time_step / law.interval_s
        self._steps += 1
        self._drift += self._time_step * wind
        i = min(int(place), len(self._track) - 2)
        velocity = (self._track[i + 1] - self._track[i]) / law.interval_s
        ship = self._track[i] + (place - i) * law.interval_s * velocity
        to_ship = ship - np.array([own.north, own.east]) - self._drift
        lead = law.lead_share * math.hypot(*to_ship) / max(5.0, own.speed)
        north, east = to_ship + lead * (velocity - wind)
        sine = law.tangent_radius_m / max(1.0, math.hypot(north, east))
        tangent = math.asin(min(1.0, max(-1.0, sine)))
        wanted = math.atan2(east, north) + tangent
        return law.attack_gain * math.remainder(wanted - own.course, math.tau)


# ---------------------------------------------------------------- What is declared


@dataclass(frozen=True)
class _Ship:
    """A ship's motion.

    Attributes
    ----------
    time : from the start of the flight, every second [s]
    places : shape (times, 2) [m]
    velocity : of the same shape [m/s]
    """

    time: npt.NDArray[np.float64]
    places: npt.NDArray[np.float64]
    velocity: npt.NDArray[np.float64]


class Draw:
    """Draws the keys of one flight.

    Parameters
    ----------
    seed, number : of the search and of the flight
    folder : that files are written to
    """

    def __init__(self, seed: int, number: int, folder: Path) -> None:
        self._random = np.random.default_rng([seed, number])
        self._folder = folder
        random = self._random
        self.keys: Keys = {"seed": int(random.integers(1, 10**6)), "criteria.required": "keep_out"}
        name = str(random.choice(list(AIRCRAFT), p=list(AIRCRAFT.values())))
        aircraft = load(SCENARIO, aircraft=name)
        self._speed = float(aircraft["guidance.airspeed_mps"])
        self.keys["aircraft"] = name
        bank = math.radians(aircraft["guidance.bank_deg"])
        if self._chance(0.5):
            bank = math.radians(self._between(8.0, BANK_MAX_DEG.get(name, 50.0)))
            self.keys["guidance.bank_deg"] = round(math.degrees(bank), 1)
        self._turn_radius = self._speed**2 / (STANDARD_GRAVITY * math.tan(bank))
        self._radius = round(math.exp(self._between(math.log(20.0), math.log(1500.0))), 1)
        self._duration = 100.0
        self._area_and_start()
        following = self._mission()
        self._air()
        self._vessel(following)
        self._sensors()
        self._fault()
        self._law()

    def _chance(self, share: float) -> bool:
        return bool(self._random.random() < share)

    def _between(self, low: float, high: float) -> float:
        return float(self._random.uniform(low, high))

    def _one_of(self, **shares: float) -> str:
        weights = np.array(list(shares.values()))
        return str(self._random.choice(list(shares), p=weights / weights.sum()))

    def _area_and_start(self) -> None:
        nearest = self._radius + self._between(2.5, 4.0) * self._turn_radius + 150.0
        farthest = nearest + self._between(1.0, 3.0) * self._turn_radius + 300.0
        to_the_ship = (farthest - self._radius) / self._speed
        half_turn = math.pi * self._turn_radius / self._speed
        self._duration = round(min(400.0, 2.0 * to_the_ship + self._between(3.0, 8.0) * half_turn))
        self.keys |= {
            "keepout.radius_m": self._radius,
            "flight.duration_max_s": float(self._duration),
            "start.distance_m": [round(nearest, 1), round(farthest, 1)],
        }
        if self._chance(0.5):
            self.keys["keepout.shape"] = "cylinder"

    def _mission(self) -> bool:
        """Draw the mission; return whether the vessel may be unsteady or not known exactly."""
        mission = self._one_of(standoff=0.5, follow=0.35, track=0.15)
        self.keys["guidance.mission"] = mission
        if mission == "standoff":
            if self._chance(0.5):
                room = self._between(0.5, 2.0) * self._turn_radius + 100.0
                circle = max(self._radius + room, 2.5 * self._turn_radius)
                self.keys["reference.standoff_radius_m"] = round(circle, 1)
        else:
            self.keys["reference.shape"] = self._one_of(
                sinusoid=0.5, fastest=0.3, loiter=0.2 if mission == "track" else 0.0
            )
            self.keys["guidance.reserve"] = 0.1
        if mission == "follow":
            self.keys["flight.altitude_m"] = round(self._between(40.0, 110.0), 1)
        self._still = mission == "track"
        if self._still and self._chance(0.5):
            self.keys["guidance.approach"] = False
        return not self._still

    def _air(self) -> None:
        self._level = "none" if self._still else self._one_of(none=0.45, light=0.3, moderate=0.25)
        if self._still:
            return
        speed = round(self._between(0.2, min(10.0, 0.4 * self._speed)), 1)
        kind = self._one_of(steady=0.6, profile=0.2, table=0.2)
        if kind == "table":
            self.keys["wind.table"] = self._wind_table(speed)
        else:
            self.keys |= {
                "wind.speed_mps": speed,
                "wind.from_deg": round(self._between(-180.0, 180.0)),
            }
        if kind == "profile":
            self.keys["wind.roughness_m"] = 0.0002
        if self._level != "none":
            self.keys |= {"turbulence.level": self._level, "following.margin_law": "cascade"}
        if self._chance(0.2):
            self.keys |= {
                "turbulence.gusts": int(self._random.integers(1, 8)),
                "turbulence.gust_speed_mps": round(self._between(0.5, 6.0), 1),
                "turbulence.gust_length_s": round(self._between(1.0, 4.0), 1),
            }

    def _wind_table(self, speed: float) -> str:
        """Write a table of a wind that changes within minutes; return its path."""
        path = self._folder / "wind.csv"
        direction = self._between(0.0, 360.0)
        rows = []
        for i in range(math.ceil(self._duration / 60.0) + 2):
            at = BEGINS + timedelta(seconds=60.0 * i)
            rows.append((at.isoformat(), f"{speed:.2f}", f"{direction % 360.0:.1f}"))
            speed = min(15.0, max(0.0, speed + self._random.normal(0.0, 0.5)))
            direction += self._random.normal(0.0, 8.0)
        _write(path, ("time_utc", "speed_mps", "from_deg"), rows)
        self.keys["place.utc"] = BEGINS
        return str(path)

    def _vessel(self, free: bool) -> None:
        speed = round(self._between(0.0, min(0.8 * self._speed, 18.0)), 1)
        kind = self._one_of(steady=0.55, manoeuvres=0.3, file=0.15) if free else "steady"
        fastest, acceleration = speed, 0.0
        ship = _Ship(*_sailed(self._duration, speed, 0.0, 0.0, 0.0))
        if kind != "steady":
            acceleration = round(self._between(0.03, 0.3), 3)
            rate = min(2.0, math.degrees(acceleration / max(speed, 0.5))) * self._between(0.5, 0.95)
            turn = self._between(-170.0, 170.0)
            at = self._between(0.0, 0.7 * self._duration)
            ship = _Ship(*_sailed(self._duration, speed, at, turn, rate))
            if kind == "manoeuvres":
                manoeuvre = {"at_s": at, "turn_deg": turn, "turn_rate_deg_s": rate}
                self.keys["vessel.manoeuvres"] = [manoeuvre]
            else:
                fastest, acceleration = speed + 1.0, acceleration + 0.3
                self.keys |= {"vessel.track": self._ais_file(ship), "vessel.mmsi": MMSI}
                self.keys["place.utc"] = BEGINS
        if kind != "file":
            self.keys["vessel.speed_mps"] = speed
        by_reports = free and kind != "file" and self._chance(0.5)
        if by_reports:
            self.keys |= {
                "reports.interval_s": [2.0, 10.0],
                "reports.latency_max_s": 2.0,
                "reports.missing": round(self._between(0.0, 0.5), 2),
                "reports.position_sigma_m": 5.0,
            }
        if acceleration:
            self.keys["following.vessel_acceleration_mps2"] = acceleration
            self.keys["following.vessel_speed_max_mps"] = fastest + 0.5
        self._reported = by_reports or kind == "file"
        self._ship = ship

    def _ais_file(self, ship: _Ship) -> str:
        """Write the reports of a ship, every ten seconds; return the file's path."""
        path = self._folder / "ais.csv"
        rows = []
        for i in range(0, len(ship.time), 10):
            at = BEGINS + timedelta(seconds=float(ship.time[i]))
            north, east = ship.places[i]
            latitude = LATITUDE + north / METRES_PER_DEGREE
            scale = METRES_PER_DEGREE * math.cos(math.radians(LATITUDE))
            speed, course = math.hypot(*ship.velocity[i]), math.atan2(*ship.velocity[i][::-1])
            rows.append(
                (
                    at.isoformat(),
                    str(MMSI),
                    f"{latitude:.6f}",
                    f"{LONGITUDE + east / scale:.6f}",
                    f"{speed / 0.514444:.1f}",
                    f"{math.degrees(course) % 360.0:.1f}",
                )
            )
        _write(path, ("time_utc", "mmsi", "lat_deg", "lon_deg", "sog_kn", "cog_deg"), rows)
        return str(path)

    def _sensors(self) -> None:
        if self._still or not self._chance(0.4):
            return
        self.keys |= {
            "sensors.position_sigma_m": round(self._between(0.5, 3.0), 1),
            "sensors.velocity_sigma_mps": 0.1,
            "sensors.airspeed_sigma_mps": round(self._between(0.0, 0.5), 2),
            "sensors.airspeed_bias_mps": round(self._between(0.0, 1.0), 2),
            "sensors.heading_sigma_deg": round(self._between(0.0, 1.5), 1),
            "sensors.heading_bias_deg": round(self._between(0.0, 3.0), 1),
        }

    def _fault(self) -> None:
        kind = self._one_of(none=0.45, satellite_navigation=0.3, vessel_data=0.08, part=0.17)
        if kind == "vessel_data" and not self._reported:
            kind = "none"
        if self._still:
            kind = "none"
        if kind == "part":
            parts = ["engine", *(one.name for one in find_spec(self.keys["aircraft"]).actuators)]
            kind = "engine" if self._chance(0.5) else str(self._random.choice(parts))
        if kind == "none":
            return
        at = round(self._between(5.0, 0.8 * self._duration), 1)
        self.keys |= {"fault.kind": kind, "fault.at_s": at}
        if kind in ("satellite_navigation", "vessel_data"):
            self.keys[f"fault.{kind}_s"] = float(
                self._random.choice([10.0, 60.0, 90.0, round(self._between(3.0, 200.0), 1)])
            )

    def _law(self) -> None:
        if self._chance(0.15):
            return
        radius = self._radius * self._random.choice([0.0, self._between(0.5, 1.1)], p=[0.5, 0.5])
        places = self._ship.places
        self.keys["guidance.law"] = Hostile(
            track=tuple(round(float(value), 2) for value in places.ravel()),
            tangent_radius_m=float(radius) * float(self._random.choice([-1.0, 1.0])),
            lead_share=float(self._random.choice([0.0, 1.0, self._between(0.0, 1.5)])),
        )


def _sailed(
    duration: float, speed: float, at: float, turn: float, rate: float
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return times [s], places [m] and velocities [m/s] of a ship that turns once.

    Parameters
    ----------
    duration, speed : of the flight, and of the ship [s, m/s]
    at, turn, rate : of its turn [s, deg, deg/s]
    """
    time = np.arange(0.0, duration + 30.0)
    turned = np.sign(turn) * np.clip(rate * (time - at), 0.0, abs(turn))
    course = np.radians(turned)
    velocity = speed * np.column_stack([np.cos(course), np.sin(course)])
    between = 0.5 * (velocity[1:] + velocity[:-1])
    places = np.concatenate([np.zeros((1, 2)), np.cumsum(between, axis=0)])
    return time, places, velocity


def _write(path: Path, columns: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows([columns, *rows])


# ---------------------------------------------------------------- The search


def flown(keys: Keys) -> Mapping[str, Any]:
    """Return the row of a flight; one that cannot be declared says why as its message."""
    try:
        return {str(name): value for name, value in fly(SCENARIO, **keys).row.items()}
    except InputError as error:
        return {"outcome": "not_declared", "message": str(error)}


def main() -> None:
    """Fly the search; print violations, and what it came to."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--flights", type=int, default=2000)
    parser.add_argument("--first", type=int, default=0, help="number of the first flight")
    parser.add_argument("--seed", type=int, default=20261130)
    parser.add_argument("--out", type=Path, help="table of the flights, which is added to")
    asked = parser.parse_args()
    counted: Counter[str] = Counter()
    flight_time = 0.0
    for number in range(asked.first, asked.first + asked.flights):
        with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
            warnings.simplefilter("ignore")
            keys = Draw(asked.seed, number, Path(folder)).keys
            row = flown(keys)
        if asked.out:
            _add(asked.out, number, keys, row)
        if row["outcome"] == "not_declared" or row["outcome"] in NOT_FLOWN:
            counted["refused"] += 1
            continue
        counted["flown"] += 1
        flight_time += row["duration_s"]
        terms = exceeded_terms(row)
        counted.update(f"ratio above 1: {term}" for term in terms)
        counted["aircraft lost"] += row["outcome"] in GONE
        if row["keepout_violations"] > 0:
            why = ", ".join(terms) or "every premise held"
            if row["outcome"] in GONE:
                why += "; the aircraft was lost"
            counted[f"violations: {why}"] += 1
            within = row["keepout_radius_m"] - row["min_distance_m"]
            shown = {key: value for key, value in keys.items() if key != "guidance.law"}
            print(f"flight {number}: {within:.2f} m within r_min; {why}; {shown}", flush=True)
    print(f"{counted.pop('flown')} flights, {flight_time / 3600.0:.1f} h")
    for what, count in sorted(counted.items()):
        print(f"  {what}: {count}")


def _add(path: Path, number: int, keys: Keys, row: Mapping[str, Any]) -> None:
    """Add a flight to a table."""
    new = not path.exists()
    with path.open("a", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        if new:
            writer.writerow(("number", "aircraft", *FIGURES, "keys"))
        shown = {key: value for key, value in keys.items() if key != "guidance.law"}
        writer.writerow((number, keys["aircraft"], *(row.get(name) for name in FIGURES), shown))


if __name__ == "__main__":
    main()
