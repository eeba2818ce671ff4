"""What a scenario file may say of a patrol: how many ships, where, for how long, and what is expected of serving them."""

from typing import Annotated

from pydantic import Field

from scenarios.schema.sections.section import NonNegative, Positive, Section

SHIPS_MAX = 12
"""Most ships of a patrol: the order of as many takes a second."""


class PatrolConfig(Section):
    """Several ships on their ways, and one UAV that serves them one after the other.

    Random variables whose keys begin with ``wind.`` are sampled for each patrol, the others for each ship.
    """

    ships: Annotated[int, Field(ge=1, le=SHIPS_MAX)] = 6
    """Ships [-]."""
    endurance_s: Annotated[float, Field(gt=0.0, le=100_000.0)] = 5400.0
    """Time from the take-off to the end of the last measurement; the way home is not part of it [s]."""
    area_m: Positive = 40_000.0
    """Side of the square in which ships are at the start; the UAV begins in its middle [m]."""
    separation_m: NonNegative = 3000.0
    """Least distance of any two ships over the whole endurance, and of each from the UAV's place at the start [m]."""
    clearance_m: NonNegative = 300.0
    """How far beyond r_min a way between ships stays from each of them [m]."""
    patience_s: Positive = 600.0
    """Longest flight beside a ship [s]."""
    service_s: Positive = 165.0
    """Duration that is expected of a flight beside a ship, from start.distance_m to the verdict and away from her [s]."""
    service_deviation_s: NonNegative = 40.0
    """Its standard deviation from ship to ship [s]."""
    oracle_share_min: Annotated[float, Field(ge=0.0, le=1.0)] = 0.8
    """Criterion: correct verdicts of all patrols over those of an oracle that knows everything, at least [-]."""
    wrong_share_max: Annotated[float, Field(ge=0.0, le=1.0)] = 0.05
    """Criterion: wrong ones among all verdicts, at most [-]."""
