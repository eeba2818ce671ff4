"""Checks of a study before its first flight."""

import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from aircraft.faults import fault_names
from aircraft.fleet.find import find_spec
from aircraft.spec import AircraftError, Envelope
from aircraft.weather import TURBULENCE, low_altitude_turbulence
from common.errors import PluginError
from common.faults import NO_FAULT
from common.files import is_data_file
from common.registry import Registry
from common.run_layout import NAME_BYTES_MAX, is_file_name
from common.text import did_you_mean
from gnc.errors import InfeasibleError
from gnc.reference.reference import REFERENCE_SHAPES
from scenarios.errors import InputError
from scenarios.experiment.draws import check_draws
from scenarios.experiment.requests import Experiment
from scenarios.flight.ending import failure
from scenarios.measures.own_instruments import check_instruments
from scenarios.planning.declared_vessel import check_declared
from scenarios.planning.limits import check_flyable, check_recorded
from scenarios.planning.plume import flown_altitudes, sniffer_on_board
from scenarios.scenario.extension_points import PAYLOADS, PLUME_MODELS, VESSEL_TRACKS
from scenarios.scenario.parts import names_file, part_names
from scenarios.scenario.scenario import Scenario
from scenarios.world.faults import NOT_OF_AIRCRAFT, OF_SNIFFER, SATELLITES, VESSEL_DATA
from scenarios.world.plume import Smoke, without_smoke
from scenarios.world.vessel import check_manoeuvres
from scenarios.world.world import mean_wind, vessel_of

PART_REGISTRIES: dict[str, Registry[Any]] = {
    "reference.shape": REFERENCE_SHAPES,
    "vessel.track": VESSEL_TRACKS,
    "plume.model": PLUME_MODELS,
    "payload": PAYLOADS,
    "payload.instruments": PAYLOADS,
}
"""Where the parts are found that neither the schema nor the design of the autopilot looks up."""


_SHOWN = 60
"""Letters of a name that a message shows at most."""


def check_flights(experiments: Iterable[Experiment], envelope: Envelope | None) -> None:
    """Check the flights of a study.

    Raises
    ------
    InputError : flights that differ in what the autopilot is designed for, an airspeed or a bank
        that the aircraft cannot fly, a fault that it cannot have, turbulence at an altitude for
        which it is not known, manoeuvres that overlap, a part that does not exist, a key that
        cannot be sampled
    """
    experiments = list(experiments)
    for experiment in experiments:
        _check_names(experiment)
    points = [point.scenario for experiment in experiments for point in experiment.points]
    if len({(s.aircraft, s.guidance.airspeed_mps, s.altitude) for s in points}) > 1:
        raise InputError(
            "flights differ in aircraft, guidance.airspeed_mps or the altitude at the start"
            " (flight.altitude_m, else plume.source_height_m, else the funnel of emission.ship);"
            " give each a run of its own"
        )
    for scenario in points:
        check_without_design(scenario)
        _check_vessel(scenario)
    for scenario in (setting for experiment in experiments for setting in experiment.steepest()):
        if envelope is not None and scenario.fidelity == "six_dof":
            check_flyable(scenario.guidance, find_spec(scenario.aircraft).title, envelope)
    for experiment in experiments:
        if experiment.scenario.draws:
            for point in experiment.points:
                with plugins_explained("a flight cannot be sampled", [point.scenario]):
                    check_draws(experiment.name, point.scenario, point.given)
                _check_margins(point.scenario)


def check_without_design(scenario: Scenario) -> None:
    """Check flights for errors that do not depend on the autopilot, so that the user sees them
    before its design, which takes time.

    Raises
    ------
    InputError : a part that does not exist, exhaust without smoke, a fault that it cannot have,
        turbulence at an altitude for which it is not known, limits of the altitude that leave no
        room, a record that is too seldom, files of a track or of wind that cannot be used
    """
    _check_parts(scenario)
    _check_sniffer(scenario)
    _check_record(scenario)
    _check_fault(scenario)
    _check_turbulence(scenario)
    _check_altitudes(scenario)
    if _vessel_known(scenario) and (scenario.vessel.from_file or scenario.wind.table is not None):
        mean_wind(scenario, vessel_of(scenario))


@contextmanager
def plugins_explained(what: str, scenarios: Iterable[Scenario]) -> Iterator[None]:
    """Turn an error that a part from a file raises before any flight into an InputError that begins
    with ``what``.
    """
    try:
        yield
    except InputError:
        raise
    # A part that ends the process must not end the command without a word.
    except (Exception, SystemExit) as error:
        own = any(names_file(name) for scenario in scenarios for _, name in part_names(scenario))
        if not own and not isinstance(error, PluginError):
            raise
        raise InputError(f"{what}: {failure(error)['message']}") from error


