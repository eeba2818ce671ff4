"""The expected thrust of an aircraft, and the accuracy with which its accelerometers show it."""

import itertools
import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace

import numpy as np
import numpy.typing as npt

from aircraft.fdm import Fdm
from aircraft.spec import Envelope
from aircraft.state import EquatorFrame
from aircraft.trim import Trim
from aircraft.weather import TURBULENCE, Weather, low_altitude_turbulence
from common.physics import METRES_PER_FOOT, SECONDS_PER_HOUR, heading_rate_for_bank
from gnc.estimation.health import CHECK_INTERVAL
from gnc.estimation.thrust import (
    EXPECTED_SHARE,
    ThrustModel,
    ThrustParameters,
    height_for,
    time_between_false_alarms,
)
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.flight.thrust_map import (
    THRUST,
    WEIGHT,
    measure_thrust,
)
from innerloop.schedule import Schedule
from scenarios.vehicles.jsbsim import Telemetry

_COMMAND_STEP = 0.05
"""Time for which commands are held in a hard flight [s], as long as by the guidance at 20 Hz."""

_HOLDS = (0.5, 1.0, 3.0, 8.0, 20.0)
"""Typical times between jumps of commands in a hard flight [s]: some come before the last has been
followed, some long after."""

_JUMP_PROBABILITY = 0.6
"""Probability that airspeed or bank is among what jumps [-]; each goes to an end of its range or to
V_r or level flight mostly, where the jumps are largest."""

_MEASURED_TIME = 60.0
"""Duration of a flight that errors are measured in [s]."""

_WINDOWS = (1.0, 2.0, 5.0)
"""Durations over which errors are summed up to measure how fast their variance grows [s]."""

_MEASURED_IN = "moderate"
"""Turbulence that the errors of gusts are measured in."""

_MEASURED_AT = 150.0
"""Height above which the errors of gusts are not measured [m]: their statistics hold lower down."""

_SEED = 20261128
"""Seed of the flights that errors are measured in."""

Array = npt.NDArray[np.float64]

FALSE_ALARM_HOURS = 1e6
"""Flight hours of a sound aircraft in which errors of measurement once take its thrust for lost
[h].
"""

