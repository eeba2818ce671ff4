"""Whether a start that is refused has an escape after all: every constant and every bang-bang
command is tried from it.

``python -m benchmarks.refused_starts`` plans the flights of ``starts_anywhere``, flies none, and
searches from each start that is refused for the command that keeps farthest off the vessel. The
vehicle follows its command after the dead time and with the lag that the guard reckons with, but
does not deviate from that. Keys may be given: ``keepout.radius_m=50``.
"""

import argparse
import itertools
import math
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.vehicle import x8_setup
from common.physics import bank_for_heading_rate, heading_rate_for_bank
from gnc.errors import InfeasibleError
from scenarios.errors import InputError
from scenarios.experiment.requests import Experiment
from scenarios.experiment.sampling import SamplingDesign
from scenarios.planning.limits import omega_max
from scenarios.planning.missions import plan_flight, sampled_start
from scenarios.scenario.files import load_study
from scenarios.scenario.scenario import Scenario
from scenarios.vehicles.vehicle_setup import VehicleSetup
from scenarios.world.noise import start_generator
from scenarios.world.world import vessel_of

STUDY = "starts_anywhere"

STEP = 0.05
"""Time step of the vehicle: 1 m of way, after which the distance is looked at [s]."""

DURATION = 60.0
"""How long a command is followed [s]: straight away, the distance has risen long before."""

SWITCHES = np.arange(0.0, 14.01, 0.2)
"""When a bang-bang command may change [s]: in 14 s the X8 turns once round."""

CONSTANTS = np.linspace(-1.0, 1.0, 81)
"""Constant commands, of the largest [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Refused:
    """A start that is refused.

    Attributes
    ----------
    place : north and east of the vessel [m]
    course : of the UAV [rad]
    vessel : velocity, north and east [m/s]
    scenario, setup : of the flight, and of its vehicle
    """

    place: tuple[float, float]
    course: float
    vessel: tuple[float, float]
    scenario: Scenario
    setup: VehicleSetup


def refused_starts(keys: list[str]) -> Iterator[Refused | None]:
    """Yield each start that is refused, and None for each that is accepted."""
    study = load_study(STUDY, keys)
    if not isinstance(study, Scenario):
        raise TypeError("starts are those of flights")
    with tempfile.TemporaryDirectory() as folder:
        setup = x8_setup(study, Path(folder))[1]
    experiment = Experiment(STUDY, study)
    points = SamplingDesign(
        study.sampling, dimension=len(study.draws), flights=experiment.flights, seed=study.seed
    )
    for number in range(experiment.flights):
        flight = experiment.request(number, points.at(number))
        try:
            plan_flight(flight.scenario, flight_id=flight.flight_id, seed=flight.noise, setup=setup)
        except InfeasibleError:
            vessel = vessel_of(flight.scenario)
            course, velocity = vessel.course(0.0), vessel.motion(0.0)[2:]
            start = sampled_start(
                flight.scenario.start,
                start_generator(flight.noise),
                course=course,
                axis=course + math.pi,
            )
            yield Refused(
                place=(start.north, start.east),
                course=start.course,
                vessel=velocity,
                scenario=flight.scenario,
                setup=setup,
            )
        else:
            yield None


def farthest(start: Refused, *, full_throttle: bool) -> float:
    """Return the closest approach under the best of all commands tried [m].

    At full throttle the airspeed goes to the aircraft's highest, and the heading rate is limited by
    the bank.
    """
    guidance, setup = start.scenario.guidance, start.setup
    first, second, third, until, until_second = _commands()
    north, east = (np.full(first.size, value) for value in start.place)
    course, turn = np.full(first.size, start.course), np.zeros(first.size)
    closest = np.hypot(north, east)
    airspeed, limit, lag = guidance.airspeed_mps, omega_max(guidance), setup.reversal.lag
    bank = bank_for_heading_rate(limit, airspeed)
    kept = math.exp(-STEP / lag)
    for i in range(round(DURATION / STEP)):
        since = i * STEP - setup.reversal.delay
        share = (
            np.where(since < until, first, np.where(since < until_second, second, third))
            if since >= 0.0
            else 0.0 * first
        )
        command = share * min(limit, heading_rate_for_bank(bank, airspeed))
        mean = command + (turn - command) * lag * (1.0 - kept) / STEP
        middle = course + 0.25 * STEP * (turn + mean)
        north += (airspeed * np.cos(middle) - start.vessel[0]) * STEP
        east += (airspeed * np.sin(middle) - start.vessel[1]) * STEP
        course, turn = course + mean * STEP, command + (turn - command) * kept
        if full_throttle:
            airspeed += (setup.airspeed_max - airspeed) * (
                1.0 - math.exp(-STEP * setup.airspeed_bandwidth)
            )
        np.minimum(closest, np.hypot(north, east), out=closest)
    return float(closest.max())


def _commands() -> list[np.ndarray]:
    """Return commands as shares of the largest: a first, a second and a third, and until when the
    first two are given [s].
    """
    pairs = [(until, second) for until in SWITCHES for second in SWITCHES if second >= until]
    sides = itertools.product((1.0, -1.0), (0.0, 1.0), (1.0, 0.0, -1.0))
    bangs = [
        (side, -side * back, side * last, *pair) for side, back, last in sides for pair in pairs
    ]
    constants = [(share, share, share, 0.0, 0.0) for share in CONSTANTS]
    return list(np.array(bangs + constants).T)


def main() -> None:
    """Print how many starts are refused, and from how many of them the search finds an escape."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("keys", nargs="*", metavar="KEY=VALUE", help="keys of the scenario")
    asked = parser.parse_args()
    try:
        starts = list(refused_starts(asked.keys))
    except InputError as error:
        parser.exit(2, f"error: {error}\n")
    refused = [start for start in starts if start is not None]
    print(f"{len(starts)} starts, {len(refused)} refused")
    for title, full_throttle in (("the guidance's airspeed", False), ("full throttle", True)):
        spare = [
            farthest(start, full_throttle=full_throttle) - start.scenario.keepout.radius_m
            for start in refused
        ]
        found = [value for value in spare if value >= 0.0]
        most = f", by {max(found):.2f} m at most" if found else ""
        print(f"at {title}: an escape from {len(found)} of them{most}")


if __name__ == "__main__":
    main()
