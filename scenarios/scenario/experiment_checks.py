"""Whether the parts of a scenario go together: mission and world, what is sampled, what a search
and subset simulation need.
"""

from collections.abc import Collection, Iterator

from pydantic import BaseModel

from common.text import at_or_below
from measurement.plume.spread import SOURCE_HEIGHT_MAX
from scenarios.scenario.added_keys import ADDED
from scenarios.scenario.scenario_keys import ScenarioKeys
from scenarios.scenario.sections.experiment import FLIGHTS_MAX, STUDY
from scenarios.scenario.sections.world import SOURCE_HEIGHT_MIN

DESIGNED_FOR = ("aircraft", "guidance.airspeed_mps", "flight.altitude_m")
"""Keys for which the autopilot is worked out once for a run: they cannot be sampled or swept."""

_DESIGN_HEIGHT = (
    "plume.source_height_m",
    "emission.ship",
    "flight.altitude_min_m",
    "flight.altitude_max_m",
)
"""The same where the altitude at the start follows from them: without ``flight.altitude_m``, and
the second without the first.
"""


ONE_POINT = {
    "falsify": "it searches one point",
    **{keys.STUDY: keys.ONE_POINT for keys in ADDED if keys.ONE_POINT},
}
"""Studies of one point, and why."""


_WITHOUT_EFFECT = (
    "criteria.",
    "statistics.",
    "search.",
    "subset.",
    "comparison.",
    "sweep.",
    "cases.",
    *(name for keys in ADDED for name in keys.prefixes() if name.endswith(".")),
)
"""Sections on which no flight depends: to sweep or sample them would count the same flights several
times.
"""


_SWEPT_BESIDE_SECTIONS = ("flight_seed", "fidelity")
"""Keys outside of sections that may be swept, or are refused elsewhere."""


_SET_ANYWHERE = ("aircraft.", "fidelity.", "flight_seed.", "criteria.")
"""Keys outside of sections, and sections on which no flight depends, that may be set for some
flights, or are refused elsewhere; each with a dot behind it.
"""


_SET_IN = {
    "comparison": _SET_ANYWHERE,
    "case": (*_SET_ANYWHERE, "sweep.nu.", "speed_ratio."),
}
"""The same for each kind of table that sets keys."""

_SET_IN_ADDED = (*_SET_ANYWHERE, "draws.", "speed_ratio.")
"""The same for tables of sections that studies add."""


def check_together(scenario: ScenarioKeys) -> None:
    """Refuse a scenario whose parts do not go together."""
    check_mission(scenario)
    check_source(scenario)
    check_start_altitude(scenario)
    check_one_point(scenario)
    check_tables(scenario)
    if scenario.study == "falsify":
        check_search(scenario)
    if scenario.study == "monte_carlo" and scenario.method == "subset":
        check_subset(scenario)
    check_draws(scenario)


UNSTEADY = (
    "wind.speed_mps", "wind.table", "turbulence.", "emission.ship", "vessel.manoeuvres", "vessel.track", "reports.", "sensors.",
    "fault.kind",
)  # fmt: skip
"""Keys, or beginnings of keys, by which air and vessel are not steady and known."""


FOLLOWING = (
    "the mission that follows the vessel with estimates of vessel and wind; guidance.mission 'track' is in still air, beside a"
    " steady vessel: leave it out, or set it to 'follow'"
)
"""What uses these keys, and how to have it."""


def unsteady(scenario: ScenarioKeys) -> tuple[str, ...]:
    """Return the keys by which air or vessel of a scenario, of each flight or as they vary, are not
    steady and known.
    """
    varied = (*scenario.sweep.root, *(draw.key for draw in scenario.draws))
    return (*scenario.unsteady_keys, *(key for key in varied if key.startswith(UNSTEADY)))


