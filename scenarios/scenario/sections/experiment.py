"""The sections of a scenario file on an experiment: sweeps, cases, comparisons, random variables,
statistics, a search.
"""

import math
import sys
from typing import Annotated, Any, ClassVar, Literal

from pydantic import ConfigDict, Field, RootModel, field_validator, model_validator

from common.errors import PluginError
from scenarios.scenario.sections.needs import Need, when
from scenarios.scenario.sections.report import ReportConfig
from scenarios.scenario.sections.section import (
    Fraction,
    NonNegative,
    Positive,
    Range,
    Section,
    Seed,
    Title,
    check_ordered,
)
from scenarios.search.method import SEARCH_METHODS

Sampling = Literal["sobol", "latin_hypercube", "random"]

FLIGHTS_MAX = 1_000_000
"""Largest number of flights of one scenario [-]."""

CHAINS_MIN = 10
"""Least number of flights that pass on to the next level: with fewer, one exceptional flight would
decide all that follows.
"""

STUDY = "study"
"""Name of the variant of flights that count in the verdict, where others have that of a comparison.
"""

NU_MAX = 10.0
"""Largest speed ratio of a sweep [-]; from 1 on there is no solution, and the flight is a row that
says so.
"""


SPEED_KEYS = frozenset({"vessel.speed_mps", "vessel.speed_ratio"})
"""Keys that give the vessel's speed, each in its own way."""


def swept_key(name: str) -> str:
    """Return the key that a sweep means by a name: ``nu`` stands for the speed ratio."""
    return "vessel.speed_ratio" if name == "nu" else name


class SweepConfig(RootModel[dict[str, tuple[Any, ...]]]):
    """Keys, each with a list of values; every combination is flown. ``nu`` stands for
    ``vessel.speed_ratio``.
    """

    model_config = ConfigDict(
        json_schema_extra={"additionalProperties": {"type": ["array", "object"]}}
    )

    root: dict[str, tuple[Any, ...]] = Field(default_factory=dict)

    @model_validator(mode="before")
    @classmethod
    def _dotted(cls, given: Any) -> Any:
        """Accept ``sweep.wind.speed_mps`` for the key ``wind.speed_mps``."""
        return dict(_flat(given)) if isinstance(given, dict) else given

    @model_validator(mode="after")
    def _values(self) -> "SweepConfig":
        for key, values in self.root.items():
            if not values:
                raise ValueError(f"{key} has no values; give at least one, as in [0.3, 0.5]")
            if len(values) > 1000:
                raise ValueError(f"{key} has {len(values)} values; the most is 1000")
            if any(isinstance(value, int) and abs(value) > sys.float_info.max for value in values):
                raise ValueError(
                    f"{key} has a number of more than 308 digits; give values that flights can have"
                )
        for nu in self.root.get("nu", ()):
            if not isinstance(nu, int | float) or isinstance(nu, bool) or not 0.0 <= nu <= NU_MAX:
                raise ValueError(f"nu is {nu!r}; speed ratios lie between 0 and {NU_MAX:g}")
        return self

    @property
    def nu(self) -> tuple[float, ...]:
        """Return the swept speed ratios."""
        return tuple(float(nu) for nu in self.root.get("nu", ()))


def _flat(values: dict[str, Any], before: str = "") -> list[tuple[str, Any]]:
    return [
        entry
        for key, value in values.items()
        for entry in (
            _flat(value, f"{before}{key}.")
            if isinstance(value, dict)
            else [(f"{before}{key}", value)]
        )
    ]


class VariantConfig(Section):
    """A comparison: the same flights with other values of some keys."""

    name: Annotated[str, Field(pattern=r"^[a-z0-9_]+$")]
    """Part of the names of its flights."""
    set: dict[str, object]
    """Keys with dots, and their values."""


class ComparisonConfig(Section):
    """Extra flights that show the effect of a part. They are reported separately and do not count
    in the verdict.
    """

    nu: Annotated[
        tuple[Annotated[float, Field(ge=0.0, lt=1.0)], ...],
        Need(
            lambda s: (
                not s.comparison.nu
                or (s.comparison.variants and {*s.comparison.nu} <= {*s.sweep.nu})
            ),
            "variants that are flown at swept speed ratios: give comparison.variants, and these"
            " ratios in sweep.nu, too, or use comparison.flights",
        ),
    ] = ()
    """Swept speed ratios at which the variants are flown; all of them if not given [-]."""
    flights: Annotated[
        int | None,
        Field(ge=1, le=1_000_000),
        when("comparison.variants", user="variants"),
    ] = None
    """Number of flights at each point of the experiment that are flown with each variant; all of
    them if not given [-].
    """
    variants: tuple[VariantConfig, ...] = ()


