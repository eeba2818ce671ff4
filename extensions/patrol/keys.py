"""The keys of a patrol in a scenario file: number and places of ships, endurance, and the expected
results of serving them.
"""

from collections.abc import Mapping
from typing import Annotated, ClassVar

from pydantic import Field

from scenarios.scenario.sections.section import NonNegative, Positive, Section
from scenarios.scenario.study_keys import StudyKeys

SHIPS_MAX = 12
"""Most ships of a patrol: the order of as many takes a second."""


class PatrolConfig(Section):
    """Several ships under way, and one UAV that serves them one after the other.

    Random variables whose keys begin with ``wind.`` are sampled for each patrol, the others for
    each ship.
    """

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
    from it [s].
    """
    service_deviation_s: NonNegative = 40.0
    """Standard deviation of that duration from ship to ship [s]."""
    oracle_share_min: Annotated[float, Field(ge=0.0, le=1.0)] = 0.8
    """Criterion: least ratio of the correct verdicts of all patrols to those of an oracle that
    knows everything [-].
    """
    wrong_share_max: Annotated[float, Field(ge=0.0, le=1.0)] = 0.05
    """Criterion: largest fraction of wrong verdicts [-]."""


class PatrolKeys(StudyKeys):
    """Keys of a patrol."""

    STUDY = "patrol"
    USED_BY = "several ships one after the other"
    TRAFFIC = True
    ONE_POINT = "give each value a run of its own"
    UNUSED: ClassVar[Mapping[str, str]] = {
        "flight.duration_max_s": "flights of a patrol are as long as patrol.patience_s allows: set"
        " that",
        "flight.crossings": "a flight of a patrol ends with a verdict or its patience: leave it"
        " out",
        "criteria.": "a patrol is judged by patrol.oracle_share_min and patrol.wrong_share_max: set"
        " these",
        "histories": "a patrol keeps no time histories: leave it out",
    }

    patrol: PatrolConfig = PatrolConfig()
