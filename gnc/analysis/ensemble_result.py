"""How trajectories of an ensemble ended, and when they count as converged."""

from dataclasses import dataclass
from enum import Enum

import numpy as np
import numpy.typing as npt

from gnc.analysis.ensemble_motion import Array

DISTANCE_CONVERGED = 0.02
"""Distance within which a vehicle is on its reference [m]."""
PHI_CONVERGED = 2e-4
"""|phi| within which a vehicle is on its reference [rad]."""


class Outcome(Enum):
    """How a trajectory ended."""

    CONVERGED = "converged"
    TIME_UP = "time_up"
    STEPS_UP = "steps_up"
    NOT_FINITE = "not_finite"


@dataclass(frozen=True, slots=True, kw_only=True)
class Tolerances:
    """Tolerated integration error of one step.

    Attributes
    ----------
    relative : of the distance to the reference [-]
    absolute : of position, on top of it [m]
    step_max : largest step [s]
    steps_max : after so many steps, rejected ones included, a trajectory is given up
    """

    relative: float = 1e-6
    absolute: float = 1e-4
    step_max: float = 10.0
    steps_max: int = 2_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class EnsembleResult:
    """How n trajectories ended; arrays of shape (n,).

    Distances and commands are those at the ends of steps, which are some seconds long.

    Attributes
    ----------
    outcome, message : and what it means
    settling_time : when the distance was last at least the settling band, linear between steps [s];
        NaN if it is at the end
    duration : time until then [s]
    distance : at the end [m]
    distance_max : largest ever [m]
    phi_0, phi : vehicle course against that of z, at the start and at the end [rad]
    heading_rate_max : largest |omega| commanded [rad/s]
    steps : of the integration, rejected ones included
    """

    outcome: tuple[Outcome, ...]
    message: tuple[str, ...]
    settling_time: Array
    duration: Array
    distance: Array
    distance_max: Array
    phi_0: Array
    phi: Array
    heading_rate_max: Array
    steps: npt.NDArray[np.int64]
