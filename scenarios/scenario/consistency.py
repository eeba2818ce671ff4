"""Checks that the keys of a scenario agree: mission and world, the experiment, the sampled keys,
and the requirements of a search and of subset simulation.
"""

import math
from collections.abc import Callable, Collection, Iterator
from typing import TYPE_CHECKING

from pydantic import BaseModel

from common.faults import NO_FAULT
from common.text import at_or_below
from gnc.laws import ON_CIRCLE, ON_OSCILLATION
from measurement.plume.spread import SOURCE_HEIGHT_MAX
from scenarios.scenario.added_keys import ADDED
from scenarios.scenario.errors import may_stand_several_times, without_indices
from scenarios.scenario.sections.equipment import REPORTS_MAX
from scenarios.scenario.sections.experiment import FLIGHTS_MAX, SPEED_KEYS, STUDY, swept_key
from scenarios.scenario.sections.guidance import law_refusal
from scenarios.scenario.sections.needs import STEADY
from scenarios.scenario.sections.section import check_divides, check_ordered
from scenarios.scenario.sections.world import SOURCE_HEIGHT_MIN

if TYPE_CHECKING:
    from scenarios.scenario.scenario import Scenario

POINTS_MAX = 10_000
"""Most points of an experiment: all are checked before the first flight, in a millisecond and 20 kB
each.
"""

ONE_POINT = {
    "falsify": "it searches one point",
    **{keys.STUDY: keys.ONE_POINT for keys in ADDED if keys.ONE_POINT},
}
"""Studies of one point, and why."""

_DESIGNED_FOR = ("aircraft", "guidance.airspeed_mps", "flight.altitude_m")
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

_UNSTEADY = (
    "wind.speed_mps",
    "wind.table",
    "turbulence.",
    "emission.ship",
    "vessel.manoeuvres",
    "vessel.track",
    "traffic",
    "reports.",
    "sensors.",
    "fault.kind",
)
"""Keys, or beginnings of keys, by which air and vessel are not steady and known."""


def check_consistency(scenario: "Scenario") -> None:
    """Raise a ValueError where keys of a scenario contradict each other."""
    check_divides("flight.log_rate_hz", scenario.flight.log_rate_hz, scenario.guidance.rate_hz)
    check_ordered("speed_ratio", scenario.speed_ratio)
    for contradicts, words in _CONTRADICTIONS:
        if contradicts(scenario):
            raise ValueError(words.format(s=scenario))
    _check_law(scenario)
    _check_start(scenario)
    _check_duration(scenario)
    _check_exhaust(scenario)
    _check_experiment(scenario)
    _check_tables(scenario)
    _check_varied_keys(scenario)


