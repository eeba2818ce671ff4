"""How often a sound engine is taken for failed, and how late one that has failed is noticed.

``python -m benchmarks.thrust_test`` flies each aircraft with airspeed and bank that jump, in calm
air and in turbulence, and prints for how many hours, the false alarms, the largest missing height
of energy over that of an alarm, and the rate of false alarms that errors of measurement alone make.
Then engines fail at random instants of such flights: delays are printed, with how often the
throttle commanded so little that nothing was missing. Last, thrust is declared lost in sound
flights, as a false alarm would do, and the time is printed until it counts as there again. The
airspeed is read with the noise and bias of ``sensor_errors``.
"""

import argparse
import itertools
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from aircraft.faults import ENGINE
from aircraft.fdm import Fdm
from aircraft.fleet.find import find_spec
from aircraft.state import EquatorFrame
from aircraft.trim import Trim, trim
from aircraft.weather import TURBULENCE, Weather, low_altitude_turbulence
from common.physics import SECONDS_PER_HOUR
from gnc.estimation.health import CHECK_INTERVAL
from gnc.estimation.thrust import ThrustMonitor
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.flight.part_failure import glide_airspeed
from innerloop.jsbsim.system import write_root
from innerloop.schedule import Schedule
from innerloop.store import designed
from scenarios.vehicles.jsbsim import Telemetry
from scenarios.vehicles.thrust_expectation import (
    ThrustExpectation,
    ThrustTest,
    hard_flight,
    thrust_expectation,
)

AIRCRAFT = ("x8", "aerosonde", "c172p", "T37")
LEVELS = ("none", "light", "moderate")

ALTITUDE = 60.0
"""Height of the flights [m]."""

AIRSPEED_SIGMA, AIRSPEED_BIAS = 0.3, 0.5
"""Noise and largest bias of the airspeed that is read [m/s], those of ``sensor_errors``."""

FLIGHT_TIME = 900.0
"""Duration of a sound flight [s]."""

BEFORE, AFTER = (20.0, 60.0), 30.0
"""Shortest and longest time until an engine fails or an alarm is given, and how long it is watched
for what follows [s]."""


class Noticed(NamedTuple):
    """When something is noticed [s], and how far the airspeed is then below the slowest that is
    commanded [m/s].
    """

    delay: float
    below: float


class Flights:
    """Hard flights of one aircraft in one turbulence, watched by the monitor of its thrust.

    Parameters
    ----------
    schedule, root, start : of the aircraft, and where its flights begin
    expectation : of its thrust
    level : of turbulence
    seed : of commands, turbulence and sensors
    """

    def __init__(
        self,
        schedule: Schedule,
        root: Path,
        start: Trim,
        expectation: ThrustExpectation,
        level: str,
        seed: int,
    ) -> None:
        self._aircraft = AutopilotedAircraft(schedule.spec, root, failable=True)
        self._envelope = schedule.envelope
        self._start = start
        self._turbulence = TURBULENCE.get(level)
        self._random = np.random.default_rng([seed, LEVELS.index(level)])
        gusts = 0.0
        if self._turbulence:
            air = low_altitude_turbulence(ALTITUDE, self._turbulence.wind_at_20ft)
            gusts = air.horizontal
        test = expectation.test(
            start.airspeed,
            glide_airspeed(start.airspeed, schedule.envelope.airspeed_min),
            gusts=gusts,
            airspeed_sigma=AIRSPEED_SIGMA,
            airspeed_bias=AIRSPEED_BIAS,
        )
        if test is None:
            raise SystemExit(f"error: {schedule.spec.name}: accelerometers do not show its thrust")
        self.test: ThrustTest = test

    def watched(self) -> Iterator[tuple[ThrustMonitor, float]]:
        """Yield the monitor after each check of a new flight, and how far the airspeed is below the
        slowest that is commanded [m/s].
        """
        seed = int(self._random.integers(2**31))
        weather = Weather(turbulence=self._turbulence, seed=seed)
        bias = self._random.uniform(-AIRSPEED_BIAS, AIRSPEED_BIAS)
        monitor = ThrustMonitor(self.test.parameters, CHECK_INTERVAL)
        read_engine = Telemetry(self._aircraft.fdm, EquatorFrame(self._start.altitude)).engine
        for airspeed in hard_flight(
            self._aircraft, self._envelope, self._start, weather, self._random
        ):
            read = airspeed + bias + AIRSPEED_SIGMA * self._random.standard_normal()
            monitor.update(read, read_engine())
            yield monitor, self._envelope.airspeed_min - airspeed

    def sound(self, hours: float) -> tuple[int, float]:
        """Return the false alarms of sound flights, and the largest missing height over that of an
        alarm [-].
        """
        alarms, largest, checks = 0, 0.0, round(FLIGHT_TIME / CHECK_INTERVAL)
        for _ in range(round(hours * SECONDS_PER_HOUR / FLIGHT_TIME)):
            for monitor, _ in itertools.islice(self.watched(), checks):
                if monitor.lost:
                    alarms += 1
                    break
                largest = max(largest, monitor.missing)
        return alarms, largest / self.test.parameters.energy_height

    def failures(self, count: int) -> list[Noticed]:
        """Return when failures of the engine are noticed; infinitely late where none is within the
        time that is watched.
        """
        found = []
        for _ in range(count):
            flight, _ = self._begun()
            self._aircraft.fail(ENGINE)
            found.append(_first(flight, lost=True))
        return found

    def taken_back(self, count: int) -> list[Noticed]:
        """Return when false alarms are taken back; infinitely late likewise."""
        found = []
        for _ in range(count):
            flight, monitor = self._begun()
            monitor.lost, monitor.missing = True, 0.0
            found.append(_first(flight, lost=False))
        return found

    def _begun(self) -> tuple[Iterator[tuple[ThrustMonitor, float]], ThrustMonitor]:
        """Return a flight under way, and its monitor."""
        flight = self.watched()
        before = round(self._random.uniform(*BEFORE) / CHECK_INTERVAL)
        monitor, _ = next(itertools.islice(flight, before, None))
        return flight, monitor


