"""The keys of an arena in a scenario file."""

from collections.abc import Iterator, Mapping
from typing import Annotated, Any

from pydantic import Field

from scenarios.scenario.sections.section import NonNegative, Positive, Section, Title
from scenarios.scenario.study_keys import StudyKeys


class ConditionConfig(Section):
    """A condition in which every law of an arena flies."""

    name: Annotated[str, Field(pattern=r"^[a-z0-9_]+$")]
    """Part of the names of its flights."""
    title: Title
    """Title of the condition in the report."""
    set: dict[str, object] = Field(default_factory=dict)
    """Keys with dots, and their values."""


class ArenaConfig(Section):
    """A comparison of steering laws: which take part, where, and how each is tuned."""

    tracking: tuple[str, ...] = ()
    """Laws that track the oscillating reference."""
    standoff: tuple[str, ...] = ()
    """Laws that circle the vessel."""
    conditions: tuple[ConditionConfig, ...] = ()
    """Conditions, each a trial, with the same starts, winds and turbulence for every law."""
    evaluations: Annotated[int, Field(ge=0, le=10_000)] = 12
    """Number of settings that the tuner tries for each law, starting with its defaults; 0 to fly
    the defaults [-].
    """
    tuning_flights: Annotated[int, Field(ge=1, le=1000)] = 4
    """Number of tuning flights of each setting: kinematic vehicle, seeds that the comparison does
    not use [-].
    """
    tuning_duration_s: Positive = 200.0
    """Duration of a tuning flight [s]."""
    tuning_set: dict[str, object] = Field(default_factory=dict)
    """Keys of the tuning flights, and their values."""
    tuning_range: Annotated[float, Field(gt=1.0, le=1000.0)] = 4.0
    """Factor of the range of every parameter: it is tried from its default divided by this to its
    default times this [-].
    """
    effort_weight_m_s: NonNegative = 20.0
    """Weight in the tuner's cost of the heading rate commanded in excess of the reference's, as a
    tracking error [m per rad/s].
    """
    error_max_m: Positive = 100.0
    """Limit of the tracking error in the tuner's cost: a larger one costs no more [m]."""
    window_s: Positive = 150.0
    """Time before the end of each flight over which it is evaluated, whether it has settled or not
    [s].
    """
    resamples: Annotated[int, Field(ge=100, le=1_000_000)] = 2000
    """Number of resamples of the paired bootstrap [-]."""
    limits: tuple[tuple[float, float], ...] = ()
    """Most crossings per minute that any path allows: pairs of nu [-] and crossings [1/min]; from
    the solved table if empty.
    """


class ArenaKeys(StudyKeys):
    """Keys of an arena."""

    STUDY = "arena"
    USED_BY = "laws side by side"
    ONE_POINT = "what differs are the laws (laws) and the conditions (arena.conditions)"
    LAW_KEYS = ("laws", "arena.tracking", "arena.standoff")

    laws: tuple[str, ...] = ()
    """Laws that take part in an arena in addition to the built-in ones, each by its name or
    FILE.py:NAME.
    """
    arena: ArenaConfig = ArenaConfig()

    @classmethod
    def differing(cls, scenario: Any) -> Iterator[Mapping[str, object]]:
        """Yield the settings of an arena for some of its flights: law and mission, and
        conditions.
        """
        yield {"guidance.law": None, "guidance.mission": None}
        yield from super().differing(scenario)

    @classmethod
    def tables(cls, scenario: Any) -> Iterator[tuple[str, str, Mapping[str, Any]]]:
        """Yield the conditions."""
        for condition in cls.of(scenario).arena.conditions:
            yield "condition", condition.name, condition.set
