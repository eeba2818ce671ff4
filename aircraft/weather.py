"""The air that an aircraft flies in: mean wind, MIL-F-8785C turbulence and discrete gusts.

Low-altitude turbulence, MIL-F-8785C, figures 10 and 11: between 10 and 1,000 ft, with the height h
[ft] and the wind at 20 ft, sigma_w = 0.1 W20, sigma_u = sigma_v = sigma_w / (0.177 + 0.000823
h)^0.4, L_w = h and L_u = L_v = h / (0.177 + 0.000823 h)^1.2.

JSBSim computes the same from the height above mean sea level, and shapes them with a filter that
``atmosphere/turb-type`` chooses. Type 4 has the standard's Dryden spectra, across and vertical ones
with their second-order denominators. Type 3 keeps the standard deviations and replaces those two
spectra by first-order ones of half the time constant (MIL-STD-1797A as Yeager quotes it), which
moves energy from slow waves to fast ones; so type 4 is used here. One thing differs from the
standard in both: JSBSim turns the waves along and across the wind by the wind's direction the wrong
way. As the two are equally strong and long, only the shapes of their spectra change places, and not
at all in a wind along one of the four cardinal directions.
"""

import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from aircraft.fdm import Fdm
from aircraft.spec import AircraftError
from aircraft.wind import CALM, WindField
from common.physics import METRES_PER_FOOT, METRES_PER_SECOND_PER_KNOT

_DRYDEN = 4
"""JSBSim's number for the Dryden spectra of MIL-F-8785C in Tustin's discretisation."""

_ALTITUDE_MIN_FT = 10.0
_ALTITUDE_MAX_FT = 1000.0

_SEED_MAX = 2**31 - 1

_MILSPEC = "atmosphere/turbulence/milspec"

_COSINE_GUST = "atmosphere/cosine-gust"
"""JSBSim's only cosine gust."""

_NORTH_EAST_DOWN = 3
"""JSBSim's number for a gust given in north, east and down."""

_DURATIONS = ("startup-duration-sec", "steady-duration-sec", "end-duration-sec")
_DIRECTION = ("X-velocity-ft_sec", "Y-velocity-ft_sec", "Z-velocity-ft_sec")

_AT_ONCE = 1e-9
"""A duration shorter than any step that JSBSim can still divide by [s]."""

STEPS_BETWEEN_GUSTS = 2.0
"""Time steps that JSBSim's cosine gust needs from the end of one gust to the next [-]."""


Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Turbulence:
    """Strength of the turbulence.

    Attributes
    ----------
    wind_at_20ft : mean wind 20 ft above the surface that stirs the air, W20 [m/s]; the aircraft may
        drift with another wind
    severity : curve of figure 7 of MIL-F-8785C, 1 to 7, which JSBSim goes by above 1,000 ft; below,
        any of them switches it on

    Raises
    ------
    AircraftError : a value out of range
    """

    wind_at_20ft: float
    severity: int = 3

    def __post_init__(self) -> None:
        if not (math.isfinite(self.wind_at_20ft) and self.wind_at_20ft > 0.0):
            raise AircraftError(
                f"turbulence: wind_at_20ft is {self.wind_at_20ft} m/s; it must be finite and above"
                " 0; leave turbulence out for none"
            )
        if self.severity not in range(1, 8):
            raise AircraftError(
                f"turbulence: severity is {self.severity}; MIL-F-8785C has curves 1 to 7"
            )


TURBULENCE = {
    "light": Turbulence(wind_at_20ft=15.0 * METRES_PER_SECOND_PER_KNOT, severity=3),
    "moderate": Turbulence(wind_at_20ft=30.0 * METRES_PER_SECOND_PER_KNOT, severity=4),
    "severe": Turbulence(wind_at_20ft=45.0 * METRES_PER_SECOND_PER_KNOT, severity=6),
}
"""W20 of 15, 30 and 45 knots (MIL-F-8785C, figure 9), with the severities of JSBSim's manual."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GustStatistics:
    """Turbulence at one altitude: standard deviations of the wind [m/s], and scale lengths [m]."""

    horizontal: float
    vertical: float
    horizontal_length: float
    vertical_length: float


def low_altitude_turbulence(altitude: float, wind_at_20ft: float) -> GustStatistics:
    """Statistics of the turbulence at an altitude [m] by MIL-F-8785C, below 10 ft same as at 10 ft.

    MIL-HDBK-1797 calls half of the scale lengths across and down by the same names and has its
    spectra make up for it.

    Parameters
    ----------
    altitude : above the surface [m]
    wind_at_20ft : mean wind 20 ft above the surface [m/s]

    Raises
    ------
    AircraftError : an altitude above 1,000 ft, where other laws hold
    """
    height = altitude / METRES_PER_FOOT
    if not height <= _ALTITUDE_MAX_FT:
        highest = _ALTITUDE_MAX_FT * METRES_PER_FOOT
        raise AircraftError(
            f"low-altitude turbulence: altitude is {altitude:g} m; it holds up to {highest:g} m"
        )
    height = max(height, _ALTITUDE_MIN_FT)
    shape = 0.177 + 0.000823 * height
    vertical = 0.1 * wind_at_20ft
    return GustStatistics(
        horizontal=vertical / shape**0.4,
        vertical=vertical,
        horizontal_length=height / shape**1.2 * METRES_PER_FOOT,
        vertical_length=height * METRES_PER_FOOT,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Gust:
    """A gust that rises as 1 - cosine, holds, and falls as it rose.

    The discrete gust of MIL-F-8785C has the rise alone.

    Attributes
    ----------
    start : after the release [s]
    rise, hold, fall : durations [s]
    velocity_ned : of the air at the gust's peak, added to the wind: north, east, down [m/s]

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
        for name, value in (("start", self.start), ("hold", self.hold)):
            if not (math.isfinite(value) and value >= 0.0):
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
        """Time after the release at which it is over [s]."""
        return self.start + self.rise + self.hold + self.fall

    def share(self, time: npt.ArrayLike) -> Array:
        """Return the share of its peak that the air has at some times after the release [s, -]."""
        since = np.asarray(time) - self.start
        risen = np.clip(since / self.rise, 0.0, 1.0)
        fallen = np.clip((since - self.rise - self.hold) / self.fall, 0.0, 1.0)
        return np.asarray(0.5 * (np.cos(np.pi * fallen) - np.cos(np.pi * risen)))


