"""The points of an experiment, from its sweep, cases, comparisons and random variables."""

import itertools
import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from common.registry import is_file_part
from scenarios.errors import InputError
from scenarios.scenario.files import with_values
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.experiment import STUDY, CaseConfig, swept_key

Values = dict[str, object]


@dataclass(frozen=True, slots=True, kw_only=True)
class Point:
    """A point of an experiment: one flight, or several flights that differ only at random.

    Attributes
    ----------
    label : part of its flights' names; empty where there is one point alone
    variant : ``STUDY`` for flights that count, or the name of a comparison
    scenario : with the point's keys set, for one vehicle
    nu : speed ratio that is swept, or none [-]
    inputs : swept keys and their values
    flights : number of flights
    paired_point : for a point of a comparison, the number of the study's point with which it is
        compared; otherwise None
    given : keys that its case and its comparison set; they replace the draws of these keys
    stream : number of its random numbers, different for each point; 0 if points share them
    """

    label: str
    variant: str
    scenario: Scenario
    nu: float | None
    inputs: Values
    flights: int
    paired_point: int | None = None
    given: tuple[str, ...] = ()
    stream: int = 0


def points_of(scenario: Scenario) -> list[Point]:
    """Return the study's points and then those of the comparisons.

    Raises
    ------
    InputError : a case, a comparison or the sweep sets a key that does not exist or a value out of
        range
    """
    points = list(_cases(scenario) if scenario.cases else _grid(scenario))
    points.sort(key=lambda point: point.variant != STUDY)
    comparison = scenario.comparison
    for variant in comparison.variants:
        try:
            points += [
                _varied(point, variant.name, variant.set, comparison.flights, paired_point=i)
                for i, point in _compared(scenario, points)
            ]
        except InputError as error:
            raise InputError(
                f"comparison '{variant.name}': {error}; or fly no comparisons"
                " (comparison.variants=[])"
            ) from None
    return points


def _grid(scenario: Scenario) -> Iterator[Point]:
    sweep = scenario.sweep.root
    names = _names_of(sweep)
    for vehicle in _vehicles(scenario):
        for values in itertools.product(*map(without_repetitions, sweep.values())):
            at = dict(zip(sweep, values, strict=True))
            nu = scenario.sweep.nu[list(sweep["nu"]).index(at["nu"])] if "nu" in at else None
            labels = [_label(names[key], value) for key, value in at.items()] + (
                [vehicle] if scenario.fidelity == "both" else []
            )
            inputs = {swept_key(key): value for key, value in at.items()}
            changed = with_values(scenario, inputs | {"fidelity": vehicle})
            yield Point(
                label="_".join(labels),
                variant=STUDY,
                scenario=changed,
                nu=nu,
                inputs=inputs,
                flights=scenario.flights,
                stream=_stream(scenario, nu, inputs),
            )


def _stream(scenario: Scenario, nu: float | None, inputs: Values) -> int:
    """Return the number of a point's random numbers. It follows from the point's values only:
    adding a value to the sweep does not change it, and both vehicles have the same.

    If only speed ratios vary, with one flight each, the seeds follow from the speed ratios instead.
    """
    ratio_alone = nu is not None and len(inputs) == scenario.flights == 1 and not scenario.draws
    if not (scenario.own_random_numbers and inputs) or ratio_alone:
        return 0
    return zlib.crc32(repr(sorted((key, _same(value)) for key, value in inputs.items())).encode())


def _same(value: object) -> object:
    """Return a value in a form that is the same for equal values, such as 5 and 5.0."""
    return float(value) if isinstance(value, int) and not isinstance(value, bool) else value


def without_repetitions(values: Sequence[object]) -> list[object]:
    """Return the values without repetitions, by comparison: lists and tables may be swept, too, and
    5 equals 5.0.
    """
    return [value for i, value in enumerate(values) if value not in values[:i]]


def _cases(scenario: Scenario) -> Iterator[Point]:
    for case in scenario.cases:
        for vehicle in _vehicles(scenario):
            values = _values_of(case, vehicle)
            changed = _case(scenario, case, {**values, "fidelity": vehicle})
            yield Point(
                label=f"{case.name}_{vehicle}",
                variant=case.name if case.comparison else STUDY,
                scenario=changed,
                nu=None if changed.circles else changed.vessel.speed_ratio,
                inputs={},
                flights=scenario.flights,
                given=tuple(values),
            )


def _values_of(case: CaseConfig, vehicle: str) -> Values:
    """Return what a case sets in flights of a vehicle."""
    values = case.set | (case.set_kinematic if vehicle == "kinematic" else {})
    if "fidelity" in values:
        raise InputError(
            f"case '{case.name}' sets fidelity; set it for the whole scenario, or to 'both'"
        )
    if "sweep.nu" in values:
        ratios = values.pop("sweep.nu")
        if not isinstance(ratios, list | tuple) or len(ratios) != 1:
            raise InputError(
                f"case '{case.name}' has sweep.nu = {ratios!r}; give it one speed ratio, as in"
                " [0.5]"
            )
        values["vessel.speed_ratio"] = ratios[0]
    return values


def _case(scenario: Scenario, case: CaseConfig, values: Values) -> Scenario:
    try:
        return with_values(scenario, values)
    except InputError as error:
        raise InputError(f"case '{case.name}': {error}") from None


def _vehicles(scenario: Scenario) -> tuple[str, ...]:
    return ("kinematic", "six_dof") if scenario.fidelity == "both" else (scenario.fidelity,)


def _compared(scenario: Scenario, points: list[Point]) -> list[tuple[int, Point]]:
    """Return the study's points at which variants are flown, each with its number."""
    ratios = scenario.comparison.nu
    return [
        (i, point)
        for i, point in enumerate(points)
        if point.variant == STUDY and (not ratios or point.nu in ratios)
    ]


def _varied(
    point: Point, name: str, values: Values, flights: int | None, *, paired_point: int
) -> Point:
    return Point(
        label=f"{point.label}_{name}" if point.label else name,
        variant=name,
        scenario=with_values(point.scenario, values),
        nu=point.nu,
        inputs=point.inputs,
        flights=min(flights or point.flights, point.flights),
        paired_point=paired_point,
        given=(*point.given, *values),
        stream=point.stream,
    )


def _names_of(keys: Iterable[str]) -> dict[str, str]:
    """Return the short names of swept keys for the names of flights: the last part of each key, or
    as many parts as make it unique.
    """
    parts = {key: key.split(".") for key in keys}
    return {
        key: "_".join(own[-_parts_apart(own, [of for of in parts.values() if of is not own]) :])
        for key, own in parts.items()
    }


def _parts_apart(own: list[str], others: list[list[str]]) -> int:
    """Return the number of last parts that distinguish a key from others; the first of these parts
    is not the number of an entry.
    """
    apart = (
        n
        for n in range(1, len(own))
        if own[-n:] not in [of[-n:] for of in others] and not own[-n].isdecimal()
    )
    return next(apart, len(own))


def _label(name: str, value: object) -> str:
    if name == "nu":
        return f"nu_{value:.6f}".rstrip("0").ljust(len("nu_0.00"), "0")
    if isinstance(value, str) and is_file_part(value):
        value = value.rpartition(":")[2]
    if isinstance(value, Mapping):
        value = value.get("title", value)
    text = (
        f"{value:g}"
        if isinstance(value, int | float) and not isinstance(value, bool)
        else str(value)
    )
    return f"{name}_{''.join(c if c.isalnum() or c in '.-' else '_' for c in text)}"[:60]
