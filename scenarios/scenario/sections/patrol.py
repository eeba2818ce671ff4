"""What a scenario file may say of a patrol: how many ships, where, for how long, and what is
expected of serving them.
"""

from typing import Annotated, ClassVar

from pydantic import Field

from scenarios.scenario.sections.needs import Need, of_study
from scenarios.scenario.sections.section import NonNegative, Positive, Section

SHIPS_MAX = 12
"""Most ships of a patrol: the order of as many takes a second."""


class PatrolConfig(Section):
    """Several ships under way, and one UAV that serves them one after the other.

    Random variables whose keys begin with ``wind.`` are sampled for each patrol, the others for
    each ship.
    """

    NEEDS: ClassVar[tuple[Need, ...]] = (of_study("patrol", "several ships one after the other"),)

    ships: Annotated[int, Field(ge=1, le=SHIPS_MAX)] = 6
    """Number of ships [-]."""
    endurance_s: Annotated[float, Field(gt=0.0, le=100_000.0)] = 5400.0
    """Time from the take-off to the end of the last measurement; the way home is not part of it
    [s].
    """
    area_m: Positive = 40_000.0
    """Side of the square in which the ships are at the start; the UAV starts in its centre [m]."""
    separation_m: NonNegative = 3000.0
    """Least distance of any two ships over the whole endurance, and of each from the UAV's place at
    the start [m].

    At least the end of start.distance_m and keepout.radius_m together.
    """
    clearance_m: NonNegative = 300.0
    """Distance beyond r_min that the UAV keeps from every ship on its way between ships [m]."""
    patience_s: Positive = 600.0
    """Longest flight beside a ship [s]."""
    service_s: Positive = 165.0
    """Expected duration of a flight beside a ship, from start.distance_m to the verdict and away
    from her [s].
    """
    service_deviation_s: NonNegative = 40.0
    """Standard deviation of that duration from ship to ship [s]."""
    oracle_share_min: Annotated[float, Field(ge=0.0, le=1.0)] = 0.8
    """Criterion: least ratio of the correct verdicts of all patrols to those of an oracle that
    knows everything [-].
    """
    wrong_share_max: Annotated[float, Field(ge=0.0, le=1.0)] = 0.05
    """Criterion: largest fraction of wrong verdicts [-]."""
