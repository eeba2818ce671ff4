"""Keeping out of the area on the way to the reference, where nothing in the paper's law does.

The reference's orbit is clear of the keep-out area, but the way to it may not be. The guard asks, at each step, how close the
vehicle would come if it flew the law's command for another moment and then turned away at nearly its full rate, to the better
side. While that keeps the distance the law is free; otherwise as much of the turn is mixed in as is needed. Since the turn away
always stays possible, so does staying out (a backup-manoeuvre safety filter: Gurriet et al., "An Online Approach to Active Set
Invariance", CDC 2018).

It keeps the vehicle out and no more: it plans no way round. From astern every flight measured gets to the reference; from ahead of
the vessel the law and the guard can hold each other in balance, and the flight never settles.
"""

import math

from gnc.unicycle import unicycle_move

_STEP = 0.25
_MOMENT = 0.5
_TURN_SHARE = 0.9
_SHARES = (0.25, 0.5, 0.75)


class KeepoutGuard:
    """A moving disc that commands must not lead into.

    Parameters
    ----------
    north, east : of the disc's centre at time 0 [m]
    velocity_north, velocity_east : of the centre [m/s]
    radius : that the vehicle's path must keep, margin included [m]
    heading_rate_max : omega_max [rad/s]
    speed : of the vehicle, for the distance beyond which there is nothing to check [m/s]
    """

    __slots__ = ("_east", "_far_squared", "_half_turn_steps", "_north", "_radius", "_rate", "_velocity_east", "_velocity_north")

    def __init__(
        self,
        *,
        north: float,
        east: float,
        velocity_north: float,
        velocity_east: float,
        radius: float,
        heading_rate_max: float,
        speed: float,
    ) -> None:
        self._north, self._east = north, east
        self._velocity_north, self._velocity_east = velocity_north, velocity_east
        self._radius = radius
        self._rate = _TURN_SHARE * heading_rate_max
        self._half_turn_steps = math.ceil(math.pi / self._rate / _STEP)
        # A turn away takes at most half a turn; nothing farther than both can close in that time needs a look.
        closing = speed + math.hypot(velocity_north, velocity_east)
        self._far_squared = (radius + closing * math.pi / self._rate) ** 2

    def limit(self, command: float, time: float, north: float, east: float, course: float, speed: float) -> float:
        """Return the command, or as much of the turn away as is needed [rad/s].

        Parameters
        ----------
        command : what the law wants [rad/s]
        time : [s]
        north, east, course, speed : of the vehicle when the command takes effect [m, m, rad, m/s]
        """
        x = north - self._north - self._velocity_north * time
        y = east - self._east - self._velocity_east * time
        if x * x + y * y > self._far_squared:
            return command
        rate, radius = self._rate, self._radius
        if max(self.clearance(x, y, course, speed, command, turn) for turn in (rate, -rate)) >= radius:
            return command
        # The side that is better without flying the command first: on that side the last step left room.
        turn = max((rate, -rate), key=lambda way: self.clearance(x, y, course, speed, way, way))
        for share in _SHARES:
            mixed = command + share * (turn - command)
            if self.clearance(x, y, course, speed, mixed, turn) >= radius:
                return mixed
        return turn

    def clearance(self, x: float, y: float, course: float, speed: float, first: float, turn: float) -> float:
        """Return the closest approach to the disc's centre [m], or infinity for a vehicle that does not approach at all.

        Parameters
        ----------
        x, y : north and east of the centre [m]
        course, speed : of the vehicle [rad, m/s]
        first, turn : heading rate for a moment, and from then on [rad/s]
        """
        start = x * x + y * y
        x, y, course = unicycle_move(x, y, course, speed, first, _MOMENT)
        x -= self._velocity_north * _MOMENT
        y -= self._velocity_east * _MOMENT
        chord = 2.0 * speed * math.sin(0.5 * turn * _STEP) / turn
        drift_north, drift_east = self._velocity_north * _STEP, self._velocity_east * _STEP
        middle = course + 0.5 * turn * _STEP
        closest = x * x + y * y
        if closest >= start:
            return math.inf
        for _ in range(self._half_turn_steps):
            x += chord * math.cos(middle) - drift_north
            y += chord * math.sin(middle) - drift_east
            distance = x * x + y * y
            if distance >= closest:
                break
            closest = distance
            middle += turn * _STEP
        return math.sqrt(closest)