def _check_names(experiment: Experiment) -> None:
    """Refuse flights whose names cannot be part of file names."""
    for name in (experiment.name, *experiment.names()):
        if not is_file_name(name):
            raise InputError(
                f"a flight would be called {name[:_SHOWN]!r}, with {len(name)} letters; names"
                f" have up to {NAME_BYTES_MAX} bytes, all printable, without / and \\: call the"
                " scenario file otherwise, or sweep fewer keys at once"
            )


def _check_turbulence(scenario: Scenario) -> None:
    level = scenario.turbulence.level
    if level != "none" and scenario.fidelity == "six_dof":
        try:
            low_altitude_turbulence(scenario.altitude, TURBULENCE[level].wind_at_20ft)
        except AircraftError as error:
            raise InputError(
                f"turbulence.level is '{level}': {error}; fly lower (flight.altitude_m, else"
                " plume.source_height_m, else the funnel of emission.ship) or without"
            ) from None


def _check_margins(scenario: Scenario) -> None:
    """Refuse continuously sampled guidance where there may be turbulence, because margins are
    planned before it is sampled.
    """
    if scenario.fidelity == "kinematic":
        return
    levels = [draw.choice or () for draw in scenario.draws if draw.key == "turbulence.level"]
    if {scenario.turbulence.level, *(level for of in levels for level in of)} == {"none"}:
        return
    for draw in scenario.draws:
        if draw.choice is None and draw.key.startswith(("guidance.", "reference.")):
            raise InputError(
                f"'{draw.key}' is sampled from a continuous distribution beside turbulence, in"
                " which each value takes a margin of its own: give it a choice of values, as in"
                " choice = [0.5, 1.0], or set turbulence.level to 'none'"
            )


def _check_altitudes(scenario: Scenario) -> None:
    """Refuse limits of the altitude that leave no room in any flight. If only some flights have
    such limits, these flights fail by themselves.
    """
    deciding = ["flight.", "following.", "emission.ship", "turbulence.level"]
    deciding += ["plume.source_height_m"] if scenario.flight.altitude_m is None else []
    sampled = any(draw.key.startswith(tuple(deciding)) for draw in scenario.draws)
    if sampled or scenario.emission.ship is None or scenario.following.plume == "predicted":
        return
    try:
        flown_altitudes(scenario)
    except InfeasibleError as error:
        raise InputError(str(error)) from None


def _check_sniffer(scenario: Scenario) -> None:
    """Refuse a sniffer without SO2 if all flights end with a verdict. If only some flights have it,
    these flights fail by themselves.
    """
    if scenario.flight.until != "verdict" or "sniffer" not in scenario.payload.instruments:
        return
    if not any(draw.key.startswith(("payload.", "flight.until")) for draw in scenario.draws):
        spec = sniffer_on_board(scenario)
        if spec.channel("so2") is None:
            raise InputError(
                f"flight.until is 'verdict', but the channels of payload.sensor '{spec.name}' are"
                f" {', '.join(spec.gases)}, and so2, without which there is no verdict, is not"
                " among them: add the table payload.sensor.channels.so2"
            )


def _check_record(scenario: Scenario) -> None:
    """Refuse a rate of the record that is too low in every flight. If it is too low only in some,
    these flights fail by themselves.
    """
    if any(draw.key.startswith(("guidance.", "flight.", "kinematic.")) for draw in scenario.draws):
        return
    try:
        check_recorded(scenario)
    except InfeasibleError as error:
        raise InputError(str(error)) from None


def _check_fault(scenario: Scenario) -> None:
    kinds = scenario.declared_faults
    known = set(NOT_OF_AIRCRAFT)
    if scenario.fidelity == "six_dof" and kinds - known:
        known |= set(fault_names(find_spec(scenario.aircraft)))
    for kind in sorted(kinds - known):
        guess = did_you_mean(kind, known)
        raise InputError(
            f"{_where_named(scenario, kind)} '{kind}'{guess or ';'} what can fail is"
            f" {', '.join(sorted(known))}"
        )
    numbers = range(len(scenario.faults))
    for one, other in itertools.combinations(numbers, 2):
        _check_apart(scenario, one, other)


def _where_named(scenario: Scenario, kind: str) -> str:
    """Return the key that names a kind of fault, as the beginning of a sentence."""
    for number, fault in enumerate(scenario.faults):
        if kind in fault.declared:
            return f"{scenario.fault_key(number, 'declared')} has"
        if kind in scenario.kinds_of_fault(number):
            return f"{scenario.fault_key(number, 'kind')} is"
    raise ValueError(f"no fault is of the kind '{kind}'")


