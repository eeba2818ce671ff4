"""What an aircraft whose engine fails in a turn is measured for: how fast it loses airspeed, and how far its glide leads off."""

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from aircraft.dynamics.equilibrium import Trim
from aircraft.simulation.faults import ENGINE
from aircraft.simulation.fdm import TIME_STEP
from common.physics.coordinated_turn import heading_rate_for_bank
from common.physics.units import METRES_PER_FOOT
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft

_AIRSPEED = "velocities/vt-fps"

_WATCHED, _OVER = 5.0, 1.0
"""For how long the fall is watched, an engine may run down for seconds, and time over which it is taken [s]."""

_CLIMBED, _STEP = 8.0, 0.5
"""For how long it climbs before, and time between commands of its altitude [s]."""

_ROOM = 1000.0
"""How much higher a glide begins than flights do, so that it does not end in the sea, and how much lower it is commanded [m]."""

_FALLEN = 120.0
"""For how long its airspeed may take to fall before it is commanded to glide all the same [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EngineFailure:
    """What an engine failure in a turn at the largest bank does.

    Attributes
    ----------
    airspeed_fall : largest rate at which the airspeed falls until the failure is known [m/s2]
    glide_deviation : how far the turn is led off then, while the aircraft pushes over to its glide [m]
    """

    airspeed_fall: float
    glide_deviation: float


def measure_engine_failure(
    aircraft: AutopilotedAircraft, start: Trim, bank: float, airspeed_min: float, gradient: float = 0.0
) -> EngineFailure:
    """Return what it does to the aircraft when its engine fails in a settled turn, or as it has begun to climb in one.

    Parameters
    ----------
    aircraft : with its autopilot, and made ``failable``; its flight is ended
    start : straight and level equilibrium
    bank : of the turn [rad]
    airspeed_min : the slowest airspeed that is commanded [m/s]
    gradient : of the commanded climb [-]
    """
    glide = glide_airspeed(start.airspeed, airspeed_min)
    deviations = [
        _glide_deviation(_Turn(aircraft, start, side, bank, gradient, room=_ROOM), glide, begins)
        for side in (-1.0, 1.0)
        for begins in (glide, airspeed_min)
    ]
    return EngineFailure(airspeed_fall=_airspeed_fall(_Turn(aircraft, start, 1.0, bank, gradient)), glide_deviation=max(deviations))


def glide_airspeed(airspeed: float, airspeed_min: float) -> float:
    """Return the airspeed that is commanded in a glide, by V_r and the slowest that is commanded [m/s]."""
    return 0.5 * (airspeed + airspeed_min)


class _Turn:
    """A settled turn in which the engine fails, level or in a climb that has lasted for some seconds.

    Attributes
    ----------
    aircraft : in the turn
    rate : commanded heading rate [rad/s]
    altitude : at which it begins, ``room`` above that of the equilibrium [m]
    """

    def __init__(
        self, aircraft: AutopilotedAircraft, start: Trim, side: float, bank: float, gradient: float, *, room: float = 0.0
    ) -> None:
        self.aircraft, self.rate = aircraft, side * heading_rate_for_bank(bank, start.airspeed)
        self.altitude, self._climb_rate = start.altitude + room, gradient * start.airspeed
        aircraft.release(replace(start.state(), altitude=self.altitude), airspeed=start.airspeed, altitude=self.altitude)
        aircraft.command_heading_rate(self.rate)
        for _ in range(round(2.0 * math.pi / abs(self.rate) / TIME_STEP)):
            aircraft.run()

    def until_known(self) -> Iterator[float]:
        """Let it climb, fail and fly on as commanded; yield the airspeed before each time step from the failure on [m/s]."""
        read, failing = self.aircraft.fdm.node(_AIRSPEED).get_double_value, round(_CLIMBED / TIME_STEP)
        for step in itertools.count():
            if step % round(_STEP / TIME_STEP) == 0:
                self.aircraft.command_altitude(self.altitude + self._climb_rate * step * TIME_STEP)
            if step == failing:
                self.aircraft.fail(ENGINE)
            if step >= failing:
                yield METRES_PER_FOOT * read()
            self.aircraft.run()


def _airspeed_fall(turn: _Turn) -> float:
    """Return the largest rate at which the airspeed falls [m/s2]."""
    over = round(_OVER / TIME_STEP)
    flown = np.array(list(itertools.islice(turn.until_known(), round(_WATCHED / TIME_STEP) + 1)))
    return float(np.max(flown[:-over] - flown[over:])) / (over * TIME_STEP)


def _glide_deviation(turn: _Turn, glide: float, begins: float) -> float:
    """Return how far from the commanded turn the aircraft comes within half a turn [m], by its own airspeed.

    Parameters
    ----------
    turn : in which the engine fails
    glide : airspeed commanded in the glide [m/s]
    begins : airspeed at which it begins [m/s]
    """
    for airspeed in itertools.islice(turn.until_known(), round(_FALLEN / TIME_STEP)):
        if airspeed <= begins:
            break
    aircraft, velocities = turn.aircraft, list[tuple[float, float]]()
    north, east = (aircraft.fdm.node(f"velocities/v-{side}-fps").get_double_value for side in ("north", "east"))
    aircraft.command_airspeed(glide)
    aircraft.command_altitude(turn.altitude - _ROOM)
    for _ in range(round(math.pi / abs(turn.rate) / TIME_STEP)):
        velocities.append((north(), east()))
        aircraft.run()
    flown = METRES_PER_FOOT * np.array([complex(*each) for each in velocities])
    commanded = np.abs(flown) * np.exp(1j * (np.angle(flown[0]) + turn.rate * TIME_STEP * np.arange(len(flown))))
    return float(np.max(np.abs(np.cumsum(flown - commanded)))) * TIME_STEP
