"""The ships of a patrol and the wind, from the study's seed and the patrol's number alone."""

import math
import zlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from extensions.patrol.keys import PatrolKeys
from extensions.patrol.route import Air, Mover, least_distance
from scenarios.errors import InputError
from scenarios.experiment.draws import sampled_flight
from scenarios.scenario.scenario import Scenario
from scenarios.world.plume import fuel_of
from scenarios.world.vessel import check_manoeuvres, given_place
from scenarios.world.wind import wind_of

_TRIES = 2000
"""Number of places that are tried for a ship."""

_WIND = "wind."
"""Beginning of the keys that are the same for all ships of a patrol."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Ship:
    """A ship of a patrol.

    Attributes
    ----------
    mover : its place and motion
    scenario : of a flight beside it, without random variables and with the seed of its noise
    """

    mover: Mover
    scenario: Scenario

    @property
    def course(self) -> float:
        """Return its course [rad]."""
        return math.radians(self.scenario.vessel.course_deg)

    @property
    def sulphur_percent(self) -> float:
        """Return the sulphur in its fuel by mass [%]."""
        return fuel_of(self.scenario).sulphur_percent


@dataclass(frozen=True, slots=True, kw_only=True)
class Patrol:
    """The ships of a patrol.

    Attributes
    ----------
    name : of the patrol, part of the names of its flights
    seed : of its places
    air : wind at the altitude of the ways between ships, and airspeed
    ships : in no order
    """

    name: str
    seed: int
    air: Air
    ships: Sequence[Ship]

    @property
    def movers(self) -> list[Mover]:
        """Return places and motions of the ships."""
        return [ship.mover for ship in self.ships]


def sampled_patrol(study: str, scenario: Scenario, number: int) -> Patrol:
    """Return a patrol.

    Parameters
    ----------
    study, scenario : the study's name, and the scenario from which its patrols are sampled
    number : of the patrol, from 0

    Raises
    ------
    InputError : the ships do not find room beside each other, a sampled value is out of range, or
        no ship has an apparent wind within ``scenario.speed_ratio``
    """
    by_wind = tuple(draw for draw in scenario.draws if draw.key.startswith(_WIND))
    by_ship = tuple(draw for draw in scenario.draws if not draw.key.startswith(_WIND))
    # The speed ratio is a ship's: any wind is possible.
    air = sampled_flight(
        study,
        scenario.model_copy(
            update={"draws": by_wind, "speed_ratio": Scenario.model_fields["speed_ratio"].default}
        ),
        number,
    )
    name = f"{study}_{number:05d}"
    sampled = [
        sampled_flight(
            name,
            air.scenario.model_copy(update={"draws": by_ship, "speed_ratio": scenario.speed_ratio}),
            i,
        )
        for i in range(PatrolKeys.of(scenario).patrol.ships)
    ]
    generator = np.random.default_rng(
        np.random.SeedSequence([scenario.seed, zlib.crc32(b"places"), number])
    )
    flown = [
        sample.scenario.model_copy(update={"draws": (), "flights": 1, "flight_seed": sample.seed})
        for sample in sampled
    ]
    movers = _placed([_velocity(of) for of in flown], scenario, generator)
    return Patrol(
        name=name,
        seed=air.seed,
        air=Air(_wind(air.scenario), scenario.guidance.airspeed_mps),
        ships=[Ship(mover=mover, scenario=of) for mover, of in zip(movers, flown, strict=True)],
    )


def _velocity(scenario: Scenario) -> complex:
    check_manoeuvres(scenario.vessel, scenario.vessel_speed)
    course = math.radians(scenario.vessel.course_deg)
    return scenario.vessel_speed * complex(math.cos(course), math.sin(course))


def _wind(scenario: Scenario) -> complex:
    """Return the velocity of the air at the altitude of the flights [m/s]."""
    altitude = scenario.altitude
    return complex(*wind_of(scenario, given_place(scenario.place, altitude)).now(0.0, altitude))


def _placed(
    velocities: Sequence[complex], scenario: Scenario, generator: np.random.Generator
) -> list[Mover]:
    """Return ships at random places that stay apart from each other."""
    p = PatrolKeys.of(scenario).patrol
    placed: list[Mover] = []
    for velocity in velocities:
        for _ in range(_TRIES):
            place = complex(*generator.uniform(-0.5 * p.area_m, 0.5 * p.area_m, size=2))
            apart = (
                least_distance(place - ship.place, velocity - ship.velocity, p.endurance_s)
                for ship in placed
            )
            if min((abs(place), *apart)) >= p.separation_m:
                placed.append(Mover(place, velocity))
                break
        else:
            raise InputError(
                f"patrol.separation_m is {p.separation_m:g} m, which patrol.ships = {p.ships} in a"
                f" square of {p.area_m:g} m cannot keep for {p.endurance_s:g} s: let it be less,"
                " or patrol.area_m more"
            )
    return placed
