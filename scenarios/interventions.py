"""When the keep-out guard changed commands, one row for each time."""

from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

INTERVENTION_COLUMNS = ("flight_id", "trial", "time_s", "duration_s", "distance_min_m", "lost")


def interventions(time: Array, guard: Array, distance: Array) -> list[dict[str, Any]]:
    """Return the stretches of a flight in which the guard had its hands on.

    Parameters
    ----------
    time : of the samples, shape (n,) [s]
    guard : 0 while it let commands through, 1 while it changed them, 2 while it could not hold its radius
    distance : to the vessel [m]

    Returns
    -------
    list of dict : when each began [s], for how long it lasted [s], how near the vessel was, whether its radius could not be held
    """
    on = np.concatenate([[False], guard > 0.0, [False]])
    begins, ends = np.nonzero(~on[:-1] & on[1:])[0], np.nonzero(on[:-1] & ~on[1:])[0]
    sample = float(time[1] - time[0]) if len(time) > 1 else 0.0
    return [
        {
            "time_s": float(time[begin]),
            "duration_s": sample * int(end - begin),
            "distance_min_m": float(distance[begin:end].min()),
            "lost": bool((guard[begin:end] > 1.0).any()),
        }
        for begin, end in zip(begins, ends, strict=True)
    ]
