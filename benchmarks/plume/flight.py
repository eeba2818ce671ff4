"""Flights of a point that oscillates across a simulated plume behind a ship, at the height that a
search demands.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq
from scipy.special import j0

from gnc.estimation.plume.estimator import PlumeEstimator, PlumeState
from gnc.estimation.plume.prior import Expectation, GasSensor, PlumePrior, expected_plume
from gnc.mission.axis import Search
from measurement.emission import emission_of, fuel_preset, ship_of
from measurement.gases import GASES
from measurement.plume.fluctuating_plume import FluctuatingPlume
from measurement.plume.spread import MarineAir
from measurement.sniffer.sniffer import Sniffer
from measurement.sniffer.spec import SnifferSpec
from scenarios.planning.plume import co2_sensor

Array = npt.NDArray[np.float64]

AIRSPEED, TURN_RATE, CLIMB_RATE = 20.0, 0.45, 1.5
"""Of the vehicle [m/s, rad/s, m/s]."""

LOWEST, HIGHEST = 20.0, 120.0
"""Altitudes that may be flown [m]."""

KEEP_OUT = 200.0
"""Least distance from the ship [m]."""

SPEEDS = 3.0, 12.0
"""Speeds of ship and wind that are drawn from [m/s]."""

STACKS, LOADS = (20.0, 60.0), (0.2, 0.9)
"""Heights of the funnel's mouth [m] and loads of the engine that are drawn from [-]."""

WIND_ERROR = 0.6
"""Standard deviation of each component of the wind that is estimated on board [m/s]: by biases of
airspeed and heading.
"""

_CO2 = GASES.index("co2")
_STEP, _CHUNK = 0.05, 1.0
_PRESSURE_PER_METRE = -0.12
"""Of the air [hPa/m]."""


@dataclass(frozen=True)
class Case:
    """A ship, the air, and what the vehicle takes for the wind. Velocities north and east [m/s]."""

    ship_speed: float
    wind: tuple[float, float]
    wind_error: tuple[float, float]
    stack: float
    load: float
    seed: int

    @property
    def apparent(self) -> tuple[float, float]:
        """Velocity of the air past the ship, which heads north [m/s]."""
        return self.wind[0] - self.ship_speed, self.wind[1]


def draw_case(seed: int) -> Case:
    """Return a case in which the ship has 0.25 to 0.9 of the vehicle's speed through the air."""
    generator = np.random.default_rng(seed)
    while True:
        speed, bearing = generator.uniform(*SPEEDS), generator.uniform(0.0, 2.0 * math.pi)
        case = Case(
            ship_speed=generator.uniform(*SPEEDS),
            wind=(speed * math.cos(bearing), speed * math.sin(bearing)),
            wind_error=(generator.normal(0.0, WIND_ERROR), generator.normal(0.0, WIND_ERROR)),
            stack=generator.uniform(*STACKS),
            load=generator.uniform(*LOADS),
            seed=seed,
        )
        if 0.25 < math.hypot(*case.apparent) / AIRSPEED < 0.9:
            return case


@dataclass
class Flight:
    """What happened; a row of ``passes`` is time, altitude, estimated height, its deviation, true
    height, peak over centre.
    """

    case: Case
    estimator: PlumeEstimator
    passes: list[tuple[float, ...]] = field(default_factory=list)
    intervals: list[tuple[float, float]] = field(default_factory=list)
    states: list[PlumeState] = field(default_factory=list)
    spread: float = math.nan


