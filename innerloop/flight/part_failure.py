"""What an aircraft a part of which fails in a turn is measured for: how fast it loses airspeed, and
how far its glide leads off.
"""

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from aircraft.faults import ENGINE
from aircraft.fdm import TIME_STEP
from aircraft.trim import Trim
from common.physics.coordinated_turn import heading_rate_for_bank
from common.physics.units import METRES_PER_FOOT
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft

_AIRSPEED = "velocities/vt-fps"

_SIDES = -1.0, 1.0
"""Of a turn: to the left, to the right."""

_WATCHED, _OVER = 5.0, 1.0
"""For how long the fall is watched, an engine may run down for seconds, and time over which it is
taken [s].
"""

_CLIMBED, _STEP = 8.0, 0.5
"""For how long it climbs before, and time between commands of its altitude [s]."""

_ROOM = 1000.0
"""How much higher a glide begins than flights do, so that it does not end in the sea, and how much
lower it is commanded [m].
"""

_KNOWN_AFTER = 2.0
"""For how long the airspeed may go on to fall below the slowest commanded until the failure is
known [s].
"""

_FALLEN = 120.0
"""For how long its airspeed may take to fall before it is commanded to glide all the same [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PartFailure:
    """What the failure of a part in the steepest turn that is commanded does.

    Attributes
    ----------
    airspeed_fall : largest rate at which the airspeed falls until it is known that the engine has
        failed [m/s2]
    glide_deviation : how far the turn is led off while the aircraft pushes over to its glide, after
        any failure [m]
    """

    airspeed_fall: float
    glide_deviation: float

    def or_worse(self, other: "PartFailure") -> "PartFailure":
        """Return the larger of each figure."""
        fall, deviation = (
            max(self.airspeed_fall, other.airspeed_fall),
            max(self.glide_deviation, other.glide_deviation),
        )
        return PartFailure(airspeed_fall=fall, glide_deviation=deviation)


def measure_part_failure(
    aircraft: AutopilotedAircraft,
    start: Trim,
    bank: float,
    airspeed_min: float,
    gradient: float = 0.0,
) -> PartFailure:
    """Return what it does to the aircraft when a part of it fails in a settled turn, or as it has
    begun to climb in one.

    Where the engine has failed the glide begins as slowly as that may have become; with a surface
    that is stuck it begins at once, and with the engine's power it may be commanded to sink faster.

    Parameters
    ----------
    aircraft : with its autopilot, and made ``failable``; its flight is ended
    start : straight and level equilibrium
    bank : of the turn [rad]
    airspeed_min : the slowest airspeed that is commanded [m/s]
    gradient : of the commanded climb [-]
    """
    glide = glide_airspeed(start.airspeed, airspeed_min)
    fall = max(_airspeed_fall(_Turn(aircraft, start, side, bank, gradient)) for side in _SIDES)
    deviations = [
        _glide_deviation(_Turn(aircraft, start, side, bank, gradient, room=_ROOM), glide, begins)
        for side in _SIDES
        for begins in (math.inf, glide, airspeed_min, airspeed_min - _KNOWN_AFTER * fall)
    ]
    return PartFailure(airspeed_fall=fall, glide_deviation=max(deviations))


def glide_airspeed(airspeed: float, airspeed_min: float) -> float:
    """Return the airspeed that is commanded in a glide, by V_r and the slowest that is commanded
    [m/s].
    """
    return 0.5 * (airspeed + airspeed_min)


class _Turn:
    """A settled turn, level or in a climb that has lasted for some seconds.

    Attributes
    ----------
    aircraft : in the turn
    rate : commanded heading rate [rad/s]
    half : time steps of half a turn
    altitude : at which it begins, ``room`` above that of the equilibrium [m]
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
        self.aircraft, self.rate = aircraft, side * heading_rate_for_bank(bank, start.airspeed)
        self.altitude, self._climb_rate = start.altitude + room, gradient * start.airspeed
        aircraft.release(
            replace(start.state(), altitude=self.altitude),
            airspeed=start.airspeed,
            altitude=self.altitude,
        )
        aircraft.command_heading_rate(self.rate)
        self.half = round(math.pi / abs(self.rate) / TIME_STEP)
        for _ in range(self.half):
            aircraft.run()

    def flown(self, *, failing: bool = True) -> Iterator[float]:
        """Let it climb, its engine perhaps fail, and fly on as commanded; yield the airspeed before
        each time step then [m/s].
        """
        read, begun = (
            self.aircraft.fdm.node(_AIRSPEED).get_double_value,
            round(_CLIMBED / TIME_STEP),
        )
        for step in itertools.count():
            if step % round(_STEP / TIME_STEP) == 0:
                self.aircraft.command_altitude(self.altitude + self._climb_rate * step * TIME_STEP)
            if failing and step == begun:
                self.aircraft.fail(ENGINE)
            if step >= begun:
                yield METRES_PER_FOOT * read()
            self.aircraft.run()


def _airspeed_fall(turn: _Turn) -> float:
    """Return the largest rate at which the airspeed falls [m/s2]."""
    over = round(_OVER / TIME_STEP)
    flown = np.array(list(itertools.islice(turn.flown(), round(_WATCHED / TIME_STEP) + 1)))
    return float(np.max(flown[:-over] - flown[over:])) / (over * TIME_STEP)


def _glide_deviation(turn: _Turn, glide: float, begins: float) -> float:
    """Return how far from the commanded turn the aircraft comes within half a turn [m], by its own
    airspeed.

    Parameters
    ----------
    turn : in which a part fails
    glide : airspeed commanded in the glide [m/s]
    begins : airspeed at which it begins, after the engine has failed; infinite at once, with its
        power [m/s]
    """
    for airspeed in itertools.islice(
        turn.flown(failing=math.isfinite(begins)), round(_FALLEN / TIME_STEP)
    ):
        if airspeed <= begins:
            break
    aircraft, velocities = turn.aircraft, list[tuple[float, float]]()
    north, east = (
        aircraft.fdm.node(f"velocities/v-{side}-fps").get_double_value for side in ("north", "east")
    )
    aircraft.command_airspeed(glide)
    aircraft.command_altitude(turn.altitude - _ROOM)
    for _ in range(turn.half):
        velocities.append((north(), east()))
        aircraft.run()
    flown = METRES_PER_FOOT * np.array([complex(*each) for each in velocities])
    commanded = np.abs(flown) * np.exp(
        1j * (np.angle(flown[0]) + turn.rate * TIME_STEP * np.arange(len(flown)))
    )
    return float(np.max(np.abs(np.cumsum(flown - commanded)))) * TIME_STEP
