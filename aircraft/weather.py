"""The air that an aircraft flies in: mean wind, MIL-F-8785C turbulence and discrete gusts.

Low-altitude turbulence follows MIL-F-8785C, figures 10 and 11. Between 10 and 1,000 ft, with the
height h [ft] and the wind W20 at 20 ft: sigma_w = 0.1 W20, sigma_u = sigma_v = sigma_w / (0.177 +
0.000823 h)^0.4, L_w = h, and L_u = L_v = h / (0.177 + 0.000823 h)^1.2.

JSBSim uses these formulas with the height above mean sea level. ``atmosphere/turb-type`` chooses
the filter. Type 4, which is used here, has the standard's Dryden spectra, with second-order
denominators across the wind and vertically. Type 3 keeps the standard deviations but replaces these
two spectra by first-order ones of half the time constant (MIL-STD-1797A as quoted by Yeager), which
moves energy from low to high frequencies.

Both types differ from the standard in one point: JSBSim rotates the turbulence along and across the
wind by the wind's direction with the wrong sign. The two components have equal standard deviations
and scale lengths, so only the shapes of their spectra are mixed, and not even these in a wind along
one of the four cardinal directions.
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
"""Duration of a gust that ends at once [s]: above 0, because JSBSim divides by it."""

STEPS_BETWEEN_GUSTS = 2.0
"""Number of time steps that JSBSim needs between the end of one gust and the next [-]."""


Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Turbulence:
    """Strength of the turbulence.

    Attributes
    ----------
    wind_at_20ft : mean wind 20 ft above the surface that causes the turbulence, W20 [m/s]; the wind
        that carries the aircraft may differ
    severity : curve of MIL-F-8785C, figure 7, 1 to 7, which JSBSim uses above 1,000 ft; below,
        every severity gives the same turbulence

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
    """Turbulence at one altitude: standard deviations [m/s] and scale lengths [m]."""

    horizontal: float
    vertical: float
    horizontal_length: float
    vertical_length: float


def low_altitude_turbulence(altitude: float, wind_at_20ft: float) -> GustStatistics:
    """Statistics of the turbulence at an altitude, by MIL-F-8785C; below 10 ft same as at 10 ft.

    MIL-HDBK-1797 defines the scale lengths across and down as half of these, and its spectra
    compensate for that.

    Parameters
    ----------
    altitude : above the surface [m]
    wind_at_20ft : mean wind 20 ft above the surface [m/s]

    Raises
    ------
    AircraftError : the altitude is above 1,000 ft, where other formulas hold
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
    """A gust with a 1 - cosine rise, a constant part, and a 1 - cosine fall.

    The discrete gust of MIL-F-8785C only rises.

    Attributes
    ----------
    start : time after the release [s]
    rise, hold, fall : durations [s]
    velocity_ned : velocity at the gust's peak, added to the wind: north, east, down [m/s]

    Raises
    ------
    AircraftError : a value is not finite, or rise or fall is 0, which JSBSim divides by
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
        """Time after the release at which the gust ends [s]."""
        return self.start + self.rise + self.hold + self.fall

    def share(self, time: npt.ArrayLike) -> Array:
        """Velocity over the peak velocity at times after the release [s], shape of ``time`` [-]."""
        since = np.asarray(time) - self.start
        risen = np.clip(since / self.rise, 0.0, 1.0)
        fallen = np.clip((since - self.rise - self.hold) / self.fall, 0.0, 1.0)
        return np.asarray(0.5 * (np.cos(np.pi * fallen) - np.cos(np.pi * risen)))


def ordered_gusts(gusts: Sequence[Gust], time_step: float) -> list[Gust]:
    """Gusts in the order of their starts.

    Raises
    ------
    AircraftError : two gusts overlap, or are less than ``STEPS_BETWEEN_GUSTS`` steps of
        ``time_step`` [s] apart: JSBSim simulates one gust at a time
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
    wind : mean wind over time and height
    turbulence : turbulence from the release on; None for smooth air
    gusts : discrete gusts, one at a time
    seed : random seed of the turbulence, 0 to 2^31 - 1, the range of JSBSim

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
    """Start the weather at the release, and return a function that flies one time step in it.

    With a constant wind and no gusts the function is JSBSim's own ``run``, which costs no extra
    time. The aircraft has to be placed in the wind of the release before. Turbulence starts from
    smooth air and needs a few times its horizontal scale length over the airspeed to reach its
    strength, some 30 s for 220 m at 20 m/s. Equal seeds give equal turbulence.

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
        # Resuming a generator is cheaper than calling a function, and this is the innermost call.
        run = _steps_with_gusts(fdm, ordered_gusts(weather.gusts, fdm.time_step)).__next__
    return run if weather.wind.constant else _with_changing_wind(fdm, weather.wind, run)


def _steps_with_gusts(fdm: Fdm, gusts: Sequence[Gust]) -> Iterator[None]:
    """Fly one time step at each resumption, and start each gust when it is due."""
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
        # JSBSim normalises the direction, so the magnitude is set apart.
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
    """``run``, with the wind set to its value at the time and height before each step."""
    height_ft = fdm.node("position/h-sl-ft").get_double_value
    step = 0

    def run_in_wind() -> object:
        nonlocal step
        fdm.set_wind(*wind.now(step * fdm.time_step, height_ft() * METRES_PER_FOOT))
        step += 1
        return run()

    return run_in_wind


def end_weather(fdm: Fdm) -> None:
    """End turbulence and gusts and reset their models, before the next placing of the aircraft.

    JSBSim places an aircraft with a time step of 0, by which its turbulence would divide.
    """
    fdm.write(f"{_MILSPEC}/severity", 0)
    # Flying a step ends the gust; otherwise JSBSim would use its direction for the next one.
    for name, duration in zip(_DURATIONS, (_AT_ONCE, 0.0, 0.0), strict=True):
        fdm.write(f"{_COSINE_GUST}/{name}", duration)
    fdm.step()
    fdm.reset()