class CaseConfig(Section):
    """One flight of a study of cases, with its own values of some keys; flown with each vehicle
    that ``fidelity`` names.
    """

    name: Annotated[str, Field(pattern=r"^[a-z0-9_]+$")]
    """Part of the names of its flights."""
    set: dict[str, object] = Field(default_factory=dict)
    """Keys with dots, and their values."""
    set_kinematic: dict[str, object] = Field(default_factory=dict)
    """Keys with dots, and their values, for the kinematic vehicle only."""
    comparison: bool = False
    """Whether it is reported separately and does not count in the verdict."""


class DrawConfig(Section):
    """A random variable: a key that is sampled for each flight from one distribution."""

    key: str
    """Dotted key of the scenario; a number is an index into a list, as in
    vessel.manoeuvres.0.turn_deg.
    """
    uniform: Range | None = None
    """Lower and upper limit of a uniform distribution [unit of the key]."""
    normal: tuple[float, Positive] | None = None
    """Mean and standard deviation of a normal distribution [unit of the key]."""
    weibull: tuple[Positive, Positive] | None = None
    """Shape [-] and scale [unit of the key] of a Weibull distribution, as for wind speeds."""
    within: Range | None = None
    """Limits at which a normal or Weibull distribution is cut off [unit of the key]."""
    choice: Annotated[tuple[object, ...], Field(min_length=1)] | None = None
    """List of values to choose from: each in turn, so that all occur equally often, or at random
    with the given weights.
    """
    weights: tuple[NonNegative, ...] | None = None
    """Weights of the choices; they need not add up to 1 [-]."""

    @model_validator(mode="after")
    def _one(self) -> "DrawConfig":
        given = [
            name
            for name in ("uniform", "normal", "weibull", "choice")
            if getattr(self, name) is not None
        ]
        if len(given) != 1:
            raise ValueError(
                f"draw of '{self.key}' has {' and '.join(given) or 'none'} of uniform, normal,"
                " weibull and choice; give one"
            )
        for name in ("uniform", "within"):
            check_ordered(f"{name} of the draw of '{self.key}'", getattr(self, name))
        if self.within is not None and given[0] not in ("normal", "weibull"):
            raise ValueError(
                f"draw of '{self.key}' has within beside {given[0]}; it cuts off normal or weibull"
            )
        if self.weights is not None and not (
            len(self.weights) == len(self.choice or ()) and 0.0 < sum(self.weights) < math.inf
        ):
            raise ValueError(
                f"draw of '{self.key}' has weights {list(self.weights)}; give each choice one,"
                " with a sum above 0"
            )
        return self

    @property
    def largest(self) -> float | None:
        """Return the largest number that may be sampled; None if there is no limit."""
        numbers = (
            self.uniform
            or self.within
            or tuple(value for value in self.choice or () if isinstance(value, int | float))
        )
        return max(numbers, default=None)


class StatisticsConfig(Section):
    """Confidence of the figures of a Monte Carlo study, and when the study may stop."""

    NEEDS: ClassVar[tuple[Need, ...]] = (when("study", "monte_carlo", user="a Monte Carlo study"),)

    confidence: Fraction = 0.95
    """Confidence level of every interval [-]."""
    violation_upper: Fraction | None = None
    """The study stops once the probability of a keep-out violation is shown to be at most this [-].
    """
    distance_quantile_width_m: Positive | None = None
    """The study stops once the interval of the quantile of the closest approach is as narrow as
    this [m].
    """
    distance_quantile: Annotated[
        Fraction,
        when("method", "plain", user="plain sampling, which may stop by it"),
    ] = 0.01
    """Quantile of the closest approach whose interval may stop the study [-]."""

    @property
    def stops(self) -> bool:
        """Return whether the study stops by itself."""
        return self.violation_upper is not None or self.distance_quantile_width_m is not None


class SubsetConfig(Section):
    """Subset simulation: levels of flights, each starting from the nearest of the level before."""

    NEEDS: ClassVar[tuple[Need, ...]] = (
        Need(
            lambda s: s.study == "monte_carlo" and s.method == "subset",
            "subset simulation: set study to 'monte_carlo' and method to 'subset'",
        ),
    )

    flights_per_level: Annotated[int, Field(ge=50, le=1_000_000)] = 500
    """Flights of a level, including those that pass on from the level before. At least 10 have to
    pass on: with the default subset.conditional_probability that takes 100 [-]."""
    conditional_probability: Annotated[float, Field(ge=0.01, le=0.5)] = 0.1
    """Fraction of a level's flights that pass on to the next: the nearest [-]."""
    levels_max: Annotated[int, Field(ge=1, le=50)] = 8
    """Largest number of levels, including the first one, a plain random sample [-]."""
    repeats: Annotated[int, Field(ge=3, le=1000)] = 5
    """Independent simulations, whose scatter gives the confidence interval [-]."""

    @property
    def passing(self) -> int:
        """Return the number of flights that pass on to the next level."""
        return round(self.flights_per_level * self.conditional_probability)

    @property
    def flights_max(self) -> int:
        """Return the number of flights of all simulations, if every level is flown and every move
        is.
        """
        return self.repeats * (
            self.flights_per_level + (self.levels_max - 1) * (self.flights_per_level - self.passing)
        )

    @model_validator(mode="after")
    def _enough(self) -> "SubsetConfig":
        if self.passing < CHAINS_MIN:
            least = math.ceil(CHAINS_MIN / self.conditional_probability)
            raise ValueError(
                f"conditional_probability times flights_per_level is {self.passing} flights that"
                f" pass on; it must be {CHAINS_MIN} at least: set subset.flights_per_level to"
                f" {least} or more"
            )
        return self