def check_mission(scenario: ScenarioKeys) -> None:
    """Refuse what a mission in still air, beside a steady vessel, would leave out, wherever the
    scenario has either from.
    """
    if scenario.guidance.mission == "track" and (keys := unsteady(scenario)):
        raise ValueError(f"key '{keys[0]}' has no effect here: it is used by {FOLLOWING}")
    if scenario.stands_off and scenario.finds:
        needs = {
            "following.plume": (scenario.following.plume, "predicted"),
            "flight.until": (scenario.flight.until, "flown"),
        }
        needs = {key: values for key, values in needs.items() if values[0] != values[1]}
        given = " and ".join(f"{key} '{value}'" for key, (value, _) in needs.items())
        remedy = " and ".join(f"{key} to '{other}'" for key, (_, other) in needs.items())
        raise ValueError(
            f"guidance.mission is 'standoff' beside {given}; a circle about the vessel neither searches for exhaust nor ends with"
            f" a verdict: set {remedy}, or guidance.mission to 'follow'"
        )


def check_source(scenario: ScenarioKeys) -> None:
    """Refuse a funnel that is lower than any, or higher than the exhaust of the project's own plume
    may leave one.
    """
    if scenario.emission.ship is None:
        return
    height = scenario.source_height
    given = (
        "stack_height of emission.ship"
        if scenario.plume.source_height_m is None
        else "plume.source_height_m"
    )
    if height < SOURCE_HEIGHT_MIN:
        raise ValueError(
            f"{given} is {height:g} m; a plume begins at {SOURCE_HEIGHT_MIN:g} m at least: set plume.source_height_m"
        )
    if scenario.plume.model == "fluctuating" and height > SOURCE_HEIGHT_MAX:
        raise ValueError(
            f"{given} is {height:g} m beside emission.ship; exhaust of plume.model 'fluctuating' leaves a funnel at"
            f" {SOURCE_HEIGHT_MAX:g} m at most: lower it, or leave emission.ship out"
        )


def check_start_altitude(scenario: ScenarioKeys) -> None:
    """Refuse a start below or above the altitudes at which exhaust is crossed: it was flown outside
    of them until it got there.
    """
    flight, altitude = scenario.flight, scenario.flight.altitude_m
    if (
        scenario.emission.ship is None
        or altitude is None
        or flight.altitude_min_m <= altitude <= flight.altitude_max_m
    ):
        return
    side, limit = "above", "raise flight.altitude_max_m"
    if altitude < flight.altitude_min_m:
        side, limit = "below", "lower flight.altitude_min_m"
    raise ValueError(
        f"flight.altitude_m is {altitude:g} m, {side} the altitudes at which exhaust is crossed, flight.altitude_min_m to"
        f" altitude_max_m, {flight.altitude_min_m:g} to {flight.altitude_max_m:g} m: set it in between, or {limit}"
    )


def check_one_point(scenario: ScenarioKeys) -> None:
    """Refuse several points in a study of one."""
    if scenario.several_points and (why := ONE_POINT.get(scenario.study)):
        raise ValueError(
            f"study is '{scenario.study}' beside a sweep, cases, a comparison or two vehicles; {why}: remove them"
        )


def check_tables(scenario: ScenarioKeys) -> None:
    """Refuse comparisons that have the name of flights that count, and tables that set what no
    flight depends on.
    """
    apart = [of.name for of in scenario.comparison.variants] + [
        case.name for case in scenario.cases if case.comparison
    ]
    if STUDY in apart:
        raise ValueError(
            f"a comparison is called '{STUDY}', as flights that count are, and would count as they do; give it another name"
        )
    if twice := next((name for name in apart if apart.count(name) > 1), None):
        count = apart.count(twice)
        raise ValueError(
            f"{count} comparisons are called '{twice}', and would count as one; give each a name of its own"
        )
    for kind, name, keys in _tables_of(scenario):
        for key in keys:
            if _is_of_run(scenario, key) and not f"{key}.".startswith(
                _SET_IN.get(kind, _SET_IN_ADDED)
            ):
                raise ValueError(
                    f"{kind} '{name}' sets '{key}', on which its flights do not depend; set it for the whole scenario, and here"
                    " keys of flights, as wind.speed_mps"
                )


def _is_of_run(scenario: ScenarioKeys, key: str) -> bool:
    """Return whether a key is outside of sections, or of a section on which no flight depends."""
    outside = key in type(scenario).model_fields and not isinstance(
        getattr(scenario, key), BaseModel
    )
    return outside or f"{key}.".startswith(_WITHOUT_EFFECT)


