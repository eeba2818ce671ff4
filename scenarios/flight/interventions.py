"""When the keep-out guard changed commands, one entry for each time."""

from collections.abc import Sequence
from typing import NamedTuple


class Intervention(NamedTuple):
    """A stretch of guidance steps in each of which the guard changed the command.

    Attributes
    ----------
    time_s : when it began [s]
    duration_s : for how long it lasted [s]
    distance_min_m : how near the vessel was taken to be [m]
    lost : whether the guard's radius could not be held at some step
    """

    time_s: float
    duration_s: float
    distance_min_m: float
    lost: bool


def interventions(
    guarding: Sequence[tuple[int, float, bool]], time_step: float
) -> list[Intervention]:
    """Return the stretches.

    Parameters
    ----------
    guarding : of each step at which the guard changed the command: its number, the distance to the
        vessel [m], whether it was lost
    time_step : of the guidance [s]
    """
    stretches: list[list[tuple[int, float, bool]]] = []
    for entry in guarding:
        if stretches and entry[0] == stretches[-1][-1][0] + 1:
            stretches[-1].append(entry)
        else:
            stretches.append([entry])
    return [
        Intervention(
            time_s=stretch[0][0] * time_step,
            duration_s=len(stretch) * time_step,
            distance_min_m=min(distance for _, distance, _ in stretch),
            lost=any(lost for _, _, lost in stretch),
        )
        for stretch in stretches
    ]
