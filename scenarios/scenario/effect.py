"""Which keys of a scenario act: one that no part of its flights uses is refused, with the part that
would use it.
"""

import functools
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from pydantic import BaseModel

from common.errors import PluginError
from scenarios.errors import InputError
from scenarios.scenario.added_keys import ADDED
from scenarios.scenario.consistency import unsteady
from scenarios.scenario.errors import (
    fields_along,
    known_keys,
    may_stand_several_times,
    models_in,
    without_indices,
)
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.needs import Need, of_others, of_study

_DISPLACED_BY = {
    "start.distance_m": ("start.range_m", "start.place_m"),
    "start.spread_deg": ("start.aspect_deg", "start.place_m"),
    "vessel.speed_mps": ("vessel.speed_ratio",),
}
"""Keys that other keys put aside, where flights have these."""

_OF_LAW = {"guidance.law", "guidance.tuning"}
"""Keys whose value is looked at; others count as making what depends on them act.
"""


class _Watched:
    """A scenario, or a section of one, that notes which keys a need reads: keys that depend on
    these act where flights differ in them.

    Parameters
    ----------
    of : the scenario or the section
    above : its key with a dot behind it; empty for the scenario
    read : the keys, and beginnings of keys that end in a dot, that were read so far
    """

    def __init__(self, of: BaseModel, above: str, read: set[str]) -> None:
        self._of, self._above, self._read = of, above, read

    def __getattr__(self, name: str) -> Any:
        declared = getattr(type(self._of), name, None)
        if isinstance(declared, property) and declared.fget:
            # What follows from keys notes these, as it reads them here.
            return declared.fget(self)
        if name == "sweep":
            # The same for all flights: what is swept differs, and is a key of its own.
            return self._of.sweep  # type: ignore[attr-defined]
        if isinstance(below := getattr(self._of, name, None), BaseModel):
            return _Watched(below, f"{self._above}{name}.", self._read)
        self._read.add(self._above if callable(below) else f"{self._above}{name}")
        return getattr(self._of, name)


def reject_unused_keys(
    scenario: Scenario, given: Iterable[str], *, overridden: Scenario | None = None
) -> None:
    """Refuse keys that no part of a scenario's flights uses, those among them that are swept or
    sampled.

    Parameters
    ----------
    scenario : as checked
    given : dotted keys that its file or the command line sets
    overridden : where the command line sets them, what it changes. Then another key that is swept
        or sampled in every flight must not put them aside, and they may turn off what made air or
        vessel unsteady; what a file says may be of other flights, such as those of a base that it
        was made from

    Raises
    ------
    InputError : a key has no effect; the message names the part that would use it
    """
    given = sorted(_with_entries(scenario, given))
    turned_off = {*unsteady(overridden)} - {*unsteady(scenario)} if overridden else set()
    for key in given:
        if key not in turned_off and (user := unused(scenario, key)):
            raise InputError(f"key '{key}' has no effect here: it is used by {user}")
        if overridden and (other := _put_aside_by(scenario, key)):
            raise InputError(
                f"key '{key}' has no effect here: '{other}' is swept or sampled in every flight,"
                f" and takes its place; set '{other}', or leave it out of sweep and draws"
            )
    for section, key in _varied_by(scenario, given):
        if key == "fidelity":
            raise InputError(
                "key 'fidelity' has no effect in sweep; leave it out there, and set fidelity to"
                " 'both'"
            )
        # What is said of an unknown key comes when it is set.
        if _is_known(key) and (user := unused(scenario, key)):
            raise InputError(f"key '{key}' in {section} has no effect here: it is used by {user}")


def _put_aside_by(scenario: Scenario, key: str) -> str | None:
    """Return the swept or sampled key that puts a dotted key aside in every flight: one above it,
    or one in its place.
    """
    varied = (*scenario.sweep.root, *(draw.key for draw in scenario.draws))
    return next(
        (
            other
            for other in varied
            if key.startswith(f"{other}.") or other in _DISPLACED_BY.get(key, ())
        ),
        None,
    )


def unused(scenario: Scenario, key: str) -> str:
    """Return the part that would use a dotted key, where no part of a scenario's flights does;
    otherwise nothing.
    """
    seen, above = _alone(scenario, key)
    for need in needs_of(key):
        if not any(_acts(need, of) for of in seen):
            return (
                need.user.replace(f"{without_indices(above)}.", f"{above}.") if above else need.user
            )
    return ""


def _acts(need: Need, scenario: Scenario) -> bool:
    read: set[str] = set()
    return bool(need.acts(_Watched(scenario, "", read))) or _acts_in_some(need, scenario, read)


def _several(scenario: BaseModel, section: str) -> tuple[BaseModel, ...]:
    """Return the entries of a section that stands several times; none of any other."""
    field = type(scenario).model_fields.get(section)
    given = getattr(scenario, section, None)
    listed = field is not None and may_stand_several_times(field) and isinstance(given, tuple)
    return given if listed else ()  # type: ignore[return-value]


def sections_of(scenario: BaseModel, name: str) -> list[tuple[str, BaseModel]]:
    """Return a section with its name, each entry of one that stands several times; nothing of what
    is no section.
    """
    section = getattr(scenario, name)
    if isinstance(section, BaseModel):
        return [(name, section)]
    return [(f"{name}.{i}", entry) for i, entry in enumerate(_several(scenario, name))]


