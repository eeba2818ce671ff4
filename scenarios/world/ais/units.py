"""Whether speeds and courses of a file of AIS reports are in the units that its layout has: by the
places between them.
"""

import math
from pathlib import Path

import numpy as np
import numpy.typing as npt

from common.geodesy import cartesian
from scenarios.errors import InputError
from scenarios.scenario.sections.world import GAP_MAX

Array = npt.NDArray[np.float64]

_PAIRS_MIN = 10
"""Pairs of neighbouring reports from which on they are judged: of fewer, scattered places decide.
"""

_WAY_MIN, _TIME_MAX = 30.0, 60.0
"""Least way between the places of a pair [m], which scatter by some, and longest time [s]: in it
she goes nearly straight.
"""

_TURN_MAX, _FASTER_MAX = math.radians(10.0), 1.2
"""Change of course [rad], and larger over smaller speed [-], up to which she went straight and
evenly in a longer time.
"""

_RATIO = (0.7, 1.4)
"""Speeds over those between places, in the median [-]: metres per second for knots are 0.51, km/h
are 1.85.
"""

_CLOSE = 0.3
"""Share of these that places which are swapped have to keep to: then they fit, and not by chance.
"""

_OFF_MAX = 30.0
"""Difference of courses from those between places, in the median [deg]."""


def check_units(
    path: Path, time: Array, latitude: Array, longitude: Array, speed: Array, course: Array
) -> None:
    """Raise an InputError where speeds [m/s] or courses [rad] are not those between places [rad],
    in the median of all pairs.
    """
    judged = _against_places(time, latitude, longitude, speed, course)
    if judged is None or _agree(*judged):
        return
    ratio, off = judged
    swapped = _against_places(time, longitude, latitude, speed, course)
    if swapped is not None and _agree(*swapped, share=_CLOSE):
        raise InputError(
            f"{path}: latitude and longitude are swapped: only so are speeds and courses those between places; swap the"
            " columns' names"
        )
    if not _RATIO[0] <= ratio <= _RATIO[1]:
        raise InputError(
            f"{path}: reported speeds are {ratio:.2f} of those between places, in the median; they must be in knots (column"
            " sog_kn or SOG), and latitude and longitude in degrees: convert them"
        )
    raise InputError(
        f"{path}: reported courses are {off:.0f} deg off those between places, in the median; they must be over the ground, in"
        " degrees from true north (column cog_deg or COG): convert them, or take another column"
    )


def _against_places(
    time: Array, latitude: Array, longitude: Array, speed: Array, course: Array
) -> tuple[float, float] | None:
    """Return the median ratio of speeds to those between places [-], and of differences of course
    [deg]; none of too few pairs.
    """
    way = np.diff(cartesian(latitude, longitude), axis=0)
    apart, passed = np.linalg.norm(way, axis=-1), np.diff(time)
    mean = 0.5 * (speed[1:] + speed[:-1])
    far = (np.maximum(apart, mean * passed) > _WAY_MIN * np.maximum(1.0, passed / _TIME_MAX)) & (
        apart > 0.0
    )
    judged = far & (passed <= _TIME_MAX)
    if np.count_nonzero(judged) < _PAIRS_MIN:
        judged |= far & _straight(passed, speed, course)
    if np.count_nonzero(judged) < _PAIRS_MIN:
        return None
    sin_lat, cos_lat, sin_lon, cos_lon = (
        f(of[:-1]) for of in (latitude, longitude) for f in (np.sin, np.cos)
    )
    north = -sin_lat * cos_lon * way[:, 0] - sin_lat * sin_lon * way[:, 1] + cos_lat * way[:, 2]
    east = cos_lon * way[:, 1] - sin_lon * way[:, 0]
    middle = np.angle(np.exp(1j * course[1:]) + np.exp(1j * course[:-1]))
    off = np.abs(np.angle(np.exp(1j * (np.arctan2(east, north) - middle))))
    return float(np.median((mean * passed / np.maximum(apart, 1e-9))[judged])), float(
        np.degrees(np.median(off[judged]))
    )


def _straight(passed: Array, speed: Array, course: Array) -> npt.NDArray[np.bool_]:
    """Return which pairs, shape (n - 1,), that a track bridges lie within a straight and even
    stretch, with both neighbours.
    """
    turned = np.abs(np.angle(np.exp(1j * np.diff(course))))
    slower, faster = np.minimum(speed[1:], speed[:-1]), np.maximum(speed[1:], speed[:-1])
    even = (passed <= GAP_MAX) & (turned <= _TURN_MAX) & (faster <= _FASTER_MAX * slower)
    around = np.concatenate([[True], even, [True]])
    straight: npt.NDArray[np.bool_] = even & around[:-2] & around[2:]
    return straight


def _agree(ratio: float, off: float, share: float = 1.0) -> bool:
    """Return whether speeds and courses are those between places, within a share of what is
    allowed.
    """
    return (
        1.0 + share * (_RATIO[0] - 1.0) <= ratio <= 1.0 + share * (_RATIO[1] - 1.0)
        and off <= share * _OFF_MAX
    )