THRUST_LOST_TIME = 1.0
"""Time for which all thrust of level flight has to be missing, at least, until it counts as lost
[s]. An acceleration is measured once in each interval of the health monitor; several of them have
to agree, for all errors.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ThrustErrors:
    """Errors of the thrust over the weight that accelerometers show.

    Attributes
    ----------
    lack : mean by which the shown thrust is less than the true thrust [-]
    density : rate at which the variance of their integral over time grows [s]
    """

    lack: float
    density: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ThrustTest:
    """The test for a loss of thrust, with its rate of false alarms and its delay.

    Attributes
    ----------
    parameters : of the monitor
    airspeed : V_r [m/s]
    drift : at which the monitor's sum falls while the thrust is that of level flight [m/s]
    density : rate at which the variance of the monitor's sum grows [m^2/s]
    """

    parameters: ThrustParameters
    airspeed: float
    drift: float
    density: float

    @property
    def false_alarm_time(self) -> float:
        """Mean time between false alarms by errors of measurement, in level flight [s]."""
        height = self.parameters.energy_height
        return time_between_false_alarms(self.drift, self.density, height)

    @property
    def detection_time(self) -> float:
        """Time from the loss of all thrust of level flight until it counts as lost [s].

        The missing energy height grows at V times the missing thrust over the weight, minus the
        allowance; it is checked at intervals.
        """
        rate = self.airspeed * (1.0 - EXPECTED_SHARE) * self.parameters.level
        return self.parameters.energy_height / rate + CHECK_INTERVAL


@dataclass(frozen=True, slots=True, kw_only=True)
class ThrustExpectation:
    """The expected thrust of an aircraft, and the errors with which accelerometers show it.

    Attributes
    ----------
    model : of the aircraft
    calm, gusty : errors in calm air, and in gusts of some strength
    gusts : standard deviation of these gusts along the path [m/s]
    """

    model: ThrustModel
    calm: ThrustErrors
    gusty: ThrustErrors
    gusts: float

    def errors(self, gusts: float) -> ThrustErrors:
        """Return the errors in gusts of a standard deviation [m/s]. They grow with its square: the
        mean because drag is quadratic in the incidence, the density because it is a variance.
        """
        share = (gusts / self.gusts) ** 2
        more_lack = max(0.0, self.gusty.lack - self.calm.lack)
        more_density = max(0.0, self.gusty.density - self.calm.density)
        return ThrustErrors(
            lack=self.calm.lack + share * more_lack,
            density=self.calm.density + share * more_density,
        )

    def test(
        self,
        airspeed: float,
        slow_airspeed: float,
        *,
        gusts: float,
        airspeed_sigma: float,
        airspeed_bias: float,
    ) -> ThrustTest | None:
        """Return the test for a loss of thrust; None if the mean error alone reaches the allowance.

        Parameters
        ----------
        airspeed, slow_airspeed : V_r, and the airspeed above which the thrust of level flight is
            enough [m/s]
        gusts : standard deviation of gusts along the path [m/s]
        airspeed_sigma, airspeed_bias : noise and largest bias of the measured airspeed [m/s]
        """
        errors = self.errors(gusts)
        slope = abs(airspeed_slope(self.model, airspeed))
        density = errors.density + CHECK_INTERVAL * (slope * airspeed_sigma) ** 2
        level = self.model.drag(airspeed, 1.0)
        drift = EXPECTED_SHARE * level - errors.lack - slope * airspeed_bias
        # There is no drift either if the aircraft has left its envelope in these abrupt manoeuvres.
        if not drift > 0.0:
            return None
        drift, density = airspeed * drift, airspeed**2 * density
        height = height_for(drift, density, SECONDS_PER_HOUR * FALSE_ALARM_HOURS)
        least = airspeed * (1.0 - EXPECTED_SHARE) * level * THRUST_LOST_TIME
        return ThrustTest(
            parameters=ThrustParameters(
                model=self.model,
                level=level,
                slow_airspeed=slow_airspeed,
                energy_height=max(height, least),
            ),
            airspeed=airspeed,
            drift=drift,
            density=density,
        )


def thrust_expectation(
    aircraft: AutopilotedAircraft, schedule: Schedule, start: Trim
) -> ThrustExpectation:
    """Return the expected thrust of an aircraft. It is measured with the body held still; its
    errors are measured in two flights with abrupt commands, in calm air and in turbulence.

    Parameters
    ----------
    aircraft : with its autopilot; its flight is ended
    schedule : of the autopilot
    start : straight and level equilibrium
    """
    model = ThrustModel(**asdict(measure_thrust(Fdm(schedule.spec), schedule)))
    turbulence = TURBULENCE[_MEASURED_IN]
    height = min(start.altitude, _MEASURED_AT)
    start = replace(start, altitude=height)
    calm, gusty = (
        _errors(aircraft, schedule.envelope, start, model, Weather(turbulence=each, seed=_SEED))
        for each in (None, turbulence)
    )
    gusts = low_altitude_turbulence(height, turbulence.wind_at_20ft).horizontal
    return ThrustExpectation(model=model, calm=calm, gusty=gusty, gusts=gusts)


def hard_flight(
    aircraft: AutopilotedAircraft,
    envelope: Envelope,
    start: Trim,
    weather: Weather,
    generator: np.random.Generator,
) -> Iterator[float]:
    """Yield the airspeed [m/s] at each check of the health, in a flight whose commands jump.

    The commands of airspeed and bank jump between the ends of their ranges, some before the
    aircraft has reached an end, some long after.

    Parameters
    ----------
    aircraft : with its autopilot; its flight is ended
    envelope : range of the commands
    start : straight and level equilibrium
    weather : of the flight
    generator : of the commands
    """
    aircraft.release(
        start.state(), airspeed=start.airspeed, altitude=start.altitude, weather=weather
    )
    read_airspeed = aircraft.fdm.node("velocities/vt-fps").get_double_value
    runs = round(_COMMAND_STEP / aircraft.fdm.time_step)
    bank, airspeed, left = 0.0, start.airspeed, 0.0
    while True:
        for _ in range(round(CHECK_INTERVAL / _COMMAND_STEP)):
            if left <= 0.0:
                left = generator.choice(_HOLDS) * generator.uniform(0.5, 1.5)
                if generator.random() < _JUMP_PROBABILITY:
                    side = generator.choice((-1.0, 0.0, 1.0))
                    bank = side * envelope.bank * generator.uniform(0.5, 1.0)
                if generator.random() < _JUMP_PROBABILITY:
                    low, high = envelope.airspeed_min, envelope.airspeed_max
                    between = generator.uniform(low, high)
                    airspeed = generator.choice((low, high, start.airspeed, between))
            left -= _COMMAND_STEP
            measured = METRES_PER_FOOT * read_airspeed()
            aircraft.command_heading_rate(heading_rate_for_bank(bank, measured))
            aircraft.command_airspeed(float(airspeed))
            for _ in range(runs):
                aircraft.run()
        yield METRES_PER_FOOT * read_airspeed()


def _errors(
    aircraft: AutopilotedAircraft,
    envelope: Envelope,
    start: Trim,
    model: ThrustModel,
    weather: Weather,
) -> ThrustErrors:
    fdm = aircraft.fdm
    read_engine = Telemetry(fdm, EquatorFrame(start.altitude)).engine
    flight = hard_flight(aircraft, envelope, start, weather, np.random.default_rng(_SEED))
    lacks = []
    for airspeed in itertools.islice(flight, round(_MEASURED_TIME / CHECK_INTERVAL)):
        engine = read_engine()
        shown = model.measured_thrust(airspeed, engine.forward, engine.upward)
        lacks.append(fdm.read(THRUST) / fdm.read(WEIGHT) - shown)
    lack = float(np.mean(lacks))
    scatter = np.array(lacks) - lack
    return ThrustErrors(lack=lack, density=max(_growth(scatter, window) for window in _WINDOWS))


def _growth(scatter: Array, window: float) -> float:
    """Return the variance of integrals over windows, over their duration [s]."""
    size = round(window / CHECK_INTERVAL)
    whole = len(scatter) // size
    integrals = CHECK_INTERVAL * scatter[: whole * size].reshape(whole, size).sum(axis=1)
    return float(np.mean(integrals**2)) / (size * CHECK_INTERVAL)


def airspeed_slope(model: ThrustModel, airspeed: float) -> float:
    """Return the lack of shown thrust in level flight per error of the airspeed, for an airspeed
    that is read too high [s/m].
    """
    level = model.drag(airspeed, 1.0)
    throttle = float(np.interp(level, *_rising(model, airspeed)))
    attack = model.angle_of_attack(airspeed, 1.0)
    forward, upward = math.sin(attack), math.cos(attack)

    def lack(at: float) -> float:
        return model.settled_thrust(at, throttle) - model.measured_thrust(at, forward, upward)

    step = 1e-3 * airspeed
    return (lack(airspeed + step) - lack(airspeed - step)) / (2.0 * step)


def _rising(model: ThrustModel, airspeed: float) -> tuple[list[float], list[float]]:
    """Return thrusts and throttles [-] from the least thrust on: a propeller may brake at first."""
    thrusts = [model.settled_thrust(airspeed, throttle) for throttle in model.throttles]
    least = int(np.argmin(thrusts))
    return thrusts[least:], list(model.throttles[least:])
