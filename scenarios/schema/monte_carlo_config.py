"""What studies may say that choose what is drawn: Monte Carlo, and the search for the worst."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from scenarios.schema.config import Positive, Section
from scenarios.schema.sea_config import SeaScenario

Share = Annotated[float, Field(gt=0.0, lt=1.0)]


class Statistics(Section):
    """How sure the figures of a study are to be."""

    confidence: Share = 0.95
    """Of every interval [-]."""
    violation_upper: Share | None = None
    """Stop once the probability of entering the keep-out area is shown to be at most this [-]."""
    distance_quantile_width_m: Positive | None = None
    """Stop once the interval of the quantile of the closest approach is as narrow as this [m]."""
    distance_quantile: Share = 0.01
    """Which quantile that is [-]."""

    @property
    def stops(self) -> bool:
        """Return whether the study stops by itself."""
        return self.violation_upper is not None or self.distance_quantile_width_m is not None


class MonteCarloScenario(SeaScenario):
    """Flights over the real sea that are drawn to estimate how often, and how much."""

    study: Literal["monte_carlo"]  # type: ignore[assignment]
    sampling: Literal["sobol", "latin_hypercube", "random"] = "sobol"
    """How what is drawn is spread: evenly over all distributions at once, or over each, or not at all."""
    statistics: Statistics = Statistics()


class Search(Section):
    """A search by differential evolution over the ranges of what is drawn."""

    population: Annotated[int, Field(ge=8, le=10_000)] = 64
    """Flights of a generation [-]."""
    generations: Annotated[int, Field(ge=0, le=10_000)] = 30
    """Generations after the first, which is a Sobol sequence [-]."""
    mutation: tuple[Positive, Positive] = (0.5, 1.0)
    """Range of the differential weight, drawn anew for each generation [-]."""
    recombination: Share = 0.7
    """Probability with which a key comes from the mutant [-]."""
    kept: Annotated[int, Field(ge=1, le=1000)] = 10
    """Worst flights that are kept as scenario files [-]."""


class FalsifyScenario(SeaScenario):
    """A search for the flight over the real sea that comes closest to the vessel.

    ``flights`` has no effect: how many are flown follows from ``search``.
    """

    study: Literal["falsify"]  # type: ignore[assignment]
    search: Search = Search()

    @model_validator(mode="after")
    def _something_to_search(self) -> "FalsifyScenario":
        if not self.draws:
            raise ValueError("draws is empty; give the keys to search over, each with its range")
        return self