_CONTRADICTIONS: tuple[tuple[Callable[["Scenario"], object], str], ...] = (
    (
        lambda s: s.circles and (s.follows or s.sweep.root or s.draws),
        "reference.path is 'circle' beside wind, a vessel that is followed, a sweep or draws; a"
        " circle has no vessel: set reference.path to 'oscillation', or put it into a case of its"
        " own",
    ),
    (
        lambda s: s.circles and s.criteria.required == "keep_out",
        "criteria.required is 'keep_out', and a circle has no area to keep out of; set it to"
        " 'criteria'",
    ),
    (
        lambda s: s.fidelity == "six_dof" and not s.guidance.command_limit,
        "guidance.command_limit is false; an aircraft cannot turn so fast: set fidelity to"
        " 'kinematic'",
    ),
    (
        lambda s: (
            not (s.guidance.command_limit or s.circles)
            and (s.guidance.keepout_guard or (s.guidance.approach and not s.follows))
        ),
        "guidance.command_limit is false; the way to the orbit and the keep-out guard turn within"
        " the limit alone: set guidance.approach and guidance.keepout_guard to false",
    ),
    (
        lambda s: s.fidelity == "kinematic" and not s.turbulence.calm,
        "turbulence.level or turbulence.gusts is set with fidelity 'kinematic', which feels the"
        " steady wind alone: set fidelity to 'six_dof'",
    ),
    (
        lambda s: s.vessel.from_file and {"nu", *SPEED_KEYS} & s.sweep.root.keys(),
        "sweep has the vessel's speed beside vessel.track, a file that it comes from; leave one of"
        " them out",
    ),
    (
        lambda s: s.stands_off and s.finds,
        "guidance.mission is 'standoff' with following.plume '{s.following.plume}' and flight.until"
        " '{s.flight.until}'; a circle about the vessel neither searches for exhaust nor ends with"
        " a verdict: set them to 'predicted' and 'flown'",
    ),
    (
        lambda s: s.study == "paper" and not s.cases,
        "study is 'paper' without cases; give it cases, or set study to 'flights'",
    ),
    (
        lambda s: s.study == "falsify" and not s.draws,
        "draws is empty; give the keys to search over, each with its range",
    ),
    (
        lambda s: _is_subset(s) and not s.draws,
        "method is 'subset' and draws is empty; give random variables, or set method to 'plain'",
    ),
    (
        lambda s: _is_subset(s) and s.several_points,
        "method is 'subset' beside a sweep, cases, a comparison or two vehicles; it estimates one"
        " probability: give each point a run of its own, or set method to 'plain'",
    ),
    (
        lambda s: _is_subset(s) and s.statistics.stops,
        "method is 'subset' beside statistics.violation_upper or"
        " statistics.distance_quantile_width_m, by which plain sampling stops; leave them out",
    ),
    (
        lambda s: {"nu", swept_key("nu")} <= s.sweep.root.keys(),
        "sweep has 'nu' and 'vessel.speed_ratio', which are the same; give one of them",
    ),
)
"""What contradicts what, and what is said of it, of the scenario ``s``."""


def _is_subset(scenario: "Scenario") -> bool:
    return scenario.study == "monte_carlo" and scenario.method == "subset"


def unsteady(scenario: "Scenario") -> tuple[str, ...]:
    """Return the keys that make air or vessel of a scenario unsteady or not exactly known, in all
    or in some of its flights.
    """
    varied = (*scenario.sweep.root, *(draw.key for draw in scenario.draws))
    unsteadying = (key for key in varied if without_indices(key).startswith(_UNSTEADY))
    return (*scenario.unsteady_keys, *unsteadying)


def _check_law(scenario: "Scenario") -> None:
    """Refuse a law that cannot do the task, and a mission in still air where there is wind."""
    law = scenario.guidance.law
    task = ON_CIRCLE if scenario.stands_off else ON_OSCILLATION
    if not scenario.circles and (reason := law_refusal(law, task)):
        raise ValueError(f"guidance.law is '{law}': {reason}")
    if scenario.guidance.mission == "track" and (keys := unsteady(scenario)):
        raise ValueError(f"key '{keys[0]}' has no effect here: it is used by {STEADY}")


def _check_start(scenario: "Scenario") -> None:
    """Refuse a start within the keep-out area."""
    start, radius = scenario.start, scenario.guarded_radius
    if scenario.circles:
        return
    if start.place_m is not None:
        nearest, where = math.hypot(*start.place_m), "start.place_m lies at"
    elif start.range_m is not None:
        nearest, where = start.range_m, "start.range_m is"
    elif _is_scaled_later(scenario) or any(d.key == "start.range_m" for d in scenario.draws):
        return
    else:
        nearest, where = start.distance_m[0], "start.distance_m begins at"
    if nearest <= radius:
        reach = radius - scenario.keepout.radius_m
        hull = f" and the {reach:g} m from the funnel to the end of the hull" if reach else ""
        raise ValueError(
            f"{where} {nearest:g} m; it must exceed keepout.radius_m,"
            f" {scenario.keepout.radius_m:g} m{hull}"
        )


def _is_scaled_later(scenario: "Scenario") -> bool:
    """Return whether the distance of the start is a default; it is checked after it has been scaled
    to the aircraft.
    """
    default = type(scenario).model_fields["aircraft"].default
    return scenario.aircraft != default and "distance_m" not in scenario.start.model_fields_set