def _first(flight: Iterator[tuple[ThrustMonitor, float]], *, lost: bool) -> Noticed:
    """Return when thrust counts as lost, or as there."""
    checks = itertools.islice(flight, round(AFTER / CHECK_INTERVAL))
    for i, (monitor, below) in enumerate(checks):
        if monitor.lost is lost:
            return Noticed(CHECK_INTERVAL * (i + 1), below)
    return Noticed(np.inf, np.nan)


def _described(noticed: list[Noticed]) -> str:
    within = [each for each in noticed if np.isfinite(each.delay)]
    if not within:
        return f"none of {len(noticed)}"
    quantiles = np.percentile([each.delay for each in within], (50, 95, 100))
    return (
        "median {:.1f}, 95 % {:.1f}, longest {:.1f} s".format(*quantiles)
        + f" ({len(within)} of {len(noticed)} within {AFTER:g} s), airspeed then up to"
        f" {max(0.0, *(each.below for each in within)):.1f} m/s below the slowest commanded"
    )


def main() -> None:
    """Fly, and print the tables."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--hours", type=float, default=1.0, help="of each aircraft and turbulence")
    parser.add_argument("--failures", type=int, default=40, help="of each aircraft and turbulence")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("aircraft", nargs="*", default=AIRCRAFT)
    given = parser.parse_args()
    for name in given.aircraft:
        spec = find_spec(name)
        schedule = designed(spec, ALTITUDE).design.schedule
        with tempfile.TemporaryDirectory() as folder:
            root = write_root(schedule, Path(folder))
            level = schedule.level(schedule.middle)
            start = trim(Fdm(spec), airspeed=level.airspeed, altitude=ALTITUDE, start=level)
            sound = AutopilotedAircraft(spec, root)
            expectation = thrust_expectation(sound, schedule, start)
            for turbulence in LEVELS:
                flights = Flights(schedule, root, start, expectation, turbulence, given.seed)
                test = flights.test
                begin = time.perf_counter()
                alarms, largest = flights.sound(given.hours)
                took = time.perf_counter() - begin
                print(
                    f"{name}, turbulence {turbulence}: {given.hours:g} h sound in {took:.0f} s,"
                    f" {alarms} false alarms, largest sum {largest:.3f} of an alarm's"
                    f" {test.parameters.energy_height:.2f} m; by errors of measurement"
                    f" {SECONDS_PER_HOUR / test.false_alarm_time:.1e} per h; level flight without"
                    f" thrust is noticed after {test.detection_time:.2f} s",
                    flush=True,
                )
                failed = _described(flights.failures(given.failures))
                print(f"  engine fails: {failed}", flush=True)
                back = _described(flights.taken_back(given.failures))
                print(f"  false alarm taken back: {back}", flush=True)


if __name__ == "__main__":
    main()
