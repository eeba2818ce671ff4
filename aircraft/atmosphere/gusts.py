"""Discrete gusts, one after the other, through JSBSim's cosine gust."""

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from aircraft.errors import AircraftError
from aircraft.simulation.fdm import Fdm
from common.physics.units import METRES_PER_FOOT

_LOCAL_FRAME = 3
"""JSBSim's number for a gust given in north, east and down."""

_PROFILE = ("startup-duration-sec", "steady-duration-sec", "end-duration-sec", "magnitude-ft_sec")
_AT_ONCE = 1e-9
"""A duration shorter than any step that JSBSim can still divide by [s]."""

_DIRECTION = ("X-velocity-ft_sec", "Y-velocity-ft_sec", "Z-velocity-ft_sec")


@dataclass(frozen=True, slots=True, kw_only=True)
class Gust:
    """A gust that rises as 1 - cosine, holds, and falls as it rose: the discrete gust of
    MIL-F-8785C, which has the rise alone.

    Attributes
    ----------
    start : after the release [s]
    rise, hold, fall : durations [s]
    velocity_ned : of the air at its height, beside the wind: north, east, down [m/s]

    Raises
    ------
    AircraftError : a duration that JSBSim would divide by, or a value that is not finite
    """

    start: float
    rise: float
    hold: float = 0.0
    fall: float
    velocity_ned: tuple[float, float, float]

    def __post_init__(self) -> None:
        for name, value, low in (("start", self.start, 0.0), ("hold", self.hold, 0.0)):
            if not (math.isfinite(value) and value >= low):
                raise AircraftError(f"gust: {name} is {value} s; it must be finite and at least 0")
        for name, value in (("rise", self.rise), ("fall", self.fall)):
            if not (math.isfinite(value) and value > 0.0):
                raise AircraftError(f"gust: {name} is {value} s; it must be finite and above 0")
        if not 0.0 < math.hypot(*self.velocity_ned) < math.inf:
            raise AircraftError(
                f"gust: velocity_ned is {self.velocity_ned} m/s; it must be finite and not 0"
            )

    @property
    def end(self) -> float:
        """Return when it is over, after the release [s]."""
        return self.start + self.rise + self.hold + self.fall


STEPS_BETWEEN = 2.0
"""Time steps that JSBSim's only cosine gust needs from the end of one gust to the next [-]."""


def in_order(gusts: Sequence[Gust], time_step: float) -> list[Gust]:
    """Return gusts as they follow each other.

    Raises
    ------
    AircraftError : two of them blow at once, or within a ``time_step`` [s]: JSBSim has one cosine
        gust, which must be over first
    """
    ordered = sorted(gusts, key=lambda gust: gust.start)
    for first, second in itertools.pairwise(ordered):
        if second.start < first.end + STEPS_BETWEEN * time_step:
            raise AircraftError(
                f"gusts: one starts at {second.start:g} s, before the one from {first.start:g} to {first.end:g} s is over;"
                " let them follow each other"
            )
    return ordered


def gusty_run(fdm: Fdm, gusts: Sequence[Gust]) -> Callable[[], object]:
    """Return what advances the aircraft by a time step and lets each gust begin when it is due.

    Parameters
    ----------
    fdm : the aircraft at its release
    gusts : one after the other, timed from now

    Returns
    -------
    callable : JSBSim's own ``run`` where there is no gust, so that no gusts cost no time
    """
    # To resume a generator takes Python less time than to call a function: this is the innermost
    # call of a flight.
    return _steps(fdm, in_order(gusts, fdm.time_step)).__next__ if gusts else fdm.run


def end_gust(fdm: Fdm) -> None:
    """End a gust by advancing the aircraft a step: JSBSim would give its direction to the next one."""
    for name, duration in zip(_PROFILE[:3], (_AT_ONCE, 0.0, 0.0), strict=True):
        fdm.write(f"atmosphere/cosine-gust/{name}", duration)
    fdm.step()


def _steps(fdm: Fdm, gusts: Sequence[Gust]) -> Iterator[None]:
    """Advance the aircraft by a time step whenever asked, for ever; let each of the gusts, in
    order, begin when it is due.
    """
    fdm.write("atmosphere/cosine-gust/frame", _LOCAL_FRAME)
    profile = [
        fdm.writable_node(f"atmosphere/cosine-gust/{name}") for name in (*_PROFILE, *_DIRECTION)
    ]
    start = fdm.writable_node("atmosphere/cosine-gust/start")
    run, step = fdm.run, 0
    for gust in gusts:
        due = round(gust.start / fdm.time_step)
        for _ in range(due - step):
            run()
            yield
        step = due
        # JSBSim normalises the direction, so the magnitude is set separately.
        magnitude = math.hypot(*gust.velocity_ned)
        direction = (component / magnitude for component in gust.velocity_ned)
        values = (gust.rise, gust.hold, gust.fall, magnitude / METRES_PER_FOOT, *direction)
        for node, value in zip(profile, values, strict=True):
            node.set_double_value(value)
        start.set_double_value(1.0)
    while True:
        run()
        yield
