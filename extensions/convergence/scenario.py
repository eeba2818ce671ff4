"""The keys of a convergence study in a scenario file. Units are in the names; bounds are checked
here and nowhere else.
"""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from scenarios.scenario.sections.section import Positive, Section
from scenarios.scenario.study_keys import StudyFile

LawName = Literal["lyapunov", "cascade", "cascade_cut"]


class Ensemble(Section):
    """The initial states: the same for every law."""

    trajectories: Annotated[int, Field(ge=1, le=10_000_000)] = 10_000
    """Initial states, each flown with every law; a third each about a circling, oscillating and
    randomly turning reference [-].
    """
    distance_max_m: Annotated[float, Field(gt=0.0, le=100_000.0)] = 5000.0
    """Largest distance of a start from the reference; starts are sampled uniformly over the disc
    [m].
    """
    time_max_s: Annotated[float, Field(gt=0.0, le=1_000_000.0)] = 20_000.0
    """A pursuit counts as a counter-example after this time, or later where the averaged motion
    predicts slow convergence [s].
    """
    settling_band_m: Positive = 5.0
    """A pursuit has settled once its distance to the reference stays below this [m]."""
    samples: Annotated[int, Field(ge=0, le=1000)] = 6
    """Number of trajectories whose time histories are kept, in addition to those of the
    counter-examples [-].
    """


class EnsembleGuidance(Section):
    """The laws and their parameters."""

    laws: Annotated[tuple[LawName, ...], Field(min_length=1)] = ("lyapunov", "cascade")
    """Steering laws: eq. (24); eq. (30); cascade_cut, which is (30) limited to omega_max: the
    theory does not cover it.
    """
    airspeed_mps: Annotated[float, Field(ge=1.0, le=1000.0)] = 19.42
    """V_r, speed of reference and vehicle [m/s]."""
    heading_rate_max_rad_s: Annotated[float, Field(gt=0.5)] = 0.503
    """omega_max, to which commands are limited; circles turn at up to 0.5, oscillating references
    use all of it [rad/s].
    """
    epsilon_per_m: Positive = 0.005
    """epsilon of the look-ahead, eq. (15) [1/m]."""
    look_ahead_m: Positive = 60.0
    """R of the look-ahead, eq. (15) [m]; above 1/(4 epsilon)."""
    gain_per_s: Positive = 1.5
    """Slope of h(phi) in eq. (30) [1/s]."""
    steering_max_rad_s: Positive = 0.4
    """Largest |h(phi)| in eq. (30) [rad/s]."""
    lyapunov_gain_per_m2: Positive = 0.001
    """k_1 of eq. (24) [1/m2]; V_2 is formed with k_2 = 1/k_1."""

    @model_validator(mode="after")
    def _each_law_once(self) -> "EnsembleGuidance":
        if len(set(self.laws)) < len(self.laws):
            raise ValueError(f"laws is {list(self.laws)}; name each law once")
        return self


class ConvergenceScenario(StudyFile):
    """A whole scenario file of a convergence study."""

    study: Literal["convergence"]
    """Many kinematic pursuits from random initial states."""
    fidelity: Literal["kinematic"] = "kinematic"
    """The paper's vehicle, eq. (1)."""
    ensemble: Ensemble = Ensemble()
    guidance: EnsembleGuidance = EnsembleGuidance()