def prior_of(case: Case, sensor: GasSensor, distance: float) -> PlumePrior:
    """Return what is expected of a ship of this class, without her stack and her load."""
    ship, fuel = ship_of("container"), fuel_preset("mgo", 0.1)
    load = math.sqrt(LOADS[0] * LOADS[1])
    usual = emission_of(ship, fuel, power=load * ship.power_max)
    north, east = (a + b for a, b in zip(case.apparent, case.wind_error, strict=True))
    expected = Expectation(
        wind_deviation=WIND_ERROR,
        source_height=0.5 * sum(STACKS),
        source_deviation=(STACKS[1] - STACKS[0]) / math.sqrt(12.0),
        stack_diameter=usual.stack_diameter,
        exhaust_speed=usual.exhaust_speed,
        momentum_flux=usual.momentum_flux,
        buoyancy_flux=usual.buoyancy_flux,
        co2_rate=usual.rates[_CO2],
        load_deviation=math.log(LOADS[1] / LOADS[0]) / math.sqrt(12.0),
        sensor=sensor,
        lowest=LOWEST,
        highest=HIGHEST,
    )
    wind_speed = math.hypot(case.wind[0] + case.wind_error[0], case.wind[1] + case.wind_error[1])
    return expected_plume(
        expected, distance=distance, apparent_wind=math.hypot(north, east), wind_speed=wind_speed
    )


class Orbit:
    """The paper's oscillation: the course swings by alpha about the axis, J0(alpha) = nu."""

    def __init__(self, apparent: float) -> None:
        swing = float(brentq(lambda a: j0(a) - apparent / AIRSPEED, 1e-3, 2.404))
        self.pass_time = math.pi * swing / TURN_RATE
        count = round(2.0 * self.pass_time / _STEP)
        course = swing * np.cos(2.0 * math.pi * np.arange(count) / count)
        along = (
            np.cumsum(AIRSPEED * np.cos(course) - float(np.mean(AIRSPEED * np.cos(course)))) * _STEP
        )
        across = np.cumsum(AIRSPEED * np.sin(course)) * _STEP
        self._along, self._across = along - along.mean(), across - across.mean()
        self.distance = KEEP_OUT + float(np.abs(self._along).max())

    def at(self, step: Array) -> tuple[Array, Array]:
        """Return along and across at steps of 0.05 s [m]."""
        index = np.asarray(step, dtype=np.intp) % len(self._along)
        return self.distance + self._along[index], self._across[index]


def fly(
    case: Case,
    spec: SnifferSpec,
    search: Callable[[], Search],
    *,
    estimator: Callable[[PlumePrior], PlumeEstimator] = PlumeEstimator,
    duration: float = 300.0,
    knowing: bool = False,
) -> Flight:
    """Return a flight from the moment at which the orbit is reached.

    Parameters
    ----------
    case, spec : plume and sniffer
    search, estimator : what makes them
    duration : [s]
    knowing : whether the vehicle flies on the true axis, whatever it estimates
    """
    orbit = Orbit(math.hypot(*case.apparent))
    sensor = co2_sensor(spec)
    flight = Flight(case, estimator(prior_of(case, sensor, orbit.distance)))
    simulation = _Simulation(case, spec, orbit, duration)
    searcher, filtered = search(), flight.estimator
    true_height = simulation.axis_height(orbit.distance)
    altitude = min(max(true_height if knowing else filtered.height, LOWEST), HIGHEST)
    demanded, offset, offset_demanded = altitude, 0.0, 0.0
    pass_peak = 0.0
    for _ in range(round(duration / _CHUNK)):
        count = round(_CHUNK / _STEP)
        altitudes = altitude + np.clip(
            demanded - altitude,
            -CLIMB_RATE * _STEP * np.arange(1, count + 1),
            CLIMB_RATE * _STEP * np.arange(1, count + 1),
        )
        offset += min(max(offset_demanded - offset, -2.0), 2.0)
        altitude = float(altitudes[-1])
        times, along, across, readings, fraction = simulation.advance(
            altitudes, offset, knowing=knowing
        )
        pass_peak = max(pass_peak, float(np.nanmax(fraction, initial=0.0)))
        done = False
        for i in range(0, count, 4):
            filtered.predict(4 * _STEP)
            reading = readings.get(i, math.nan)
            done |= filtered.update(
                along[i], across[i], altitudes[i], reading, apparent_wind=simulation.believed
            )
        if done:
            flight.passes.append(
                (
                    times[-1],
                    altitude,
                    filtered.height,
                    filtered.height_deviation,
                    true_height,
                    pass_peak,
                )
            )
            flight.intervals.append(filtered.height_interval)
            flight.states.append(filtered.state)
            pass_peak = 0.0
            if not knowing:
                demanded, offset_demanded = (
                    searcher.next_altitude(filtered, altitude, orbit.pass_time),
                    filtered.offset,
                )
    flight.spread = simulation.spread
    return flight


