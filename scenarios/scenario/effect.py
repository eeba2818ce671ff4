"""Checks that every key of a scenario has an effect. A key that no part of the flights uses is
refused; the message names the part that would use it.
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
"""Keys that have no effect in flights in which one of the other keys is given."""

_OF_LAW = {"guidance.law", "guidance.tuning"}
"""Keys whose varied values are examined. If any other key varies, the keys that depend on it are
taken to have an effect.
"""


class _Watched:
    """A scenario, or a section of one, that records which keys a need reads. If flights differ in
    one of these, a key with this need may have an effect in some of them.

    Parameters
    ----------
    of : the scenario or the section
    above : key of the section, with a dot at its end; empty for the scenario
    read : keys that were read so far; one that ends in a dot stands for all keys that begin with it
    """

    def __init__(self, of: BaseModel, above: str, read: set[str]) -> None:
        self._of, self._above, self._read = of, above, read

    def __getattr__(self, name: str) -> Any:
        declared = getattr(type(self._of), name, None)
        if isinstance(declared, property) and declared.fget:
            # A property reads its keys through this object, so they are recorded.
            return declared.fget(self)
        if name == "sweep":
            # The section itself is the same for all flights; its swept keys differ, and are keys
            # themselves.
            return self._of.sweep  # type: ignore[attr-defined]
        if isinstance(below := getattr(self._of, name, None), BaseModel):
            return _Watched(below, f"{self._above}{name}.", self._read)
        self._read.add(self._above if callable(below) else f"{self._above}{name}")
        return getattr(self._of, name)


def reject_unused_keys(
    scenario: Scenario, given: Iterable[str], *, overridden: Scenario | None = None
) -> None:
    """Refuse keys that no part of a scenario's flights uses, also if they are swept or sampled.

    Parameters
    ----------
    scenario : the checked scenario
    given : dotted keys that its file or the command line sets
    overridden : if the command line sets the keys, the scenario before its changes. Then a key that
        is swept or sampled in every flight must not replace one of them, and they may make an
        unsteady air or vessel steady. This is not checked for keys of a file, which may come from a
        base with other flights

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
        # Setting an unknown key raises an error elsewhere.
        if _is_known(key) and (user := unused(scenario, key)):
            raise InputError(f"key '{key}' in {section} has no effect here: it is used by {user}")


def _put_aside_by(scenario: Scenario, key: str) -> str | None:
    """Return the swept or sampled key that replaces a dotted key in every flight: its section, or a
    key that is used instead of it.
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
    """Return the part that would use a dotted key, if no part of a scenario's flights uses it;
    otherwise an empty text.
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
    """Return the entries of a section that is a list of tables; empty for any other section."""
    field = type(scenario).model_fields.get(section)
    given = getattr(scenario, section, None)
    listed = field is not None and may_stand_several_times(field) and isinstance(given, tuple)
    return given if listed else ()  # type: ignore[return-value]


def sections_of(scenario: BaseModel, name: str) -> list[tuple[str, BaseModel]]:
    """Return a section with its name, or each entry of a list of tables; empty if it is not a
    section.
    """
    section = getattr(scenario, name)
    if isinstance(section, BaseModel):
        return [(name, section)]
    return [(f"{name}.{i}", entry) for i, entry in enumerate(_several(scenario, name))]


def _with_entries(scenario: Scenario, given: Iterable[str]) -> Iterator[str]:
    """Yield keys; for a section that is a list of tables, also the keys that each entry sets."""
    for key in given:
        yield key
        for number, entry in enumerate(_several(scenario, key)):
            yield from (f"{key}.{number}.{name}" for name in entry.model_fields_set)


def _alone(scenario: Scenario, key: str) -> tuple[list[Scenario], str]:
    """Return scenarios in the form that needs read, and the name of the entry that the key is in.
    Needs do not know lists of tables: each scenario has one entry in place of the list. If the key
    names no entry, there is a scenario for each of them.
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
    """Yield the need of a key that a study adds, and the need of a key that such a study does not
    use.
    """
    for keys in ADDED:
        study = keys.STUDY
        if named_by(key, keys.prefixes()):
            yield of_study(study, keys.USED_BY)
        for names, instead in keys.UNUSED.items():
            if named_by(key, (names,)):
                yield of_others(study, instead)


def named_by(key: str, names: Iterable[str]) -> bool:
    """Return whether a dotted key is among the names; one that ends in a dot stands for all keys
    that begin with it.
    """
    return any(key == name or (name.endswith(".") and key.startswith(name)) for name in names)


@functools.lru_cache(maxsize=1024)
def needs_of(key: str) -> tuple[Need, ...]:
    """Return the needs of a dotted key: its own needs first, then those of its section."""
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
    """Return whether the need may be met in some flights, because they differ in keys that it has
    read.
    """
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
            # Another check refuses an unknown law.
            return True
    return False


def _is_read(key: str, read: set[str]) -> bool:
    """Return whether a key, its section, or a key inside it is among those that were read."""
    key = without_indices(key)
    return any(
        key == of or key.startswith(f"{of.rstrip('.')}.") or of.startswith(f"{key}.") for of in read
    )


def differing(scenario: Scenario) -> Iterator[Mapping[str, object]]:
    """Yield what sweep, draws, comparison and cases set in some flights, by dotted keys."""
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
    """Return whether the scenario's comparison is flown at any point."""
    ratios = scenario.comparison.nu
    return not ratios or bool(scenario.cases) or not {*ratios}.isdisjoint(scenario.sweep.nu)


def _varied_by(scenario: Scenario, given: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Yield the keys that the given keys sweep or sample, each with the name of the section, sweep
    or draws.
    """
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
