"""Detects whether an aircraft has the thrust of its throttle, from its specific energy rate.

The specific energy V^2/2g + h of an aircraft grows at the rate V (T - D)/W. Accelerometers measure
(T - D)/W along the path, and the lift normal to it, which gives the drag. So the actual thrust
follows from airspeed and accelerometers, in gusts as well; the expected thrust follows from
airspeed and throttle. The difference, times V and summed up over time, is the height of energy that
is missing. It is tested by a cumulative sum (E. S. Page, "Continuous inspection schemes",
Biometrika 41, 1954): the energy that a sound aircraft may lack is subtracted all the time, and the
sum starts anew at 0 when it would fall below. The same sum with its sign reversed detects that
thrust is there again.
"""

import bisect
import math
from collections import deque
from dataclasses import dataclass

from gnc.estimation.navigation import EngineReadings

EXPECTED_SHARE = 0.5
"""Share of the expected thrust at which thrust counts neither as there nor as lost [-]: the best
value for detecting the loss of all thrust, with errors that are the same with thrust and without.
"""

_EXPONENT_MAX = 700.0
"""Largest exponent of a floating-point number [-]."""

_ITERATIONS = 60
"""Iterations of a logarithm, whose slope is below a tenth for heights of any use [-]."""

_AIRSPEED_MIN = 1.0
"""Least airspeed at which thrust is judged [m/s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ThrustModel:
    """Thrust, drag and angle of attack of one aircraft.

    Thrust, drag and lift are over the weight. With the lift n and the airspeed V, the angle of
    attack is a0 + a1 n/V^2, and the drag V^2 (c0 + c1 n/V^2 + c2 (n/V^2)^2).

    Attributes
    ----------
    airspeeds, throttles : of the table, ascending [m/s, -]
    thrust : at each airspeed and throttle, of engines that have settled [-]
    attack : a0, a1 [rad, rad m^2/s^2]
    polar : c0, c1, c2 [s^2/m^2, -, m^2/s^2]
    spool_time : time within which a sound engine has the thrust of a throttle that is held [s]
    """

    airspeeds: tuple[float, ...]
    throttles: tuple[float, ...]
    thrust: tuple[tuple[float, ...], ...]
    attack: tuple[float, float]
    polar: tuple[float, float, float]
    spool_time: float

    def angle_of_attack(self, airspeed: float, lift: float) -> float:
        """Return the angle of attack [rad] at an airspeed [m/s] and a lift over the weight [-]."""
        return self.attack[0] + self.attack[1] * lift / (airspeed * airspeed)

    def drag(self, airspeed: float, lift: float) -> float:
        """Return the drag over the weight [-] at an airspeed [m/s] and a lift over the weight."""
        airspeed_squared = airspeed * airspeed
        loading = lift / airspeed_squared
        c0, c1, c2 = self.polar
        return airspeed_squared * (c0 + loading * (c1 + loading * c2))

    def measured_thrust(self, airspeed: float, forward: float, upward: float) -> float:
        """Return the thrust over the weight that accelerometers show [-].

        Parameters
        ----------
        airspeed : [m/s]
        forward, upward : same as ``gnc.estimation.navigation.EngineReadings`` [-]
        """
        attack = self.angle_of_attack(airspeed, upward)
        along = forward * math.cos(attack) - upward * math.sin(attack)
        return along + self.drag(airspeed, upward)

    def settled_thrust(self, airspeed: float, throttle: float) -> float:
        """Return the thrust over the weight of a sound engine at a throttle that is held [-]."""
        i, x = _cell(self.airspeeds, airspeed)
        j, y = _cell(self.throttles, throttle)
        low, high = self.thrust[i], self.thrust[i + 1]
        return (1.0 - x) * ((1.0 - y) * low[j] + y * low[j + 1]) + x * (
            (1.0 - y) * high[j] + y * high[j + 1]
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class ThrustParameters:
    """When thrust counts as lost.

    Attributes
    ----------
    model : of the aircraft
    level : thrust over the weight in level flight [-]; a lack of less than ``EXPECTED_SHARE`` of it
        is no sign of a fault
    slow_airspeed : airspeed above which the thrust of level flight is enough, though the throttle
        commands more, as a stuck throttle always does [m/s]
    energy_height : height of energy that is missing beyond the allowance, at which thrust counts as
        lost; and that is there beyond it, at which thrust counts as there again [m]
    """

    model: ThrustModel
    level: float
    slow_airspeed: float
    energy_height: float


class ThrustMonitor:
    """Detects that thrust is lost, and that it is there again.

    An engine takes time to give the thrust of a throttle. So the expected thrust is the least of
    all throttles within the time that the engine takes from idle to full: a sound engine has that
    much in any case.

    Parameters
    ----------
    parameters : of the aircraft
    interval : between updates [s]

    Attributes
    ----------
    lost : whether thrust counts as lost
    missing : height of energy that is missing beyond the allowance; while thrust counts as lost,
        height of energy that is there beyond it [m]
    """

    def __init__(self, parameters: ThrustParameters, interval: float) -> None:
        self._parameters = parameters
        self._interval = interval
        # One more than the intervals that fit: the oldest throttle has been held since before the
        # window.
        size = 1 + math.ceil(parameters.model.spool_time / interval)
        self._settled: deque[float] = deque(maxlen=size)
        self._size = size
        self.lost = False
        self.missing = 0.0

    def update(self, airspeed: float, engine: EngineReadings) -> None:
        """Take in the readings of an interval's end.

        Parameters
        ----------
        airspeed : measured [m/s]
        engine : readings
        """
        p, settled = self._parameters, self._settled
        airspeed = max(_AIRSPEED_MIN, airspeed)
        settled.append(p.model.settled_thrust(airspeed, engine.throttle))
        if len(settled) < self._size:
            return
        expected = min(settled)
        if airspeed > p.slow_airspeed:
            expected = min(expected, p.level)
        thrust = p.model.measured_thrust(airspeed, engine.forward, engine.upward)
        allowed = EXPECTED_SHARE * max(expected, p.level)
        beyond = thrust - allowed if self.lost else expected - thrust - allowed
        self.missing = max(0.0, self.missing + airspeed * beyond * self._interval)
        if self.missing > p.energy_height:
            self.lost = not self.lost
            self.missing = 0.0


def time_between_false_alarms(drift: float, density: float, height: float) -> float:
    """Return the mean time until the sum of a sound aircraft reaches a height [s].

    The sum is taken for a Brownian motion with a drift, reflected at 0 (M. R. Reynolds,
    "Approximations to the average run length in cumulative sum control charts", Technometrics 17,
    1975): D/(2 m^2) (exp(x) - 1 - x) with x = 2 m h/D.

    Parameters
    ----------
    drift : m, at which the sum falls [m/s]
    density : D, growth rate of the variance of the sum [m^2/s]
    height : h, at which thrust counts as lost [m]
    """
    if density <= 0.0:
        return math.inf
    exponent = 2.0 * drift * height / density
    if exponent > _EXPONENT_MAX:
        return math.inf
    return density / (2.0 * drift**2) * (math.expm1(exponent) - exponent)


def height_for(drift: float, density: float, time: float) -> float:
    """Return the height of energy at which a sound aircraft gives a false alarm once in a time.

    Parameters
    ----------
    drift, density : same as ``time_between_false_alarms`` [m/s, m^2/s]
    time : between false alarms [s]
    """
    if density <= 0.0:
        return 0.0
    scale = 2.0 * drift**2 * time / density
    # exp(x) - 1 - x = scale, by x <- ln(scale + 1 + x): its slope is below 1.
    exponent = math.log1p(scale)
    for _ in range(_ITERATIONS):
        exponent = math.log(scale + 1.0 + exponent)
    return exponent * density / (2.0 * drift)


def _cell(points: tuple[float, ...], at: float) -> tuple[int, float]:
    """Return the cell of ascending points nearest to a value, and its share of that cell [-]."""
    i = min(max(bisect.bisect(points, at), 1), len(points) - 1) - 1
    return i, (at - points[i]) / (points[i + 1] - points[i])
