"""The manifest of a run: configuration, software and parameters."""

import hashlib
import json
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from typing import Any

from pydantic import BaseModel
from pydantic_core import to_jsonable_python

from aircraft.fleet.find import find_spec
from aircraft.model import model_hash
from aircraft.spec import AircraftError
from common.errors import PluginError
from common.provenance import provenance
from common.registry import file_hash, file_of
from common.run_layout import FORMAT, LOGO
from gnc.mission.mission import Mode
from measurement.emission import Ship
from measurement.gases import UNITS
from measurement.sniffer.channel import Channel
from measurement.sniffer.spec import SnifferSpec
from scenarios.engine.run_directory import RunDirectory, fingerprint
from scenarios.errors import InputError
from scenarios.experiment.sampling import (
    flights_per_sample,
    is_random_sample,
    random_numbers_of_points,
)
from scenarios.planning.scaling import scaled_keys
from scenarios.planning.theory import theory_over_speed_ratio
from scenarios.scenario.documentation import (
    DIMENSIONLESS,
    DocumentedKey,
    described_fields,
    documented_part_keys,
)
from scenarios.scenario.effect import differing, sections_of, unused
from scenarios.scenario.errors import line, split_unit
from scenarios.scenario.files import AnyStudy
from scenarios.scenario.parts import names_file, names_folder, part_names
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.guidance import GuidanceConfig
from scenarios.scenario.sections.part_section import PartSection
from scenarios.scenario.sections.report import ReportConfig, read_logo, report_entry
from scenarios.world.ais.reports import AisReports
from scenarios.world.ais.track import AisVessel
from scenarios.world.wind import TabledWind, wind_file
from scenarios.world.world import place_of, vessel_of

_HASH_LENGTH = 16
"""Digits of the hash of an aircraft's files, as many as ``file_hash`` has."""


def initial_manifest(scenario: AnyStudy, name: str, overrides: Sequence[str]) -> dict[str, Any]:
    """Return the manifest as written before the first flight.

    Parameters
    ----------
    scenario, name : the scenario and its name
    overrides : overrides that were applied to the scenario

    Raises
    ------
    InputError : the logo of the reports is not a picture
    """
    config = flown_config(scenario)
    return {
        "format": FORMAT,
        "study": config["study"],
        "name": name,
        "title": config["title"],
        "overrides": list(overrides),
        "config": config,
        "config_hash": config_hash(scenario),
        "fingerprint": fingerprint(),
        "parameters": parameters(scenario),
        "report": report_entry(scenario.report),
        **provenance(),
    }


def trial_entries(
    trials: Mapping[str, Scenario], *, as_read: Mapping[str, Scenario]
) -> dict[str, Any]:
    """Return the manifest's entries on the trials of a study of flights.

    Parameters
    ----------
    trials : trials that are flown, by name
    as_read : the trials before they were scaled to an aircraft; empty if they were not
    """

    def of_each(entry: Callable[[Scenario], object]) -> dict[str, object]:
        return {trial: entry(scenario) for trial, scenario in trials.items()}

    return {
        "modes": [mode.value for mode in Mode],
        "trial_parameters": of_each(parameters),
        "unused_parameters": of_each(unused_parameters),
        "scaled_parameters": {trial: scaled_keys(of) for trial, of in as_read.items()},
        "sampled_at_random": of_each(is_random_sample),
        "flights_per_sample": of_each(flights_per_sample),
        "random_numbers_of_points": of_each(random_numbers_of_points),
        "theory": of_each(theory_over_speed_ratio),
    }


def flown_config(scenario: BaseModel) -> dict[str, Any]:
    """Return the configuration of the flights, without the section of the reports."""
    return scenario.model_dump(mode="json", exclude={"report"})


def write_logo(report: ReportConfig, run: RunDirectory) -> None:
    """Write the logo into the run directory, from which reports read it.

    Raises
    ------
    InputError : it is not a picture
    """
    if logo := read_logo(report):
        run.write_bytes(f"{LOGO}{logo.suffix}", logo.content)