class _Simulation:
    """Plume and sniffer along the way of the vehicle."""

    def __init__(self, case: Case, spec: SnifferSpec, orbit: Orbit, duration: float) -> None:
        ship, fuel = ship_of("container"), fuel_preset("mgo", 0.1)
        emission = emission_of(ship, fuel, power=case.load * ship.power_max)
        time = np.arange(-300.0, duration + 2.0, 0.5)
        self._rate = emission.rates[_CO2]
        self._plume = FluctuatingPlume(
            emission,
            MarineAir(wind_speed=math.hypot(*case.wind)),
            time=time,
            north=(case.ship_speed - case.wind[0]) * time,
            east=-case.wind[1] * time,
            source_height=case.stack,
            seed=case.seed,
        )
        generator = np.random.default_rng([case.seed, 1])
        only = replace(spec.drawn(generator), channels=(spec.drawn(generator).known("co2"),))
        self._sniffer = Sniffer(only, generator=generator, time_step=_STEP)
        self._case, self._orbit, self._samples = case, orbit, 0
        north, east = case.apparent
        self.true_axis = math.atan2(east, north)
        self.apparent = math.hypot(north, east)
        north, east = north + case.wind_error[0], east + case.wind_error[1]
        self.axis, self.believed = math.atan2(east, north), math.hypot(north, east)
        # Of the ship, by her reports [m].
        self._off = generator.normal(0.0, 3.0, 2)
        self.spread = math.nan

    def axis_height(self, distance: float) -> float:
        """Return the true height of the mean axis at a distance behind the funnel [m]."""
        _, _, height = self._plume.axis(0.0, np.array([distance / self.apparent]))
        return float(height[0])

    def advance(
        self, altitudes: Array, offset: float, *, knowing: bool
    ) -> tuple[Array, Array, Array, dict[int, float], Array]:
        """Return times, along and across as they are believed, readings by step, and the
        concentration over the centre's.
        """
        steps: Array = self._samples + np.arange(1.0, len(altitudes) + 1.0)
        self._samples += len(altitudes)
        times: Array = _STEP * steps
        along, across = self._orbit.at(steps)
        across = across + offset
        axis = self.true_axis if knowing else self.axis
        cos_a, sin_a = math.cos(axis), math.sin(axis)
        case = self._case
        off = np.zeros(2) if knowing else self._off
        north = along * cos_a - across * sin_a + (case.ship_speed - case.wind[0]) * times + off[0]
        east = along * sin_a + across * cos_a - case.wind[1] * times + off[1]
        sample = self._plume.sample(times, north, east, altitudes)
        air = np.zeros((len(steps), len(GASES)))
        air[:, _CO2] = 420.0 + 1e6 * self._rate * sample.dilution
        with np.errstate(invalid="ignore", divide="ignore"):
            fraction = sample.dilution / sample.axis_dilution
        self.spread = (
            float(np.nanmean(sample.sigma_z)) if np.isfinite(sample.sigma_z).any() else math.nan
        )
        read = self._sniffer.advance(air, _PRESSURE_PER_METRE * (altitudes - 50.0))
        # A reading belongs to the step at which it was taken.
        index = np.rint(read.time / _STEP).astype(int) - (int(steps[0]) - 1)
        readings = dict(zip(index.tolist(), read.values[:, _CO2].tolist(), strict=True))
        return times, along, across, readings, fraction
