"""The vehicle of the paper: constant speed, steered by its heading rate."""

import math
from typing import NamedTuple

_HALF_SPAN = 0.5 * math.sqrt(0.6)
_GAUSS = ((0.5 - _HALF_SPAN, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.5 + _HALF_SPAN, 5.0 / 18.0))
"""Nodes and weights of the three-point rule on 0 to 1."""

_PIECES_MAX = 200
"""Largest number of pieces of a move: a lag too short for them moves the vehicle by nothing."""


class UnicycleState(NamedTuple):
    """Position, course and heading rate of a vehicle.

    Attributes
    ----------
    north, east : [m]
    course : [rad]
    heading_rate : [rad/s]
    """

    north: float
    east: float
    course: float
    heading_rate: float


def unicycle_move(
    north: float, east: float, course: float, speed: float, heading_rate: float, duration: float
) -> tuple[float, float, float]:
    """Return position [m] and course [rad] after a move at constant speed and heading rate.

    Equation (1) integrated. The chord of the arc has the length v T sin(a)/a, with a half the angle
    turned, and the course of the arc's middle.

    Parameters
    ----------
    north, east, course : at the start [m, m, rad]
    speed, heading_rate : constant [m/s, rad/s]
    duration : T [s]
    """
    half_turn = 0.5 * heading_rate * duration
    chord = speed * duration
    if abs(half_turn) > 1e-6:
        chord *= math.sin(half_turn) / half_turn
    middle = course + half_turn
    return (
        north + chord * math.cos(middle),
        east + chord * math.sin(middle),
        course + 2.0 * half_turn,
    )


def lagged_move(
    north: float,
    east: float,
    course: float,
    heading_rate: float,
    speed: float,
    command: float,
    lag: float,
    duration: float,
) -> UnicycleState:
    """Return the state after following a commanded heading rate with a lag.

    Equation (1) with a first-order lag between command and heading rate. Course and heading rate
    are in closed form; position is Gauss and Legendre's quadrature at three nodes, over pieces no
    longer than half the lag or 0.1 s.

    Parameters
    ----------
    north, east, course, heading_rate : at the start [m, m, rad, rad/s]
    speed : v [m/s]
    command : omega commanded throughout [rad/s]
    lag : time constant of the heading rate [s], above 0
    duration : [s]
    """
    gap = heading_rate - command
    pieces = min(math.ceil(duration / min(0.5 * lag, 0.1)), _PIECES_MAX)
    piece = duration / pieces
    along = across = 0.0
    for i in range(pieces):
        for node, weight in _GAUSS:
            t = (i + node) * piece
            flown = course + command * t - gap * lag * math.expm1(-t / lag)
            along += weight * math.cos(flown)
            across += weight * math.sin(flown)
    decay = math.expm1(-duration / lag)
    distance = speed * piece
    turned = command * duration - gap * lag * decay
    return UnicycleState(
        north + distance * along,
        east + distance * across,
        course + turned,
        command + gap * (1.0 + decay),
    )


def lag_ahead(
    north: float,
    east: float,
    course: float,
    speed: float,
    heading_rate: float,
    command: float,
    lag: float,
) -> tuple[float, float, float]:
    """Return position [m] and course [rad] after the lag.

    Meanwhile the heading rate goes linearly from the measured value to the command.

    Parameters
    ----------
    north, east, course, speed : now [m, m, rad, m/s]
    heading_rate, command : measured, and last commanded [rad/s]
    lag : [s]
    """
    middle = course + lag * (heading_rate / 3.0 + command / 6.0)
    return (
        north + speed * lag * math.cos(middle),
        east + speed * lag * math.sin(middle),
        course + 0.5 * lag * (heading_rate + command),
    )
