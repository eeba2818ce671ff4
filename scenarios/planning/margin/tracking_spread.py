"""How far from the keep-out area the orbit is planned, so that turbulence hardly ever carries the
aircraft into it.

Predicted from the linear closed loop and the spectrum of the turbulence: the spread of the tracking
error, how fast it varies, and by Rice's formula (S. O. Rice, "Mathematical Analysis of Random
Noise", 1944) how often it goes beyond a margin.

Of the linear loop this is an upper bound: the orbit touches the keep-out area only where it comes
closest, and is taken to be there all the time, at its largest bank, with its error in the worst
direction.

Gusts that exceed the range of the aircraft's airspeeds carry it along as long as they last. A
Gaussian process near a high peak L is L (1 - (nu t)^2/2), where nu is the ratio of its rate's
deviation to its own; what of it exceeds a limit adds up to a distance in closed form, and that is
added to the margin, with the peak that is passed as often as touches are allowed.

Not in it is how hard the aircraft can brake. Where turbulence closes the throttle, the spread is
larger than predicted: 1.4 to 2.9 times on the X8 in moderate turbulence, which the second part of
the margin made up for in 13 hours of flights. In severe turbulence an X8 can lose its reference,
and no such margin holds.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from aircraft.weather import GustStatistics
from common.physics import SECONDS_PER_HOUR
from gnc.airspeed import SpeedHold
from gnc.estimation.error_budget import AS_COMMANDED, TurnDeviation
from gnc.reference.reference import Orbit
from gnc.tracker import TrackingParameters
from innerloop.schedule import Schedule

FREQUENCIES = np.logspace(-2.5, 1.9, 400)
"""Where spectra are integrated [rad/s]: from far below the corner of a gust, V/L = 0.09, to beyond
the hold of the commands.
"""

_ORBIT_POINTS = 60

Array = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]


@dataclass(frozen=True, slots=True, kw_only=True)
class Spread:
    """Predicted standard deviations of a flight in turbulence.

    Attributes
    ----------
    along, across : error along and across the reference's course, in the mean over the orbit [m]
    radial, radial_rate : towards the vessel, and its rate: upper bounds [m, m/s]
    airspeed, airspeed_rate : of the airspeed that keeping pace takes, as fast as the aircraft gives
        it, and its rate [m/s, m/s^2]
    airspeed_limit : how far airspeed may go from the reference's speed, to the nearer side [m/s]
    """

    along: float
    across: float
    radial: float
    radial_rate: float
    airspeed: float
    airspeed_rate: float
    airspeed_limit: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SpreadTable:
    """Predicted spread of the tracking error.

    Attributes
    ----------
    speed_ratios : nu, ascending [-]
    spreads : at each of them
    turning : of a turn away
    """

    speed_ratios: tuple[float, ...]
    spreads: tuple[Spread, ...]
    turning: TurnDeviation = AS_COMMANDED

    def at(self, nu: float) -> Spread:
        """Return the spread at the nearest speed ratio."""
        return min(
            zip(self.speed_ratios, self.spreads, strict=True), key=lambda entry: abs(entry[0] - nu)
        )[1]


CALM_AIR_SPREAD = Spread(
    along=0.0,
    across=0.0,
    radial=0.0,
    radial_rate=0.0,
    airspeed=0.0,
    airspeed_rate=0.0,
    airspeed_limit=1.0,
)
"""The spread in air that does not move."""


def tracking_spreads(
    schedule: Schedule,
    turbulence: GustStatistics,
    oscillations: Sequence[Orbit],
    guidance: TrackingParameters,
    hold: SpeedHold,
    *,
    span: float,
) -> tuple[Spread, ...]:
    """Return the spreads that the linear closed loop predicts at the design airspeed nearest to the
    references' speed.

    Parameters
    ----------
    schedule : the autopilot
    turbulence, span : the air, and the wing that averages its rotation [m]
    oscillations, guidance, hold : references of one speed, and how they are tracked
    """
    # They need python-control, which a flight in calm air does without.
    from scenarios.planning.margin.gusts_on_orbit import gusts_on_orbit
    from scenarios.planning.margin.tracking_response import RESPONSES, tracking_response

    (speed,) = {oscillation.speed for oscillation in oscillations}
    index = int(np.argmin(np.abs(np.array(schedule.airspeeds) - speed)))
    banks = range(len(schedule.gain_banks))
    responses = [
        tracking_response(schedule, index, j, guidance, hold, speed, FREQUENCIES) for j in banks
    ]
    steps = [schedule.gain_trim(index, j).yaw_rate for j in banks]
    room = min(speed - hold.airspeed_min, hold.airspeed_max - speed)
    gusts = [
        gusts_on_orbit(turbulence, oscillation, FREQUENCIES, airspeed=speed, span=span)
        for oscillation in oscillations
    ]
    return tuple(
        _spread(oscillation, met, responses, steps, RESPONSES.index("pace"), room)
        for oscillation, met in zip(oscillations, gusts, strict=True)
    )


def _spread(
    oscillation: Orbit,
    gusts: Array,
    responses: list[Complex],
    steps: list[float],
    airspeed: int,
    room: float,
) -> Spread:
    """Return the spread on an orbit.

    Parameters
    ----------
    oscillation, gusts : the orbit, and the spectral densities of the gusts that are met on it
    responses, steps : to gusts, and the heading rates that they are for [rad/s]
    airspeed : row of the responses that keeps pace
    room : how far airspeed may go [m/s]
    """
    densities = [np.einsum("fig,fg,fjg->fij", r, gusts, r.conj()).real for r in responses]
    now = [_integral(density) for density in densities]
    rates = [_integral(density * FREQUENCIES[:, None, None] ** 2) for density in densities]

    phases = 2.0 * math.pi * (np.arange(_ORBIT_POINTS) + 0.5) / _ORBIT_POINTS
    turns = np.array([-oscillation.heading_rate(phase) for phase in phases.tolist()])
    mean, mean_rate = (
        _over_turns(turns, steps, matrices).mean(axis=0) for matrices in (now, rates)
    )
    steep = np.array([-oscillation.amplitude, oscillation.amplitude])
    largest, fastest = (
        np.linalg.eigvalsh(_over_turns(steep, steps, m)[:, :2, :2]).max() for m in (now, rates)
    )
    return Spread(
        along=math.sqrt(mean[0, 0]),
        across=math.sqrt(mean[1, 1]),
        radial=math.sqrt(largest),
        radial_rate=math.sqrt(fastest),
        airspeed=math.sqrt(mean[airspeed, airspeed]),
        airspeed_rate=math.sqrt(mean_rate[airspeed, airspeed]),
        airspeed_limit=room,
    )


def planned_margin(spread: Spread, *, touches_per_hour: float) -> float:
    """Return the margin [m] to plan between orbit and keep-out area.

    Parameters
    ----------
    spread : in turbulence
    touches_per_hour : how often the area may be touched, above 0 [1/h]

    Raises
    ------
    ValueError : ``touches_per_hour`` is not above 0, or the spread has a deviation and never varies
    """
    return level_crossed(spread.radial, spread.radial_rate, touches_per_hour) + beyond_limits(
        spread, touches_per_hour
    )


def level_crossed(sigma: float, sigma_rate: float, per_hour: float) -> float:
    """Return the level that a Gaussian process goes above so often; 0 if it does so less often even
    at its mean.

    By Rice's formula it goes above a level L ``sigma_rate/(2 pi sigma) exp(-(L/sigma)^2/2)`` times
    a second.

    Parameters
    ----------
    sigma, sigma_rate : standard deviations of the process and of its rate [m, m/s]
    per_hour : how often, above 0 [1/h]

    Raises
    ------
    ValueError : ``per_hour`` is not above 0, or the process has a deviation and never varies
    """
    if not per_hour > 0.0:
        raise ValueError(
            f"crossings per hour are {per_hour:g}; no margin is large enough for none: allow some, such as 0.001"
        )
    if sigma == 0.0:
        return 0.0
    if not sigma_rate > 0.0:
        raise ValueError(
            f"the rate of an error of {sigma:g} m has a deviation of {sigma_rate:g} m/s; it must vary: give above 0"
        )
    mean_per_hour = SECONDS_PER_HOUR * sigma_rate / (2.0 * math.pi * sigma)
    return sigma * math.sqrt(2.0 * math.log(max(1.0, mean_per_hour / per_hour)))


def beyond_limits(spread: Spread, per_hour: float) -> float:
    """Return how far gusts that the airspeed cannot make up carry the aircraft off its reference
    [m], so often [1/h].
    """
    peak = level_crossed(spread.airspeed, spread.airspeed_rate, per_hour)
    excess = peak - spread.airspeed_limit
    if excess <= 0.0:
        return 0.0
    half_time = math.sqrt(2.0 * excess / peak) * spread.airspeed / spread.airspeed_rate
    return 4.0 / 3.0 * excess * half_time


def _integral(density: Array) -> Array:
    """Return the variance of a density over ``FREQUENCIES``."""
    return np.asarray(np.trapezoid(density, FREQUENCIES, axis=0) / math.pi)


def _over_turns(turns: Array, at: list[float], matrices: list[Array]) -> Array:
    """Interpolate matrices, given at ascending heading rates [rad/s], at others, shape (turns, 3,
    3); beyond, the last ones.
    """
    stacked = np.stack(matrices)
    columns = [np.interp(turns, at, stacked[:, i, j]) for i in range(3) for j in range(3)]
    return np.column_stack(columns).reshape(-1, 3, 3)
