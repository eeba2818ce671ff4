"""The entrants of an arena: each law in each task that it supports, with the reason for the other
tasks.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from common.errors import PluginError
from common.registry import is_file_part
from extensions.arena import STANDOFF, TRACKING
from extensions.arena.keys import ArenaKeys
from gnc.laws import ON_CIRCLE, ON_OSCILLATION, STEERING_LAWS
from scenarios.errors import InputError
from scenarios.scenario.files import with_values
from scenarios.scenario.overrides import displaced
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.guidance import GuidanceConfig, law_refusal

TUNING = "tuning"
"""Name of the trial whose flights the tuner flies: seeds follow from it, and differ from those of
the comparison's.
"""

_NEEDS = {TRACKING: ON_OSCILLATION, STANDOFF: ON_CIRCLE}
_MISSIONS = {TRACKING: "follow", STANDOFF: "standoff"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Entrant:
    """A law in a task.

    Attributes
    ----------
    name : of the entrant, part of the names of its flights
    law, task : its steering law, and ``TRACKING`` or ``STANDOFF``
    inputs : the data of the reference and of the air that the law uses
    defaults : its parameters that are numbers, whole ones apart, by their keys in ``[guidance]``
    """

    name: str
    law: str
    task: str
    inputs: str
    defaults: Mapping[str, float]

    def values(self, parameters: Mapping[str, float]) -> dict[str, object]:
        """Return the keys to set for its flights, with these parameters."""
        chosen = {f"guidance.{key}": value for key, value in parameters.items()}
        return {"guidance.mission": _MISSIONS[self.task], "guidance.law": self.law, **chosen}


@dataclass(frozen=True, slots=True, kw_only=True)
class Refused:
    """A law that does not take part in a task.

    Attributes
    ----------
    law, task : same as ``Entrant``
    reason : why it does not take part
    """

    law: str
    task: str
    reason: str


def entrants_of(scenario: Scenario) -> tuple[list[Entrant], list[Refused]]:
    """Return the entrants, and the laws that do not take part in a task.

    An added law takes part in each task. The laws of the scenario take part in the tasks for which
    it lists them; for a law that tracks the reference and cannot circle, or vice versa, the result
    has the reason.

    Raises
    ------
    InputError : a law does not exist, or is named twice for a task, or no law takes part
    """
    arena, added = ArenaKeys.of(scenario).arena, ArenaKeys.of(scenario).laws
    listed = {TRACKING: [*arena.tracking, *added], STANDOFF: [*arena.standoff, *added]}
    entrants: list[Entrant] = []
    refused: list[Refused] = []
    for law in dict.fromkeys([*listed[TRACKING], *listed[STANDOFF]]):
        try:
            reasons = {task: law_refusal(law, need) for task, need in _NEEDS.items()}
            defaults = _defaults(law, scenario.guidance)
        except PluginError as error:
            raise InputError(f"laws: {error}") from None
        for task, laws in listed.items():
            if laws.count(law) > 1:
                raise InputError(
                    f"laws: '{law}' is named {laws.count(law)} times for {task}; laws adds to"
                    f" arena.{task}: name each law once"
                )
            if reasons[task]:
                refused.append(Refused(law=law, task=task, reason=reasons[task]))
            elif law in laws:
                inputs = getattr(
                    STEERING_LAWS.get(law), "inputs", "its class does not say (inputs)"
                )
                entrants.append(
                    Entrant(
                        name=_name(law, task),
                        law=law,
                        task=task,
                        inputs=str(inputs),
                        defaults=defaults,
                    )
                )
    names = [entrant.name for entrant in entrants]
    for name in names:
        if names.count(name) > 1:
            raise InputError(
                f"laws: two are called '{name}'; give files or classes names of their own"
            )
    if not entrants:
        raise InputError(
            "no law takes part; name some in arena.tracking, arena.standoff or laws, as in"
            ' laws=["npfg"]'
        )
    entrants.sort(key=lambda entrant: entrant.task != TRACKING)
    return entrants, refused


def conditions_of(scenario: Scenario, name: str, entrants: list[Entrant]) -> dict[str, Scenario]:
    """Return the trials of an arena: a scenario for each condition, with a case for each entrant at
    its default parameters.

    Raises
    ------
    InputError : there is no condition, or one sets a key that does not exist or a value out of
        range
    """
    conditions = ArenaKeys.of(scenario).arena.conditions
    if not conditions:
        raise InputError(
            "arena.conditions is empty; give one at least, as in [[arena.conditions]]"
            ' name = "calm", title = "Calm"'
        )
    trials = {}
    for condition in conditions:
        if condition.name in trials:
            raise InputError(
                f"arena.conditions: two are called '{condition.name}'; give each a name of its own"
            )
        if condition.name == TUNING:
            raise InputError(
                f"arena.conditions: '{TUNING}' is what the tuner's flights are called; give it"
                " another name"
            )
        bare = {
            "study": "flights",
            "title": condition.title,
            "arena": {},
            "laws": (),
            "cases": cases_of(entrants, {}),
            "flight.measured_s": ArenaKeys.of(scenario).arena.window_s,
        }
        try:
            trials[condition.name] = with_values(
                scenario, {**draws_left(scenario, condition.set), **condition.set, **bare}
            )
        except InputError as error:
            raise InputError(f"condition '{condition.name}' of '{name}': {error}") from None
    return trials


def draws_left(scenario: Scenario, values: Mapping[str, object]) -> dict[str, object]:
    """Return the arena's random variables as a value to set, without variables whose keys are set
    otherwise.
    """
    left = tuple(draw.model_dump() for draw in scenario.draws if not displaced(draw.key, values))
    return {} if len(left) == len(scenario.draws) else {"draws": left}


def cases_of(
    entrants: list[Entrant], chosen: Mapping[str, Mapping[str, float]]
) -> tuple[dict[str, Any], ...]:
    """Return a case for each entrant, with the chosen parameters of the entrant, by its name."""
    return tuple(
        {"name": entrant.name, "set": entrant.values(chosen.get(entrant.name, {}))}
        for entrant in entrants
    )


def _defaults(law: str, guidance: GuidanceConfig) -> dict[str, float]:
    """Return those parameters of a law that are real numbers but not whole ones: the values of the
    scenario, or else the law's defaults.
    """
    of = GuidanceConfig(law=law)
    types = of.law_types
    numbers = {
        key: value
        for key, value in of.law_keys.items()
        if type(value) in (int, float) and types[key] is not int
    }
    return {key: float(getattr(guidance, key, value)) for key, value in numbers.items()}


def _name(law: str, task: str) -> str:
    name = law.rpartition(":")[2] if is_file_part(law) else law
    plain = "".join(c if c.isascii() and c.isalnum() else "_" for c in name.lower())
    return plain if task == TRACKING else f"{plain}_{STANDOFF}"
