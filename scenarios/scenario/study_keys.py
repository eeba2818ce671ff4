"""Keys that studies of installed packages add to a scenario file."""

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar, Self

from pydantic import BaseModel

from scenarios.scenario.sections.report import ReportConfig
from scenarios.scenario.sections.section import Section, Seed, Title


class StudyKeys(Section):
    """Keys that a study adds to the scenario files of flights: its fields.

    A field that is a ``Section`` is a section of the file, any other one a key outside of sections.
    Each has a default and a description. An installed package announces a subclass in the group
    ``plume_flight_study.keys`` by the name of its study. The subclass's module imports of this
    project only ``scenarios.scenario.study_keys`` and ``scenarios.scenario.sections``::

        class WeavingKeys(StudyKeys):
            STUDY = "weaving"
            USED_BY = "flights that weave"
            weaving: WeavingSection = WeavingSection()

    Attributes
    ----------
    STUDY : the study that uses the keys
    USED_BY : what uses the study's keys, for the message if another study is given one of them
    ONE_POINT : why the study refuses a sweep, cases and comparisons; empty if it takes them
    UNUSED : keys that the study does not use, each with what it uses instead; a name that ends in a
        dot stands for all keys that begin with it
    LAW_KEYS : its keys that name steering laws
    TRAFFIC : whether its flights have ships besides the one that is measured
    """

    STUDY: ClassVar[str]
    USED_BY: ClassVar[str]
    ONE_POINT: ClassVar[str] = ""
    UNUSED: ClassVar[Mapping[str, str]] = {}
    LAW_KEYS: ClassVar[tuple[str, ...]] = ()
    TRAFFIC: ClassVar[bool] = False

    @classmethod
    def of(cls, scenario: Any) -> Self:
        """Return the object as a scenario, to which these keys belong."""
        keys: Self = scenario
        return keys

    @classmethod
    def differing(cls, scenario: Any) -> Iterator[Mapping[str, object]]:
        """Yield what the study sets for some of its flights, by dotted keys; None stands for values
        that are not known yet.
        """
        for _, _, values in cls.tables(scenario):
            yield values

    @classmethod
    def tables(cls, scenario: Any) -> Iterator[tuple[str, str, Mapping[str, Any]]]:  # noqa: ARG003
        """Yield the tables of the study's own sections that set keys for some of its flights: the
        kind of the table, its name, and the values by dotted keys.
        """
        yield from ()

    @classmethod
    def names(cls) -> tuple[str, ...]:
        """Return the names of the fields."""
        return tuple(name for name in cls.model_fields if name not in StudyKeys.model_fields)

    @classmethod
    def prefixes(cls) -> tuple[str, ...]:
        """Return the names of the fields; names of sections end in a dot."""
        return tuple(
            f"{name}." if isinstance(cls.model_fields[name].default, BaseModel) else name
            for name in cls.names()
        )


class StudyFile(Section):
    """The keys that every scenario file has, also that of a study whose flights ``Scenario`` does
    not describe.

    An installed package announces a subclass in the group ``plume_flight_study.scenario`` by the
    name of its study, whose class is called with it, its name, and the overrides.
    """

    study: str
    """Name of the study."""
    title: Title
    """What reports and lists call it."""
    description: str = ""
    """One or two sentences at the top of the report."""
    seed: Seed = 1
    """Seed of everything that is sampled at random [-]."""
    report: ReportConfig = ReportConfig()
