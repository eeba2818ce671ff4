"""Which keys of a scenario act: one that no part of its flights uses is refused, with the part that
would use it.
"""

import functools
from collections.abc import Iterable, Iterator, Mapping

from common.errors import PluginError
from scenarios.errors import InputError
from scenarios.scenario.added_keys import ADDED
from scenarios.scenario.effect_rules import OPERATIONAL, RULES, Rule
from scenarios.scenario.experiment_checks import unsteady
from scenarios.scenario.keys import known_keys
from scenarios.scenario.scenario import Scenario

_DISPLACED_BY = {
    "start.distance_m": ("start.range_m", "start.place_m"),
    "start.spread_deg": ("start.aspect_deg", "start.place_m"),
    "vessel.speed_mps": ("vessel.speed_ratio",),
}
"""Keys that other keys put aside, where flights have these."""

_OF_LAW = ("guidance.law", "guidance.tuning")
"""Keys of which it is looked at what they are set to; others count as making what depends on them
act.
"""


def refuse_unused(
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
    given = sorted(given)
    turned_off = {*unsteady(overridden)} - {*unsteady(scenario)} if overridden else set()
    for key in given:
        if key not in turned_off and (user := unused(scenario, key)):
            raise InputError(f"key '{key}' has no effect here: it is used by {user}")
        if overridden and (other := _put_aside_by(scenario, key)):
            raise InputError(
                f"key '{key}' has no effect here: '{other}' is swept or sampled in every flight, and takes its place; set '{other}'"
                " instead, or leave it out of sweep and draws"
            )
    for section, key in _varied_by(scenario, given):
        if key == "fidelity":
            raise InputError(
                "key 'fidelity' has no effect in sweep; leave it out there, and set fidelity to 'both'"
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
    # A mission that is given does not follow from the air, the vessel or the equipment.
    mission = ("guidance.mission", *(OPERATIONAL if scenario.guidance.mission is None else ()))
    for rule in _rules_of(key):
        depends = (*rule.depends, *(mission if rule.by_mission else ()))
        if not rule.acts(scenario) and not (depends and _acts_in_some(rule, scenario, depends)):
            return rule.user
    return ""


def _acts_in_some(rule: Rule, scenario: Scenario, depends: tuple[str, ...]) -> bool:
    """Return whether a rule's keys act in some flights, as what that depends on differs from flight
    to flight.
    """
    for values in differing(scenario):
        if not (other := {key: value for key, value in values.items() if named_by(key, depends)}):
            continue
        if not all(key in _OF_LAW and isinstance(value, str) for key, value in other.items()):
            return True
        guidance = scenario.guidance.model_copy(
            update={key.partition(".")[2]: value for key, value in other.items()}
        )
        try:
            acts = rule.acts(scenario.model_copy(update={"guidance": guidance}))
        except PluginError:
            # A law that is unknown is refused where it is named.
            acts = True
        if acts:
            return True
    return False


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
    return ".".join("0" if part.isdecimal() else part for part in key.split(".")) in _known_keys()


@functools.cache
def _known_keys() -> frozenset[str]:
    return frozenset(known_keys(Scenario))


@functools.lru_cache(maxsize=1024)
def _rules_of(key: str) -> tuple[Rule, ...]:
    return tuple(rule for rule in RULES if named_by(key, rule.keys))


def named_by(key: str, names: Iterable[str]) -> bool:
    """Return whether a dotted key is among the names, of which those that end in a dot are
    beginnings of keys.
    """
    return any(key == name or (name.endswith(".") and key.startswith(name)) for name in names)