def ordered_gusts(gusts: Sequence[Gust], time_step: float) -> list[Gust]:
    """Gusts in the order of their starts.

    Raises
    ------
    AircraftError : two of them blow at once, or within ``STEPS_BETWEEN_GUSTS`` steps of
        ``time_step`` [s]: JSBSim has one cosine gust, which must be over first
    """
    ordered = sorted(gusts, key=lambda gust: gust.start)
    for first, second in itertools.pairwise(ordered):
        if second.start < first.end + STEPS_BETWEEN_GUSTS * time_step:
            raise AircraftError(
                f"gusts: one starts at {second.start:g} s, before the one from {first.start:g} to"
                f" {first.end:g} s is over; let them follow each other"
            )
    return ordered


@dataclass(frozen=True, slots=True, kw_only=True)
class Weather:
    """The air of one flight.

    Attributes
    ----------
    wind : velocity of the air mass over time and height
    turbulence : added to the wind from the release on; None for smooth air
    gusts : discrete gusts, one at a time
    seed : of the turbulence, 0 to 2^31 - 1, which is what JSBSim holds

    Raises
    ------
    AircraftError : a value out of range
    """

    wind: WindField = CALM
    turbulence: Turbulence | None = None
    gusts: tuple[Gust, ...] = ()
    seed: int = 0

    def __post_init__(self) -> None:
        if not 0 <= self.seed <= _SEED_MAX:
            raise AircraftError(
                f"weather: seed is {self.seed}; JSBSim takes whole numbers from 0 to {_SEED_MAX}"
            )


def begin_weather(fdm: Fdm, weather: Weather) -> Callable[[], object]:
    """Function that advances the aircraft by a time step in this weather.

    It is JSBSim's own ``run`` if the wind is constant and there are no gusts, so that they cost no
    time. Turbulence rises from smooth air, and the same seed gives the same turbulence. It takes a
    few times its horizontal scale length over the airspeed to reach its strength: some 30 s for
    220 m at 20 m/s.

    The aircraft is at its release, placed in the wind of that time; the weather is timed from then.

    Raises
    ------
    AircraftError : same as ``ordered_gusts``
    """
    if weather.turbulence is not None:
        wind_at_20ft_fps = weather.turbulence.wind_at_20ft / METRES_PER_FOOT
        fdm.write("atmosphere/randomseed", weather.seed)
        fdm.write("atmosphere/turb-type", _DRYDEN)
        fdm.write(f"{_MILSPEC}/windspeed_at_20ft_AGL-fps", wind_at_20ft_fps)
        fdm.write(f"{_MILSPEC}/severity", weather.turbulence.severity)
    run = fdm.run
    if weather.gusts:
        # Resuming a generator costs less than calling a function; this is a flight's innermost
        # call.
        run = _steps_with_gusts(fdm, ordered_gusts(weather.gusts, fdm.time_step)).__next__
    return run if weather.wind.constant else _with_changing_wind(fdm, weather.wind, run)


def _steps_with_gusts(fdm: Fdm, gusts: Sequence[Gust]) -> Iterator[None]:
    """Advance the aircraft by a time step at each resumption, and begin each gust when due."""
    fdm.write(f"{_COSINE_GUST}/frame", _NORTH_EAST_DOWN)
    names = (*_DURATIONS, "magnitude-ft_sec", *_DIRECTION)
    nodes = [fdm.writable_node(f"{_COSINE_GUST}/{name}") for name in names]
    start = fdm.writable_node(f"{_COSINE_GUST}/start")
    run = fdm.run
    step = 0
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
        for node, value in zip(nodes, values, strict=True):
            node.set_double_value(value)
        start.set_double_value(1.0)
    while True:
        run()
        yield


def _with_changing_wind(
    fdm: Fdm, wind: WindField, run: Callable[[], object]
) -> Callable[[], object]:
    """``run`` after the wind of the time and height is set."""
    height_ft = fdm.node("position/h-sl-ft").get_double_value
    step = 0

    def run_in_wind() -> object:
        nonlocal step
        fdm.set_wind(*wind.now(step * fdm.time_step, height_ft() * METRES_PER_FOOT))
        step += 1
        return run()

    return run_in_wind


def end_weather(fdm: Fdm) -> None:
    """End turbulence and gusts and reset their models; place the aircraft next.

    Turbulence has to end before: JSBSim places an aircraft with a time step of 0, by which its
    turbulence divides.
    """
    fdm.write(f"{_MILSPEC}/severity", 0)
    # A gust ends by a step: JSBSim would give its direction to the next one.
    for name, duration in zip(_DURATIONS, (_AT_ONCE, 0.0, 0.0), strict=True):
        fdm.write(f"{_COSINE_GUST}/{name}", duration)
    fdm.step()
    fdm.reset()