_EVOLVES = Need(
    lambda s: "differential_evolution" in s.search.methods,
    "differential evolution: put 'differential_evolution' into search.methods",
)


class SearchConfig(Section):
    """A search over the ranges of the random variables, by methods that take turns."""

    NEEDS: ClassVar[tuple[Need, ...]] = (when("study", "falsify", user="a search"),)

    methods: Annotated[tuple[str, ...], Field(min_length=1)] = (
        "corners",
        "differential_evolution",
        "local",
        "cma",
    )
    """Search methods, which take turns in this order; each by its name or FILE.py:NAME."""
    population: Annotated[int, Field(ge=8, le=10_000)] = 64
    """Flights of a turn, and members of differential evolution [-]."""
    generations: Annotated[
        int,
        Field(ge=0, le=10_000),
        Need(
            lambda s: s.search.time_s is None,
            "a search without a time: leave search.time_s out",
        ),
    ] = 30
    """Number of turns after the first, summed over all methods [-]."""
    time_s: Positive | None = None
    """Time after which no further batch is flown, instead of a number of generations [s]; in a
    resumed run it starts again at 0.
    """
    restarts: Annotated[
        int,
        Field(ge=0, le=100_000),
        Need(
            lambda s: s.search.methods != ("corners",),
            "methods that may become stuck: put 'local' or 'cma' into search.methods",
        ),
    ] = 100
    """How often a method that no longer improves restarts, from another of the worst flights or
    from a random one [-].
    """
    mutation: Annotated[tuple[Positive, Positive], _EVOLVES] = (0.5, 1.0)
    """Range of differential evolution's weight, which is sampled for each generation [-]."""
    recombination: Annotated[Fraction, _EVOLVES] = 0.7
    """Crossover probability of differential evolution: that a key is taken from the mutant [-]."""
    kept: Annotated[int, Field(ge=1, le=1000)] = 10
    """Number of worst flights, unlike one another, that are kept as scenario files and confirmed
    [-].
    """
    confirmations: Annotated[int, Field(ge=0, le=1000)] = 8
    """Number of flights with other noise that repeat each of the worst flights [-]."""

    @field_validator("methods")
    @classmethod
    def _known(cls, methods: tuple[str, ...]) -> tuple[str, ...]:
        for name in methods:
            try:
                SEARCH_METHODS.get(name)
            except PluginError as error:
                raise ValueError(str(error)) from None
        if len(set(methods)) < len(methods):
            raise ValueError(f"methods is {list(methods)}; name each method once")
        return methods

    @model_validator(mode="after")
    def _ordered(self) -> "SearchConfig":
        check_ordered("mutation", self.mutation)
        return self

    @property
    def flights_max(self) -> int:
        """Return the largest number of flights of the search, confirmations apart; those by time
        are numbered up to it.
        """
        if self.time_s is None:
            return self.population * (self.generations + 1)
        return FLIGHTS_MAX // (1 + self.confirmations)


class TrialList(Section):
    """A list of trials, flown and reported together."""

    study: Literal["trials"]
    """Scenarios that are flown and reported together."""
    title: Title
    """Title of the study in reports and lists."""
    description: str = ""
    """One or two sentences at the top of the report."""
    trials: Annotated[tuple[str, ...], Field(min_length=1)]
    """Scenarios of flights, by their names in the catalog or the paths of their files, relative to
    that of the list.
    """
    share: Annotated[float, Field(gt=0.0, le=1.0)] = 1.0
    """Fraction of each trial's flights that are flown, for a quick look [-]."""
    seed: Seed | None = None
    """Seed of every trial; each has its own if not given [-]."""
    histories: Annotated[int, Field(ge=0, le=100_000)] = 350
    """Number of time histories to be kept [-]."""
    set: tuple[str, ...] = ()
    """Keys to set in every trial, as key=value; overrides of the command line that are not keys of
    this list are added here.
    """
    report: ReportConfig = ReportConfig()
