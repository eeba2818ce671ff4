"""Whether the parts of an experiment go together: what is sampled, and what a search and subset simulation need."""

from collections.abc import Collection
from typing import TYPE_CHECKING

from scenarios.schema.sections.experiment import FLIGHTS_MAX, STUDY

if TYPE_CHECKING:
    from scenarios.schema.scenario import Scenario

DESIGNED_FOR = ("aircraft", "guidance.airspeed_mps", "flight.altitude_m", "plume.source_height_m")
"""Keys for which the autopilot is worked out once for a run: they cannot be sampled or swept.

The last one can be where ``flight.altitude_m`` is given.
"""


ONE_POINT = {
    "falsify": "it searches one point",
    "arena": "what differs are the laws (laws) and the conditions (arena.conditions)",
    "patrol": "give each value a run of its own",
}
"""Studies of one point, and why."""


_WITHOUT_EFFECT = ("criteria.", "statistics.", "search.", "subset.", "arena.", "patrol.", "comparison.")
"""Sections on which no flight depends: to sweep them would count the same flights several times."""


_SWEPT_BESIDE_SECTIONS = ("flight_seed", "fidelity")
"""Keys outside of sections that may be swept, or are refused elsewhere."""


def check_one_point(scenario: "Scenario") -> None:
    """Refuse several points in a study of one."""
    if scenario.several_points and (why := ONE_POINT.get(scenario.study)):
        raise ValueError(f"study is '{scenario.study}' beside a sweep, cases, a comparison or two vehicles; {why}: remove them")


def check_names(scenario: "Scenario") -> None:
    """Refuse comparisons that have the name of flights that count."""
    apart = [*scenario.comparison.variants, *(case for case in scenario.cases if case.comparison)]
    if any(of.name == STUDY for of in apart):
        raise ValueError(
            f"a comparison is called '{STUDY}', as flights that count are, and would count as they do; give it another name"
        )


def check_subset(scenario: "Scenario") -> None:
    """Refuse subset simulation of what is not one probability."""
    if not scenario.draws:
        raise ValueError("method is 'subset' and draws is empty; give the random variables, or set method to 'plain'")
    if scenario.several_points:
        raise ValueError(
            "method is 'subset' beside a sweep, cases, a comparison or two vehicles; it estimates one probability: give each"
            " point a run of its own, or set method to 'plain'"
        )
    if scenario.statistics.stops:
        raise ValueError(
            "method is 'subset' beside statistics.violation_upper or statistics.distance_quantile_width_m, by which plain"
            " sampling stops; leave them out: subset simulation ends by itself, or after subset.levels_max levels"
        )


def check_search(scenario: "Scenario") -> None:
    """Refuse a search that has nothing to search over, or more flights than can be numbered."""
    if not scenario.draws:
        raise ValueError("draws is empty; give the keys to search over, each with its range")
    if (most := scenario.search.flights_max) * (1 + scenario.search.confirmations) > FLIGHTS_MAX:
        raise ValueError(
            f"search.population and search.generations make {most} flights, with search.confirmations of each numbered up to"
            f" {most * (1 + scenario.search.confirmations)}; the most is {FLIGHTS_MAX}: make one of them smaller"
        )


def check_draws(scenario: "Scenario") -> None:
    """Refuse random variables that are given twice, or cannot vary from flight to flight."""
    keys = [draw.key for draw in scenario.draws]
    for key in keys:
        if keys.count(key) > 1:
            raise ValueError(f"draws has '{key}' {keys.count(key)} times; give a key once")
        if "." not in key and key != "flight_seed":
            raise ValueError(f"draws has '{key}', the same for all flights; give keys of sections, as in wind.speed_mps")
        if key in scenario.sweep.root:
            raise ValueError(f"'{key}' is in sweep and in draws; give it in one of them")
    for key in [*keys, *scenario.sweep.root]:
        if key.startswith(DESIGNED_FOR if scenario.flight.altitude_m is None else DESIGNED_FOR[:-1]):
            raise ValueError(
                f"'{key}' varies from flight to flight; autopilot and margins are worked out once for it: give each value a run"
                " of its own"
            )
    for key in scenario.sweep.root:
        _check_swept(key, known=type(scenario).model_fields)


def _check_swept(key: str, known: Collection[str]) -> None:
    """Refuse to sweep a key that is the same for all flights; an unknown one, and the vehicle, have messages of their own."""
    if key == "seed":
        raise ValueError(
            "sweep has 'seed', from which flights of one run take their seeds: every point would fly the same; sweep"
            " flight_seed instead, or set flights to the number of flights"
        )
    if key.startswith(_WITHOUT_EFFECT) or (key in known and key not in _SWEPT_BESIDE_SECTIONS):
        raise ValueError(
            f"sweep has '{key}', which sets nothing of a flight: the same flights would be flown and counted for each value; sweep"
            " keys that flights depend on, as wind.speed_mps, and give each value of this one a run of its own"
        )