def _with_entries(scenario: Scenario, given: Iterable[str]) -> Iterator[str]:
    """Yield keys, and those that are set in each entry of sections among them."""
    for key in given:
        yield key
        for number, entry in enumerate(_several(scenario, key)):
            yield from (f"{key}.{number}.{name}" for name in entry.model_fields_set)


def _alone(scenario: Scenario, key: str) -> tuple[list[Scenario], str]:
    """Return a scenario as the needs of a key read it, which know a section that stands once, and
    the entry that the key is in; where the key names none, a scenario for each entry.
    """
    section, _, rest = key.partition(".")
    entries = _several(scenario, section)
    if not (entries and rest):
        return [scenario], ""
    seen = [scenario.model_copy(update={section: entry}) for entry in entries]
    number = rest.partition(".")[0]
    if not number.isdecimal():
        return seen, ""
    return seen[int(number) : int(number) + 1], f"{section}.{number}"


def _needs_by_study(key: str) -> Iterator[Need]:
    """Yield what a key needs that a study adds, or that a study which adds keys does not use."""
    for keys in ADDED:
        study = keys.STUDY
        if named_by(key, keys.prefixes()):
            yield of_study(study, keys.USED_BY)
        for names, instead in keys.UNUSED.items():
            if named_by(key, (names,)):
                yield of_others(study, instead)


def named_by(key: str, names: Iterable[str]) -> bool:
    """Return whether a dotted key is among the names; those that end in a dot begin keys."""
    return any(key == name or (name.endswith(".") and key.startswith(name)) for name in names)


@functools.lru_cache(maxsize=1024)
def needs_of(key: str) -> tuple[Need, ...]:
    """Return what a dotted key needs to act: first what stands at the key, then what stands at the
    section that it is in.
    """
    needs = list(_needs_by_study(key))
    section: Any = Scenario
    parts = [part for part in key.split(".") if not part.isdecimal()]
    for depth, field in enumerate(fields_along(Scenario, parts)):
        if field is None:
            of_part = getattr(section, "PART_NEEDS", {}).get(parts[depth], ())
            return (*of_part, *needs)
        needs = [*(of for of in field.metadata if isinstance(of, Need)), *needs]
        if depth + 1 < len(parts):
            section = next(models_in(field.annotation), (None, False))[0]
            needs += getattr(section, "NEEDS", ())
    return tuple(dict.fromkeys(needs))


def _acts_in_some(need: Need, scenario: Scenario, read: set[str]) -> bool:
    """Return whether flights that differ in keys that a need has read may have it."""
    for values in differing(scenario):
        other = {key: value for key, value in values.items() if _is_read(key, read)}
        if any(key not in _OF_LAW or not isinstance(of, str) for key, of in other.items()):
            return True
        changed = {key.partition(".")[2]: value for key, value in other.items()}
        guidance = scenario.guidance.model_copy(update=changed)
        try:
            if other and need.acts(scenario.model_copy(update={"guidance": guidance})):
                return True
        except PluginError:
            # A law that is unknown is refused where it is named.
            return True
    return False


def _is_read(key: str, read: set[str]) -> bool:
    """Return whether a key, or one above or below it, is among those that were read."""
    key = without_indices(key)
    return any(
        key == of or key.startswith(f"{of.rstrip('.')}.") or of.startswith(f"{key}.") for of in read
    )


def differing(scenario: Scenario) -> Iterator[Mapping[str, object]]:
    """Yield what some flights of a scenario set beside it, by dotted keys."""
    for key, swept in scenario.sweep.root.items():
        yield from ({key: value} for value in swept)
    for draw in scenario.draws:
        yield from ({draw.key: value} for value in draw.choice or (None,))
    if compares(scenario):
        for variant in scenario.comparison.variants:
            yield variant.set
    yield from (case.set | case.set_kinematic for case in scenario.cases)
    for keys in ADDED:
        if scenario.study == keys.STUDY:
            yield from keys.differing(scenario)


def compares(scenario: Scenario) -> bool:
    """Return whether variants are flown at all: at every point, at one of a speed ratio that is
    swept, or in cases.
    """
    ratios = scenario.comparison.nu
    return not ratios or bool(scenario.cases) or not {*ratios}.isdisjoint(scenario.sweep.nu)


def _varied_by(scenario: Scenario, given: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Yield the keys that given keys sweep or sample, each with the section that does."""
    names = [key.replace('"', "") for key in given]
    for key in scenario.sweep.root:
        if "sweep" in names or f"sweep.{key}" in names:
            yield "sweep", key
    if any(
        name == "draws" or (name.startswith("draws.") and name.endswith(".key")) for name in names
    ):
        yield from (("draws", draw.key) for draw in scenario.draws)


def _is_known(key: str) -> bool:
    with_first = ".".join("0" if part.isdecimal() else part for part in key.split("."))
    return not {with_first, without_indices(key)}.isdisjoint(_known_keys())


@functools.cache
def _known_keys() -> frozenset[str]:
    return frozenset(known_keys(Scenario))