def _check_apart(scenario: Scenario, one: int, other: int) -> None:
    """Refuse two faults of the same item, by their numbers, if one may begin before the other
    has ended.
    """
    first, second = (_may_fail(scenario, number) for number in (one, other))
    for item in sorted(first.keys() & second.keys()):
        (begins, ends), (begins_other, ends_other) = first[item], second[item]
        if begins < ends_other and begins_other < ends:
            keys = " and ".join(scenario.fault_key(number, "at_s") for number in (one, other))
            raise InputError(
                f"{keys}: {item} may fail {_between(begins, ends)}, and again"
                f" {_between(begins_other, ends_other)}; let one of them end before the other"
                " begins, or leave one out"
            )


def _between(begins: float, ends: float) -> str:
    last = "the end of the flight" if ends == math.inf else f"{ends:g} s"
    return f"between {begins:g} s and {last}"


def _may_fail(scenario: Scenario, number: int) -> dict[str, tuple[float, float]]:
    """Return the items that may fail by a fault, each with its earliest beginning and latest end
    [s].
    """
    fault = scenario.faults[number]
    earliest, latest = _extremes(scenario, number, "at_s", fault.at_s)
    ends: dict[str, float] = {}
    for kind in scenario.kinds_of_fault(number) - {NO_FAULT}:
        lasts = math.inf
        if kind in (VESSEL_DATA, SATELLITES):
            name = f"{kind}_s"
            _, lasts = _extremes(scenario, number, name, (getattr(fault, name),))
        item = "the sniffer" if kind in OF_SNIFFER else f"'{kind}'"
        ends[item] = max(latest + lasts, ends.get(item, 0.0))
    return {item: (earliest, end) for item, end in ends.items()}


def _extremes(
    scenario: Scenario, number: int, name: str, own: Sequence[float]
) -> tuple[float, float]:
    """Return the least and the largest value of a key of a fault: the given value, or the limits of
    the sampled ones, infinite for a distribution without limits.
    """
    key = scenario.fault_key(number, name)
    draw = next((draw for draw in scenario.draws if draw.key == key), None)
    if draw is None:
        return min(own), max(own)
    known = draw.uniform or draw.within or draw.choice or ()
    values = [
        float(value)
        for of in known
        for value in (of if isinstance(of, list | tuple) else (of,))
        if isinstance(value, int | float)
    ]
    return min(values, default=0.0), max(values, default=math.inf)


def _check_vessel(scenario: Scenario) -> None:
    """Refuse manoeuvres that overlap, or exceed the declared limits, in every flight."""
    if not _vessel_known(scenario):
        return
    declared = not any(draw.key.startswith("following.") for draw in scenario.draws)
    try:
        check_manoeuvres(scenario.vessel, scenario.vessel_speed)
        if scenario.vessel.manoeuvres and declared:
            check_declared(scenario, vessel_of(scenario))
    except InfeasibleError as error:
        raise InputError(str(error)) from None


def _vessel_known(scenario: Scenario) -> bool:
    """Return whether neither the vessel nor the file of wind is sampled. If one is, a flight whose
    vessel or file cannot be used fails by itself.
    """
    return not any(draw.key.startswith(("vessel.", "wind.table")) for draw in scenario.draws)


def _check_parts(scenario: Scenario) -> None:
    sampled = any(draw.key.startswith("emission.") for draw in scenario.draws)
    if "sniffer" in scenario.payload.instruments and scenario.emission.ship is None and not sampled:
        raise InputError(
            "payload.instruments has a sniffer, and there is no exhaust: set emission.ship, or"
            " leave the sniffer out"
        )
    for key, name in part_names(scenario):
        try:
            if key in PART_REGISTRIES and not is_data_file(name):
                PART_REGISTRIES[key].get(name)
        except PluginError as error:
            raise InputError(f"{key}: {error}") from None
    # The vessel of any other callable is checked before its flight.
    classes = [of for of in scenario.payload.parts().items() if isinstance(of[1], type)]
    try:
        check_instruments(classes)
    except PluginError as error:
        raise InputError(str(error)) from None
    if (
        scenario.emission.ship is None
        or sampled
        or any(draw.key == "plume.model" for draw in scenario.draws)
    ):
        return
    model = PLUME_MODELS.get(scenario.plume.model)
    # Of what another callable makes it shows in planning.
    if isinstance(model, type) and not issubclass(model, Smoke):
        raise InputError(without_smoke(scenario))
