"""Measure how an aircraft loses airspeed and leaves its turn when a part fails."""

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from aircraft.faults import ENGINE
from aircraft.fdm import TIME_STEP
from aircraft.trim import Trim
from common.physics import METRES_PER_FOOT, heading_rate_for_bank
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft

_AIRSPEED = "velocities/vt-fps"

_SIDES = (-1.0, 1.0)
"""Signs of a turn to the left and to the right."""

_FALL_WATCHED = 5.0
"""Time after the failure in which the airspeed is recorded [s]: engines run down for seconds."""

_FALL_OVER = 1.0
"""Time over which the rate of the airspeed's fall is averaged [s]."""

_CLIMB_TIME = 8.0
"""Duration of the climb before the failure [s]."""

_CLIMB_STEP = 0.5
"""Time between altitude commands in the climb [s]."""

_ROOM = 1000.0
"""Additional height at which a glide starts, and descent that is commanded in it [m]."""

_KNOWN_AFTER = 2.0
"""Time below the slowest commanded airspeed after which an engine failure is detected [s]."""

_FALL_MAX = 120.0
"""Time after which a glide is commanded even if the airspeed is still higher [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PartFailure:
    """Effect of a part's failure in the steepest commanded turn.

    Attributes
    ----------
    airspeed_fall : largest rate at which the airspeed falls after the engine's failure [m/s2]
    glide_deviation : largest distance from the turn during the push-over to the glide, after the
        failure of any part [m]
    glide_undershoot : largest difference by which the airspeed falls below the commanded one within
        half a turn, in a glide without thrust that begins at that airspeed [m/s]
    """

    airspeed_fall: float
    glide_deviation: float
    glide_undershoot: float

    def or_worse(self, other: "PartFailure") -> "PartFailure":
        """Return the larger value of each figure."""
        return PartFailure(
            airspeed_fall=max(self.airspeed_fall, other.airspeed_fall),
            glide_deviation=max(self.glide_deviation, other.glide_deviation),
            glide_undershoot=max(self.glide_undershoot, other.glide_undershoot),
        )


def measure_part_failure(
    aircraft: AutopilotedAircraft,
    start: Trim,
    bank: float,
    airspeed_min: float,
    gradient: float = 0.0,
) -> PartFailure:
    """Return the effect of a part's failure in a settled turn, level or at the start of a climb.

    After an engine failure the glide begins at airspeeds down to the lowest that can be reached
    before the failure is detected. With a stuck surface the glide begins at once, with the engine
    running.

    Parameters
    ----------
    aircraft : ``failable`` aircraft with its autopilot; its flight is ended
    start : straight and level equilibrium
    bank : bank of the turn [rad]
    airspeed_min : slowest commanded airspeed [m/s]
    gradient : gradient of the commanded climb [-]
    """
    glide = glide_airspeed(start.airspeed, airspeed_min)
    fall = max(_airspeed_fall(_Turn(aircraft, start, side, bank, gradient)) for side in _SIDES)
    glides = {
        (side, begins): _glide(
            _Turn(aircraft, start, side, bank, gradient, room=_ROOM), glide, begins
        )
        for side in _SIDES
        for begins in (math.inf, glide, airspeed_min, airspeed_min - _KNOWN_AFTER * fall)
    }
    return PartFailure(
        airspeed_fall=fall,
        glide_deviation=max(flown.deviation for flown in glides.values()),
        glide_undershoot=max(glide - glides[side, glide].slowest for side in _SIDES),
    )


def glide_airspeed(airspeed: float, airspeed_min: float) -> float:
    """Return the airspeed to command in a glide, from V_r and the slowest commanded one [m/s]."""
    return 0.5 * (airspeed + airspeed_min)


class _Glide(NamedTuple):
    """Largest distance from the commanded turn [m], and lowest airspeed [m/s]."""

    deviation: float
    slowest: float


class _Turn:
    """A settled turn, which may continue as a climb.

    Attributes
    ----------
    aircraft : aircraft in the turn
    rate : commanded heading rate [rad/s]
    half : duration of half a turn [JSBSim time steps]
    altitude : initial altitude, ``room`` above the equilibrium's altitude [m]
    """

    def __init__(
        self,
        aircraft: AutopilotedAircraft,
        start: Trim,
        side: float,
        bank: float,
        gradient: float,
        *,
        room: float = 0.0,
    ) -> None:
        self.aircraft = aircraft
        self.rate = side * heading_rate_for_bank(bank, start.airspeed)
        self.altitude = start.altitude + room
        self._climb_rate = gradient * start.airspeed
        aircraft.release(
            replace(start.state(), altitude=self.altitude),
            airspeed=start.airspeed,
            altitude=self.altitude,
        )
        aircraft.command_heading_rate(self.rate)
        self.half = round(math.pi / abs(self.rate) / TIME_STEP)
        for _ in range(self.half):
            aircraft.run()

    def airspeeds(self, *, engine_fails: bool) -> Iterator[float]:
        """Climb, then yield the airspeed before each further time step, without end [m/s].

        With ``engine_fails`` the engine fails at the first of these steps.
        """
        read = self.aircraft.fdm.node(_AIRSPEED).get_double_value
        climbed = round(_CLIMB_TIME / TIME_STEP)
        for step in itertools.count():
            if step % round(_CLIMB_STEP / TIME_STEP) == 0:
                self.aircraft.command_altitude(self.altitude + self._climb_rate * step * TIME_STEP)
            if engine_fails and step == climbed:
                self.aircraft.fail(ENGINE)
            if step >= climbed:
                yield METRES_PER_FOOT * read()
            self.aircraft.run()


def _airspeed_fall(turn: _Turn) -> float:
    """Return the largest rate at which the airspeed falls after the engine fails [m/s2]."""
    over = round(_FALL_OVER / TIME_STEP)
    steps = round(_FALL_WATCHED / TIME_STEP) + 1
    flown = np.array(list(itertools.islice(turn.airspeeds(engine_fails=True), steps)))
    return float(np.max(flown[:-over] - flown[over:])) / (over * TIME_STEP)


def _glide(turn: _Turn, glide: float, begins: float) -> _Glide:
    """Return deviation and airspeed in the half turn after a glide is commanded.

    The engine fails, and the airspeed ``glide`` [m/s] is commanded once the airspeed has fallen to
    ``begins`` [m/s]. If ``begins`` is infinite, the engine runs and the glide begins at once.
    """
    airspeeds = turn.airspeeds(engine_fails=math.isfinite(begins))
    for fallen_to in itertools.islice(airspeeds, round(_FALL_MAX / TIME_STEP)):
        if fallen_to <= begins:
            break
    aircraft = turn.aircraft
    north = aircraft.fdm.node("velocities/v-north-fps").get_double_value
    east = aircraft.fdm.node("velocities/v-east-fps").get_double_value
    aircraft.command_airspeed(glide)
    aircraft.command_altitude(turn.altitude - _ROOM)
    airspeed = aircraft.fdm.node(_AIRSPEED).get_double_value
    velocities, airspeeds_flown = [], []
    for _ in range(turn.half):
        velocities.append(complex(north(), east()))
        airspeeds_flown.append(airspeed())
        aircraft.run()
    flown = METRES_PER_FOOT * np.array(velocities)
    commanded = np.abs(flown) * np.exp(
        1j * (np.angle(flown[0]) + turn.rate * TIME_STEP * np.arange(len(flown)))
    )
    return _Glide(
        deviation=float(np.max(np.abs(np.cumsum(flown - commanded)))) * TIME_STEP,
        slowest=METRES_PER_FOOT * min(airspeeds_flown),
    )