def plugins(scenarios: Iterable[Scenario]) -> dict[str, str]:
    """Return, by part, a hash of its file, or of the files of an aircraft. A resumed run and a
    replay need the same files.

    Raises
    ------
    InputError : a file or an aircraft cannot be read
    """
    found = {}
    for key, name in dict.fromkeys(
        named for scenario in scenarios for named in part_names(scenario)
    ):
        try:
            if names_folder(key, name):
                found[name] = model_hash(find_spec(name).files)[:_HASH_LENGTH]
            elif names_file(name):
                found[name] = file_hash(name)
        except (AircraftError, PluginError) as error:
            raise InputError(f"{key}: {error}") from None
    return found


def refuse_changed(then: Mapping[str, str], now: Mapping[str, str]) -> None:
    """Refuse to continue a run whose parts have changed, before an autopilot is designed for them.

    Parameters
    ----------
    then, now : results of ``plugins`` at the start of the run, and now

    Raises
    ------
    InputError : a part has changed, or was not there
    """
    for name, digest in now.items():
        if then.get(name) != digest:
            raise InputError(
                f"'{file_of(name)}' has changed since the run; use it as it was then, or start a"
                " new run"
            )


def vessel_files(scenarios: Iterable[Scenario]) -> dict[str, AisReports]:
    """Return the reports in each file that the vessels of scenarios take their tracks from, by its
    path and the vessel's MMSI.
    """
    found = (vessel_of(scenario) for scenario in scenarios if scenario.vessel.from_file)
    return {f"{v.source.path} {v.source.mmsi}": v.source for v in found if isinstance(v, AisVessel)}


def wind_files(scenarios: Iterable[Scenario]) -> dict[str, TabledWind]:
    """Return the wind in each file that scenarios take it from, by its path; of netCDF that at the
    first place.
    """
    found: dict[str, TabledWind] = {}
    for scenario in scenarios:
        name = scenario.wind.table
        if name is not None and name not in found:
            place = place_of(scenario, vessel_of(scenario))
            found[name] = wind_file(name, place, scenario.table.of("wind.table", name))
    return found


def config_hash(
    *scenarios: BaseModel, files: Mapping[str, str] | None = None, names: Sequence[str] = ()
) -> str:
    """Return a hash of scenarios, of their names if seeds depend on these, and of the files of
    their parts.
    """
    documents: list[object] = [flown_config(scenario) for scenario in scenarios]
    text = "\n".join(
        json.dumps(document, sort_keys=True)
        for document in [*documents, *([files] if files else []), *names]
    )
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def parameters(scenario: BaseModel) -> list[dict[str, Any]]:
    """Return every key of the scenario's sections that acts, with value, default if any, meaning
    and unit.
    """
    listed = [of for of in _of_sections(scenario) if not _is_unused(scenario, of)]
    listed = [each for of in listed for each in (of, *_of_own_table(of))]
    return [*listed, *_varied_of_parts(scenario, {of["key"] for of in listed})]


def unused_parameters(scenario: BaseModel) -> list[dict[str, Any]]:
    """Return the same for keys without an effect whose values differ from the defaults, because
    they were scaled to an aircraft.
    """
    return [
        of
        for of in _of_sections(scenario)
        if _is_unused(scenario, of) and of["value"] != of.get("default")
    ]


def _is_unused(scenario: BaseModel, parameter: Mapping[str, Any]) -> bool:
    return isinstance(scenario, Scenario) and bool(unused(scenario, parameter["key"]))


def _of_sections(scenario: BaseModel) -> list[dict[str, Any]]:
    """Return every key of the scenario's sections and of the parts that they name."""
    listed: list[dict[str, Any]] = []
    for section_name in type(scenario).model_fields:
        if section_name in ("comparison", "sweep", "report"):
            continue
        for name, section in sections_of(scenario, section_name):
            listed += _of_section(name, section)
    return listed