def _tables_of(scenario: ScenarioKeys) -> Iterator[tuple[str, str, Collection[str]]]:
    """Yield the tables that set keys for some flights: the kind, the name, and the keys."""
    yield from (("case", case.name, {**case.set, **case.set_kinematic}) for case in scenario.cases)
    yield from (("comparison", of.name, of.set) for of in scenario.comparison.variants)
    for keys in ADDED:
        yield from keys.tables(scenario)


def check_subset(scenario: ScenarioKeys) -> None:
    """Refuse subset simulation of what is not one probability."""
    if not scenario.draws:
        raise ValueError(
            "method is 'subset' and draws is empty; give the random variables, or set method to 'plain'"
        )
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


def check_search(scenario: ScenarioKeys) -> None:
    """Refuse a search that has nothing to search over, or more flights than can be numbered."""
    if not scenario.draws:
        raise ValueError("draws is empty; give the keys to search over, each with its range")
    if (most := scenario.search.flights_max) * (1 + scenario.search.confirmations) > FLIGHTS_MAX:
        raise ValueError(
            f"search.population and search.generations make {most} flights, with search.confirmations of each numbered up to"
            f" {most * (1 + scenario.search.confirmations)}; the most is {FLIGHTS_MAX}: make one of them smaller"
        )


def check_draws(scenario: ScenarioKeys) -> None:
    """Refuse random variables that are given twice, or cannot vary from flight to flight."""
    keys = [draw.key for draw in scenario.draws]
    for key in keys:
        if keys.count(key) > 1:
            raise ValueError(f"draws has '{key}' {keys.count(key)} times; give a key once")
        if "." not in key and key != "flight_seed":
            raise ValueError(
                f"draws has '{key}', the same for all flights; give keys of sections, as in wind.speed_mps"
            )
        _check_varied("draws", key, known=type(scenario).model_fields)
        if key in map(swept_key, scenario.sweep.root):
            raise ValueError(f"'{key}' is in sweep and in draws; give it in one of them")
    if {"nu", swept_key("nu")} <= scenario.sweep.root.keys():
        raise ValueError(
            "sweep has 'nu' and 'vessel.speed_ratio', which are the same; give one of them"
        )
    for key in [*keys, *scenario.sweep.root]:
        if any(at_or_below(key, of) for of in DESIGNED_FOR):
            raise ValueError(f"'{key}' {_DESIGNED_ONCE} it: give each value a run of its own")
        if (
            key.startswith(_DESIGN_HEIGHT)
            and scenario.flight.altitude_m is None
            and not _height_given(scenario, key)
        ):
            raise ValueError(
                f"'{key}' {_DESIGNED_ONCE} the altitude at the start, which is the height of the funnel here: give"
                " flight.altitude_m, or each value a run of its own"
            )
    for key in scenario.sweep.root:
        _check_varied("sweep", key, known=type(scenario).model_fields)


_DESIGNED_ONCE = "varies from flight to flight; autopilot and margins are worked out once for"


def _height_given(scenario: ScenarioKeys, key: str) -> bool:
    """Return whether the funnel's height is given beside a key of the ship."""
    return key.startswith("emission.ship") and scenario.plume.source_height_m is not None


def swept_key(name: str) -> str:
    """Return the key that a sweep means by a name: ``nu`` stands for the speed ratio."""
    return "vessel.speed_ratio" if name == "nu" else name


def _check_varied(section: str, key: str, known: Collection[str]) -> None:
    """Refuse to sweep or sample a key that is the same for all flights; an unknown one, and the
    vehicle, are refused elsewhere.

    Parameters
    ----------
    section : sweep or draws
    key : as the section has it
    known : keys outside of sections, and sections
    """
    if key == "seed":
        raise ValueError(
            "sweep has 'seed', from which flights of one run take their seeds: every point would fly the same; sweep"
            " flight_seed instead, or set flights to the number of flights"
        )
    of_draws = section == "draws" and key.startswith("draws.")
    if (
        of_draws
        or key.startswith(_WITHOUT_EFFECT)
        or (key in known and key not in _SWEPT_BESIDE_SECTIONS)
    ):
        raise ValueError(
            f"{section} has '{key}', which sets nothing of a flight: the same flights would be flown and counted for each value;"
            " take keys that flights depend on, as wind.speed_mps, and give each value of this one a run of its own"
        )
