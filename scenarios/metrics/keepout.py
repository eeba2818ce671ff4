"""How a path keeps out of a sphere about a moving point."""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class KeepoutFigures:
    """What happened to the keep-out area over a path.

    Attributes
    ----------
    violations : number of separate stays inside
    time_inside : [s]
    depth : how far inside the path came [m]
    distance_min : closest approach to the centre [m]
    """

    violations: int
    time_inside: float
    depth: float
    distance_min: float


def keepout_figures(time: Array, position: Array, radius: float) -> KeepoutFigures:
    """Measure a path against a sphere of ``radius`` [m] about the origin.

    The path is straight between samples: at 10 Hz and 45 degrees of bank it is true to 1 cm.

    Parameters
    ----------
    time : shape (n,) [s]
    position : shape (n, 3), from the sphere's centre [m]
    radius : [m]
    """
    start, move = position[:-1], np.diff(position, axis=0)
    length_squared = np.maximum(np.sum(move**2, axis=1), 1e-12)
    closest = np.clip(-np.sum(start * move, axis=1) / length_squared, 0.0, 1.0)
    distance = np.linalg.norm(start + closest[:, None] * move, axis=1)
    distance_min = float(min(np.min(distance, initial=math.inf), np.linalg.norm(position, axis=1).min()))
    # Entry and exit within each segment: |start + s move| = radius.
    half = np.sum(start * move, axis=1) / length_squared
    discriminant = half**2 - (np.sum(start**2, axis=1) - radius**2) / length_squared
    root = np.sqrt(np.maximum(discriminant, 0.0))
    enter, leave = np.clip(-half - root, 0.0, 1.0), np.clip(-half + root, 0.0, 1.0)
    inside = np.where(discriminant > 0.0, leave - enter, 0.0) * np.diff(time)
    entered = inside > 0.0
    return KeepoutFigures(
        violations=int(np.count_nonzero(entered & ~np.concatenate([[False], entered[:-1]]))),
        time_inside=float(np.sum(inside)),
        depth=max(0.0, radius - distance_min),
        distance_min=distance_min,
    )
