"""Keeping out of a moving disc whatever the guidance demands: a filter of heading-rate commands, after docs/keepout_guard.md.

The guard predicts, at each step, the vehicle's path if it flew the demanded heading rate for that step and then turned
away at omega_max, to the left or to the right, with the vehicle's own lag. While one of the two keeps the radius the
guidance is free. Otherwise as much of the turn that was safe at the last step is mixed in as is needed: that turn is
still possible, and so is staying out (a backup-manoeuvre safety filter: Gurriet et al., "An Online Approach to Active
Set Invariance", CDC 2018).

Everything is posed in the air mass, relative to the disc: the vehicle's course and speed are those of its motion through the air.
The guard plans no way round; it keeps out and no more.
"""

import math
from collections import deque

from gnc.safety.turn_prediction import Motion, TurnPrediction

_RESOLUTION = 1e-3
"""Turn radii kept beyond the radius: the closest approach is predicted as well as that, 4 cm at a turn radius of 40 m [-]."""
_BISECTIONS = 5
"""Halvings of the fraction of the turn away, which is found to 1/32."""


class KeepoutGuard:
    """A moving disc that commands must not lead into. It keeps a memory and must be called once per time step.

    Parameters
    ----------
    radius : that the vehicle's path must keep from the disc's centre [m]
    heading_rate_max : omega_max, the largest command [rad/s]
    lag : time constant of the vehicle's heading rate behind its command; 0 if it follows at once [s]
    delay : dead time before that; the command's next whole step counts [s]
    time_step : for which a command is held [s]
    speed_error : b, bound on the error of the relative velocity that is given, airspeed, wind and disc together [m/s]
    acceleration : a, bound on how fast that velocity changes other than by turning the vehicle [m/s^2]

    Attributes
    ----------
    intervening : whether the last command was changed
    interventions : how often interventions began
    lost : whether neither turn away held the radius at the last step; the better one is flown
    """

    __slots__ = (
        "_acceleration",
        "_delay",
        "_free_inflation",
        "_free_steps",
        "_lag",
        "_prediction",
        "_radius",
        "_rate",
        "_side",
        "_speed_error",
        "_time_step",
        "_turn_time",
        "_under_way",
        "intervening",
        "interventions",
        "lost",
    )

    def __init__(
        self,
        *,
        radius: float,
        heading_rate_max: float,
        lag: float,
        time_step: float,
        delay: float = 0.0,
        speed_error: float = 0.0,
        acceleration: float = 0.0,
    ) -> None:
        self._radius, self._rate = radius, heading_rate_max
        self._lag, self._time_step = lag, time_step
        self._delay = round(delay / time_step) * time_step
        self._under_way: deque[float] = deque(maxlen=round(delay / time_step))
        self._speed_error, self._acceleration = speed_error, acceleration
        self._prediction = TurnPrediction(
            radius=radius,
            heading_rate_max=heading_rate_max,
            lag=lag,
            delay=self._delay,
            time_step=time_step,
            speed_error=speed_error,
            acceleration=acceleration,
        )
        # Half a turn to the nearer side, half as much again for the disc's motion, and what the lag takes from any heading rate.
        self._turn_time = 1.5 * math.pi / heading_rate_max + 2.0 * lag + self._delay + time_step
        self._side = 0.0
        self._free_steps, self._free_inflation = 0, 0.0
        self.intervening = self.lost = False
        self.interventions = 0

    def limit(
        self,
        command: float,
        x: float,
        y: float,
        velocity_north: float,
        velocity_east: float,
        course: float,
        speed: float,
        heading_rate: float,
        *,
        radius_inflation: float = 0.0,
    ) -> float:
        """Return the command, or as much of a turn away as is needed [rad/s].

        Parameters
        ----------
        command : that the guidance demands [rad/s]
        x, y : of the vehicle, north and east of the disc's centre [m]
        velocity_north, velocity_east : of the disc in the air mass [m/s]
        course, speed : of the vehicle in the air mass [rad, m/s]
        heading_rate : rate of that course now [rad/s]
        radius_inflation : added to the radius, e.g. while no report of the disc's motion is received [m]
        """
        bounded = -self._rate <= command <= self._rate
        if self._free_steps > 0 and bounded and radius_inflation <= self._free_inflation:
            self._free_steps -= 1
            self._under_way.append(command)
            return command
        self._free_steps, self._free_inflation = 0, radius_inflation
        motion = (x, y, velocity_north, velocity_east, course, speed, heading_rate)
        free = self._free_when_far(motion, radius_inflation)
        if free <= 0.0:
            then = self._prediction.when_acting(motion, self._under_way)
            free = self._free_by_turning_away(command, then, radius_inflation)
        if free >= 0.0:
            self.intervening = self.lost = False
            if bounded:
                self._free_steps = max(0, int(free / self._time_step) - 1)
        else:
            self.interventions += not self.intervening
            self.intervening = True
            command = self._mix(command, then, radius_inflation)
        if not self._under_way:
            self._under_way.extend([heading_rate] * (self._under_way.maxlen or 0))
        self._under_way.append(command)
        return command

    def clearance(
        self,
        x: float,
        y: float,
        velocity_north: float,
        velocity_east: float,
        course: float,
        speed: float,
        heading_rate: float,
        *,
        radius_inflation: float = 0.0,
    ) -> float:
        """Return by how much the better turn away, begun now, keeps the radius [m]; negative if no command can hold it.

        Parameters are those of ``limit``. That no other commands do better is argued in docs/keepout_guard.md.
        """
        motion = (x, y, velocity_north, velocity_east, course, speed, heading_rate)
        then = self._prediction.when_acting(motion, self._under_way)
        start = (then[0], then[1], then[4], then[6])
        return max(
            self._prediction.turn_away(side, start, then, self._delay, radius_inflation, -math.inf)[0] for side in (1.0, -1.0)
        )

    def _free_when_far(self, motion: Motion, radius_inflation: float) -> float:
        """Return for how long [s] the disc stays beyond all that both can close during a turn away; negative if it is nearer."""
        x, y, velocity_north, velocity_east, _, speed, _ = motion
        duration, acceleration = self._turn_time, self._acceleration
        closing = speed + math.hypot(velocity_north, velocity_east) + self._speed_error
        gap = math.hypot(x, y) - self._radius - radius_inflation - (closing + 0.5 * acceleration * duration) * duration
        return min(gap / (closing + 1.5 * acceleration * duration), duration)

    def _free_by_turning_away(self, command: float, motion: Motion, radius_inflation: float) -> float:
        """Return for how long [s] no command can spoil the turn away that follows this one; negative if there is none."""
        after = self._prediction.after(command, motion)
        x, y, course, _ = after
        floor = _RESOLUTION * motion[5] / self._rate
        nearer = 1.0 if y * math.cos(course) >= x * math.sin(course) else -1.0
        for side in (nearer, -nearer):
            slack, free = self._prediction.turn_away(side, after, motion, self._delay + self._time_step, radius_inflation, floor)
            if slack >= floor:
                self._side = side
                return free
        return -1.0

    def _mix(self, command: float, motion: Motion, radius_inflation: float) -> float:
        """Return the command with the least of a turn away that keeps the radius, or the better turn if none does [rad/s]."""
        x, y, _, _, course, speed, heading_rate = motion
        floor = _RESOLUTION * speed / self._rate
        begun = self._delay + self._time_step
        slacks = []
        for side in (self._side, -self._side) if self._side else (1.0, -1.0):
            turn = side * self._rate
            slack, _ = self._prediction.turn_away(
                side, self._prediction.after(turn, motion), motion, begun, radius_inflation, -math.inf
            )
            slacks.append((slack, side))
            if self._side and slack >= 0.0:
                break
        slack, side = max(slacks)
        self._side = side
        turn = side * self._rate
        self.lost = slack < 0.0
        if self.lost:
            # Away from the disc and no farther, in case it is the radius that has overtaken a vehicle that flies away from it.
            left = math.remainder(math.atan2(y, x) - course - self._lag * heading_rate, 2.0 * math.pi)
            return left / self._time_step if abs(left) < self._rate * self._time_step else turn
        mixed = turn
        low, high = 0.0, 1.0
        for _ in range(_BISECTIONS):
            fraction = 0.5 * (low + high)
            trial = command + fraction * (turn - command)
            slack, _ = self._prediction.turn_away(
                side, self._prediction.after(trial, motion), motion, begun, radius_inflation, floor
            )
            if slack >= floor:
                high, mixed = fraction, trial
            else:
                low = fraction
        return mixed