def _check_duration(scenario: "Scenario") -> None:
    """Refuse a flight that is too short for its fault or gusts, or too long for its reports."""
    air, duration = scenario.turbulence, scenario.flight.duration_max_s
    for number, fault in enumerate(scenario.faults):
        if fault.kind != NO_FAULT and fault.at_s[1] >= duration:
            raise ValueError(
                f"{scenario.fault_key(number, 'at_s')} ends at {fault.at_s[1]:g} s; it must lie"
                f" within flight.duration_max_s, {duration:g} s"
            )
    if air.gusts * 2.0 * air.gust_length_s > 0.9 * duration:
        raise ValueError(
            f"turbulence.gusts is {air.gusts}, each {2.0 * air.gust_length_s:g} s long; they do not"
            f" fit into flight.duration_max_s, {duration:g} s"
        )
    interval = 0.5 * sum(scenario.reports.interval_s)
    if not scenario.reports.exact and duration > REPORTS_MAX * interval:
        raise ValueError(
            f"reports.interval_s is {list(scenario.reports.interval_s)} s; in"
            f" flight.duration_max_s, {duration:g} s, this makes more than {REPORTS_MAX} reports:"
            f" let at least {duration / REPORTS_MAX:.2g} s pass between them on average"
        )


def _check_exhaust(scenario: "Scenario") -> None:
    """Refuse a funnel whose height is out of range for the project's own plume, a start outside of
    the altitudes at which exhaust is crossed, and exhaust of another ship in a flight without a
    sniffer.
    """
    for number, ship in enumerate(scenario.traffic):
        if ship.emission is not None and "sniffer" not in scenario.payload.instruments:
            raise ValueError(
                f"traffic.{number}.emission is given, and nothing reads it: add a sniffer, by"
                " 'sniffer' in payload.instruments, or leave it out"
            )
    if scenario.emission.ship is None:
        return
    height, flight = scenario.source_height, scenario.flight
    own = scenario.plume.source_height_m is not None
    given = "plume.source_height_m" if own else "stack_height of emission.ship"
    highest = SOURCE_HEIGHT_MAX if scenario.plume.model == "fluctuating" else math.inf
    if not SOURCE_HEIGHT_MIN <= height <= highest:
        raise ValueError(
            f"{given} is {height:g} m; exhaust of plume.model '{scenario.plume.model}' leaves a"
            f" funnel at {SOURCE_HEIGHT_MIN:g} to {highest:g} m: set plume.source_height_m"
        )
    low, high = flight.altitude_min_m, flight.altitude_max_m
    if flight.altitude_m is not None and not low <= flight.altitude_m <= high:
        raise ValueError(
            f"flight.altitude_m is {flight.altitude_m:g} m; exhaust is crossed from"
            f" flight.altitude_min_m to altitude_max_m, {low:g} to {high:g} m"
        )


def _check_experiment(scenario: "Scenario") -> None:
    """Refuse too many points, and several points in a study that takes only one."""
    sweep = scenario.sweep.root
    if scenario.cases and sweep:
        raise ValueError(
            f"sweep has {', '.join(sweep)} beside {len(scenario.cases)} cases; give one of the two"
        )
    if (points := math.prod(map(len, sweep.values()))) > POINTS_MAX:
        raise ValueError(
            f"sweep has {points} points; the most is {POINTS_MAX}: give fewer values, or sample"
            " keys at random"
        )
    if scenario.several_points and (why := ONE_POINT.get(scenario.study)):
        raise ValueError(
            f"study is '{scenario.study}' beside a sweep, cases, a comparison or two vehicles;"
            f" {why}: remove them"
        )
    most = scenario.search.flights_max * (1 + scenario.search.confirmations)
    if scenario.study == "falsify" and most > FLIGHTS_MAX:
        raise ValueError(
            f"search.population, search.generations and search.confirmations make {most} flights;"
            f" the most is {FLIGHTS_MAX}"
        )