def _of_section(name: str, section: BaseModel) -> list[dict[str, Any]]:
    """Return every key of a section, and of the parts that it names."""
    listed: list[dict[str, Any]] = []
    values = section.model_dump(mode="json")
    for key, field in type(section).model_fields.items():
        meaning, unit = split_unit(line(field.description or ""))
        parameter = {
            "key": f"{name}.{key}",
            "value": values[key],
            "unit": unit.replace(DIMENSIONLESS, ""),
            "meaning": meaning,
        }
        if not field.is_required():
            parameter["default"] = to_jsonable_python(field.get_default(call_default_factory=True))
        listed.append(parameter)
    listed += _of_parts(name, section)
    return listed


def _varied_of_parts(scenario: BaseModel, listed: Collection[str]) -> list[dict[str, Any]]:
    """Return, with their defaults, the keys of parts that are swept or sampled, and the keys of
    laws of some flights, that are not set elsewhere.
    """
    if not isinstance(scenario, Scenario):
        return []
    varied = dict.fromkeys([*scenario.sweep.root, *(draw.key for draw in scenario.draws)])
    found = (
        known[0]
        for key in varied
        if key != "nu" and key not in listed and (known := _documented(key))
    )
    brought = [
        {"key": of.key, "value": of.default, "default": of.default, **_about(of)} for of in found
    ]
    for law in dict.fromkeys(
        values["guidance.law"]
        for values in differing(scenario)
        if isinstance(values.get("guidance.law"), str)
    ):
        of_law = _of_parts("guidance", scenario.guidance.model_copy(update={"law": law}))
        brought += [
            of for of in of_law if of["key"] not in {*listed, *(known["key"] for known in brought)}
        ]
    return brought


def _of_parts(name: str, section: BaseModel) -> list[dict[str, Any]]:
    """Return the keys of the parts that a section names, set or not: they describe the instrument,
    law or plume of the flights.
    """
    brought: dict[str, Any] = {}
    if isinstance(section, PartSection):
        brought = section.part_keys
    elif isinstance(section, GuidanceConfig):
        brought = {
            key: default
            for key, default in section.law_keys.items()
            if key not in type(section).model_fields
        }
    given, found = section.model_extra or {}, []
    for key, default in brought.items():
        known = _documented(f"{name}.{key}")
        # Parts may have keys of the same name.
        about = (
            _about(next((of for of in known if of.default == default), known[0]))
            if known
            else _OF_ONE_OF_A_USERS_OWN
        )
        value, plain = (
            to_jsonable_python(of, fallback=repr) for of in (given.get(key, default), default)
        )
        found.append({"key": f"{name}.{key}", "value": value, "default": plain, **about})
    return found


def _of_own_table(parameter: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield the keys of a ship or a sniffer of a user's own, if a parameter is one, with their
    units.
    """
    key, table = str(parameter["key"]), parameter["value"]
    if key not in _OWN_TABLES or not isinstance(table, Mapping):
        return
    yield from _fields(
        key, {name: value for name, value in table.items() if name != "channels"}, _OWN_TABLES[key]
    )
    for gas, channel in table.get("channels", {}).items():
        yield from _fields(f"{key}.channels.{gas}", channel, Channel, UNITS[gas])


def _fields(
    key: str, table: Mapping[str, Any], made: type[Any], gas_unit: str = ""
) -> Iterator[dict[str, Any]]:
    """Yield the keys of a table, which are fields of a class; ``gas_unit`` is what its docstring
    calls "unit".
    """
    known = described_fields(made)
    for name, value in table.items():
        meaning, unit = known[name]
        yield {
            "key": f"{key}.{name}",
            "value": value,
            "unit": unit.replace("unit", gas_unit),
            "meaning": meaning,
        }


_OWN_TABLES: dict[str, type[Any]] = {"emission.ship": Ship, "payload.sensor": SnifferSpec}
"""Keys that may be a table of a user's own, and the classes whose fields it has."""

_OF_ONE_OF_A_USERS_OWN = {"unit": "", "meaning": "Of a part that the section names"}
"""Unit and meaning of a key that is documented elsewhere."""


def _about(known: DocumentedKey) -> dict[str, str]:
    return {"unit": known.unit.replace(DIMENSIONLESS, ""), "meaning": known.meaning}


def _documented(key: str) -> list[DocumentedKey]:
    return [of for of in documented_part_keys() if of.key == key]