def _check_tables(scenario: "Scenario") -> None:
    """Refuse cases and comparisons whose flights would have the same names, and tables that set
    keys on which no flight depends.
    """
    cases = [case.name for case in scenario.cases]
    apart = [of.name for of in scenario.comparison.variants]
    apart += [case.name for case in scenario.cases if case.comparison]
    for kind, names in (("cases", cases), ("comparisons", [*apart, STUDY])):
        if twice := next((name for name in names if names.count(name) > 1), None):
            raise ValueError(
                f"{kind} are called {', '.join(names)}; '{twice}' is there {names.count(twice)}"
                " times: give each a name of its own"
            )
    for kind, name, keys in _tables_of(scenario):
        for key in keys:
            if _is_of_run(scenario, key) and not f"{key}.".startswith(
                _SET_IN.get(kind, _SET_IN_ADDED)
            ):
                raise ValueError(
                    f"{kind} '{name}' sets '{key}', on which its flights do not depend; set it for"
                    " the whole scenario"
                )


def _tables_of(scenario: "Scenario") -> Iterator[tuple[str, str, Collection[str]]]:
    """Yield the tables that set keys for some flights: the kind, the name, and the keys."""
    yield from (("case", case.name, {**case.set, **case.set_kinematic}) for case in scenario.cases)
    yield from (("comparison", of.name, of.set) for of in scenario.comparison.variants)
    for keys in ADDED:
        yield from keys.tables(scenario)


def _is_of_run(scenario: "Scenario", key: str) -> bool:
    """Return whether a key is outside of sections, or in a section on which no flight depends."""
    field = type(scenario).model_fields.get(key)
    if f"{key}.".startswith(_WITHOUT_EFFECT):
        return True
    return field is not None and not (
        isinstance(getattr(scenario, key), BaseModel) or may_stand_several_times(field)
    )


def _check_varied_keys(scenario: "Scenario") -> None:
    """Refuse keys that are sampled twice, or cannot be swept or sampled."""
    drawn = [draw.key for draw in scenario.draws]
    swept = [swept_key(name) for name in scenario.sweep.root]
    if twice := next((key for key in drawn if drawn.count(key) > 1), None):
        raise ValueError(f"draws has '{twice}' {drawn.count(twice)} times; give a key once")
    if both := next((key for key in drawn if key in swept), None):
        raise ValueError(f"'{both}' is in sweep and in draws; give it in one of them")
    for section, keys in (("draws", drawn), ("sweep", swept)):
        for key in keys:
            _check_varied(scenario, section, key)


_DESIGNED_ONCE = "varies from flight to flight; autopilot and margins are worked out once for"


def _check_varied(scenario: "Scenario", section: str, key: str) -> None:
    """Refuse to sweep or sample a key that is the same for all flights, or for which autopilot and
    margins are computed only once. Unknown keys, and the key of the vehicle, are refused elsewhere.
    """
    of_run = (
        key.startswith((*_WITHOUT_EFFECT, "draws.") if section == "draws" else _WITHOUT_EFFECT)
        or (key in type(scenario).model_fields and key not in _SWEPT_BESIDE_SECTIONS)
        or (section == "draws" and "." not in key and key != "flight_seed")
    )
    if any(at_or_below(key, of) for of in _DESIGNED_FOR):
        raise ValueError(f"'{key}' {_DESIGNED_ONCE} it: give each value a run of its own")
    if of_run:
        raise ValueError(
            f"{section} has '{key}', which sets nothing of a flight: the same flights would be"
            " flown and counted for each value; take keys that flights depend on, as"
            " wind.speed_mps or flight_seed"
        )
    ship_alone = key.startswith("emission.ship") and scenario.plume.source_height_m is not None
    if key.startswith(_DESIGN_HEIGHT) and scenario.flight.altitude_m is None and not ship_alone:
        raise ValueError(
            f"'{key}' {_DESIGNED_ONCE} the altitude at the start, which is the height of the"
            " funnel here: give flight.altitude_m, or each value a run of its own"
        )
