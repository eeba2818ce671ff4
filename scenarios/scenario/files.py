"""Find a scenario file, apply overrides and check it; an error is one line."""

import copy
import functools
import json
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from common.errors import PluginError
from common.files import is_file
from common.registry import announced, announced_folders, is_file_part
from common.run_layout import FLIGHTS, MANIFEST
from common.text import did_you_mean
from scenarios.errors import InputError
from scenarios.scenario.added_keys import ADDED, check_study, study_files
from scenarios.scenario.effect import reject_unused_keys
from scenarios.scenario.errors import explanation, shown
from scenarios.scenario.overrides import (
    Document,
    apply_override,
    extended,
    given_keys,
    parse_override,
    set_value,
    tabled,
)
from scenarios.scenario.parts import refuse_missing, with_absolute_files
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.experiment import TrialList
from scenarios.scenario.sections.report import read_logo
from scenarios.scenario.sections.section import Section
from scenarios.scenario.study_keys import StudyFile

Study = TypeVar("Study", bound=Section)

AnyStudy = Scenario | TrialList | StudyFile

KINDS: dict[str, type[Any]] = {
    "flights": Scenario,
    "paper": Scenario,
    "trials": TrialList,
    "monte_carlo": Scenario,
    "falsify": Scenario,
    "premises": Scenario,
    **{keys.STUDY: Scenario for keys in ADDED},
    **study_files(),
}
"""What a file may say of ``study``, and the scenario that it then holds."""

OPERATIONAL = "operational"
"""The base that scenarios of these studies extend which name none; with ``extends = false`` they
have none.
"""

OPERATIONAL_STUDIES = ("monte_carlo", "falsify")

CATALOG, BASES = Path(__file__).parents[1] / "catalog", "bases"
"""The directory of the catalog, whose folders hold a kind of scenario each, and the one of them
with bases. An installed package that is announced in the group ``plume_flight_study.catalog`` adds
the scenarios in its own folder ``catalog``.
"""


@functools.cache
def catalog() -> dict[str, Path]:
    """Return the scenarios of the project and of installed packages, by name."""
    added = [folder / CATALOG.name for folder in announced_folders("catalog").values()]
    files = [path for folder in added for path in folder.glob("*.toml")]
    files += [path for path in CATALOG.glob("*/*.toml") if path.parent.name != BASES]
    return {path.stem: path for path in sorted(files, key=lambda path: path.stem)}


def is_flight(name: str) -> bool:
    """Return whether ``name`` is that of a flight in a run directory: ``RUN_DIR/flights/ID``."""
    path = Path(name)
    return path.parent.name == FLIGHTS and is_file(path.parents[1] / MANIFEST)


def load_study(
    name: str | Document, overrides: Sequence[str] = (), *, refusing: bool = True
) -> AnyStudy:
    """Read a study by catalog name or file path, or take it from a document.

    Parameters
    ----------
    name : name in the catalog, path of a TOML file, or the content of such a file; paths in a
        content are relative to the current directory
    overrides : ``key=value`` with dotted keys and TOML values, e.g. ``guidance.preview=false``; a
        part's file, FILE.py:NAME, is relative to the current directory, in a scenario file to that
        file
    refusing : whether to refuse keys of the file and of overrides that no part of the flights uses

    Raises
    ------
    InputError : no such scenario, unreadable TOML, an unknown key, a value out of range, a key
        without effect, or a logo that is no picture
    """
    own, document = _given(name)
    try:
        alone: AnyStudy = checked(document, _kind(document))
    except InputError as error:
        of_file = isinstance(name, str) and name not in catalog()
        raise InputError(f"{name}: {error}" if of_file else str(error)) from None
    scenario = _overridden(alone, document, overrides) if overrides else alone
    if refusing and isinstance(alone, Scenario):
        # Keys of the file need an effect without the overrides: an override may replace one of
        # them.
        reject_unused_keys(alone, given_keys(own))
    if refusing and isinstance(scenario, Scenario):
        changed = {parse_override(override)[0] for override in overrides}
        before = alone if isinstance(alone, Scenario) else scenario
        reject_unused_keys(scenario, changed, overridden=before)
    read_logo(scenario.report)
    return scenario


def _overridden(alone: AnyStudy, document: Document, overrides: Sequence[str]) -> AnyStudy:
    """Return the scenario of a document with overrides. Sections without an override are taken from
    ``alone``, the scenario without overrides.
    """
    changed = _with_overrides(document, overrides)
    kind = _kind(changed)
    if kind is not type(alone):
        found: AnyStudy = checked(changed, kind)
        return found
    # An override takes its key out of the sweep, the cases and the draws.
    read = {"sweep", "cases", "draws", "set", *map(_section, overrides)}
    return _revised(alone, {name: value for name, value in changed.items() if name in read})


def _revised(scenario: Study, sections: Mapping[str, Any]) -> Study:
    """Return a scenario with some sections read again; the others are not read again, but all are
    checked together.
    """
    kept = {name: getattr(scenario, name) for name in scenario.model_fields_set}
    return checked(kept | dict(sections), type(scenario))


def load_document(name: str | Document, overrides: Sequence[str] = ()) -> Document:
    """Return the document that ``load_study`` checks: the scenario merged with the one that it
    extends and with the overrides.

    Raises
    ------
    InputError : no such scenario, unreadable TOML, or an override that cannot be applied
    """
    _, document = _given(name)
    return _with_overrides(document, overrides)


def _with_overrides(document: Document, overrides: Sequence[str]) -> Document:
    document = copy.deepcopy(document)
    if document.get("study") == "trials":
        own = [override for override in overrides if _section(override) in TrialList.model_fields]
        for_trials = [override for override in overrides if override not in own]
        _refuse_unknown({_section(override) for override in for_trials})
        given = document.get("set", [])
        if for_trials and isinstance(given, list):
            document["set"] = [*given, *for_trials]
        overrides = own
    parsed = []
    for key, value in map(parse_override, overrides):
        parsed.append((key, with_absolute_files(value, Path(), key)))
        refuse_missing(key, value, parsed[-1][1])
    kind = _kind(document | {key: value for key, value in parsed if key == "study"})
    for key, value in parsed:
        apply_override(document, key, value, kind)
    return document


def _refuse_unknown(sections: set[str]) -> None:
    """Refuse keys that belong neither to a list of trials nor to the scenario of a trial."""
    for section in sorted(sections - {*Scenario.model_fields, "nu"}):
        guess = did_you_mean(section, TrialList.model_fields) or did_you_mean(
            section, Scenario.model_fields
        )
        names = ", ".join(TrialList.model_fields)
        known = f"; known are {names}, and the keys of each trial's scenario"
        raise InputError(f"unknown key '{section}'{guess or known}")


def _section(override: str) -> str:
    """Return the first part of the key of an override."""
    return override.partition("=")[0].strip().partition(".")[0]


@functools.cache
def bases() -> dict[str, Path]:
    """Return the bases that scenarios may extend, by name."""
    return {path.stem: path for path in sorted((CATALOG / BASES).glob("*.toml"))}


def scenario_path(name: str, folder: Path | None = None, *, extended: bool = False) -> Path:
    """Return the path of a scenario file.

    Parameters
    ----------
    name : name in the catalog, or path of a TOML file
    folder : directory that a path is relative to; the current one if not given
    extended : whether the name may be that of a base

    Raises
    ------
    InputError : no such scenario
    """
    known = bases() | catalog() if extended else catalog()
    path = known.get(name, (folder or Path()) / name)
    if is_file(path):
        return path
    if is_file((path.parent if path.name == FLIGHTS else path) / MANIFEST):
        run = Path(name).parent if path.name == FLIGHTS else Path(name)
        raise InputError(
            f"'{run}' is a run, not a scenario; to replay one of its flights, give"
            f" {run / FLIGHTS}/ID"
        )
    guess = did_you_mean(Path(name).stem if name.endswith(".toml") else name, known)
    what = f"no scenario file '{name}'" if name.endswith(".toml") else f"unknown scenario '{name}'"
    raise InputError(
        f"{what}{guess or ';'} give the path of a TOML file or one of: {', '.join(known)}"
    )


def _given(scenario: str | Document) -> tuple[Document, Document]:
    """Return the document of a scenario alone, and merged with the scenario that it extends."""
    if not isinstance(scenario, str):
        own, base = _resolved(copy.deepcopy(scenario), Path(), "scenario")
        return own, own if base is None else extended(_base(base, Path(), "scenario", ()), own)
    own, base = _own(path := scenario_path(scenario))
    return own, own if base is None else extended(_base(base, path.parent, path, (path,)), own)


def _read(path: Path, extended_by: tuple[Path, ...] = ()) -> Document:
    """Return the document in a file, merged with the scenario that it extends."""
    if path.resolve() in [other.resolve() for other in extended_by]:
        circle = " -> ".join(other.name for other in (*extended_by, path))
        raise InputError(
            f"{extended_by[-1]}: extends goes in a circle: {circle}; remove one of them"
        )
    document, base = _own(path)
    return (
        document
        if base is None
        else extended(_base(base, path.parent, path, (*extended_by, path)), document)
    )


def _base(base: str, folder: Path, where: object, extended_by: tuple[Path, ...]) -> Document:
    """Return the document that a scenario of ``folder``, called ``where`` in errors, extends."""
    try:
        path = scenario_path(base, folder, extended=True)
    except InputError as error:
        raise InputError(f"{where}: extends: {error}") from None
    # A description may be wrong for a scenario that changes keys.
    return tabled(
        {key: value for key, value in _read(path, extended_by).items() if key != "description"}
    )


def _own(path: Path) -> tuple[Document, str | None]:
    """Return the document in a file alone, and the name of the scenario that it extends, if any."""
    try:
        # An editor may have put a byte order mark before the text.
        given = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except ValueError as error:
        raise InputError(f"{path}: not valid TOML: {error}; fix the file") from None
    except OSError as error:
        raise InputError(
            f"{path}: cannot be read: {error.strerror}; check the path and its permissions"
        ) from None
    return _resolved(given, path.parent, path)


def _resolved(given: Document, folder: Path, where: object) -> tuple[Document, str | None]:
    """Return a document with absolute paths and the present names of keys, and the name of the
    scenario that it extends, if any.
    """
    document: Document = with_absolute_files(given, folder)
    if isinstance(listed := document.get("set"), list):
        document["set"] = [_with_absolute_file(override, folder) for override in listed]
    study = document.get("study")
    base = document.pop("extends", OPERATIONAL if study in OPERATIONAL_STUDIES else None)
    if not (base is None or base is False or isinstance(base, str)):
        raise InputError(
            f"{where}: extends is {shown(base)}; give one catalog name or one path of a TOML file,"
            " or false for no base"
        )
    return document, None if base is False else base


def _with_absolute_file(override: object, folder: Path) -> object:
    """Return an override of a list of trials in which the files of parts have absolute paths."""
    if not isinstance(override, str) or "=" not in override:
        return override
    key, value = parse_override(override)
    absolute = with_absolute_files(value, folder, key)
    # Names and lists of names are written in JSON as in TOML.
    return override if absolute == value else f"{key}={json.dumps(absolute)}"


def _kind(document: Document) -> type[Any]:
    """Return the schema of a document."""
    study = document.get("study", "flights")
    if not isinstance(study, str):
        raise InputError(f"study is {shown(study)}; it must be one of {', '.join(KINDS)}")
    try:
        check_study(study)
    except PluginError as error:
        raise InputError(str(error)) from None
    if study in KINDS or is_file_part(study) or study in announced("study"):
        return KINDS.get(study, Scenario)
    raise InputError(
        f"study is {shown(study)}{did_you_mean(study, KINDS) or ';'} it must be one of"
        f" {', '.join(KINDS)}, or FILE.py:NAME"
    )


def checked(document: Mapping[str, Any], kind: type[Study]) -> Study:
    """Return a scenario of some kind, or raise an InputError that names the key, its value and the
    limit.
    """
    try:
        return kind.model_validate(document)
    except ValidationError as error:
        raise InputError(explanation(error, kind)) from None


def sweeps_speed_ratio(document: Mapping[str, Any]) -> bool:
    """Return whether a document sets the speed ratio in its sweep or in its cases."""
    cases = [case.get("set") for case in document.get("cases", ()) if isinstance(case, dict)]
    return any(
        isinstance(of, dict) and ({"nu", "sweep.nu"} & of.keys())
        for of in (document.get("sweep"), *cases)
    )


def with_values(scenario: Scenario, values: Mapping[str, object]) -> Scenario:
    """Return the scenario with dotted keys set to new values, and their sections checked again."""
    if not values:
        return scenario
    if own := [key for key in values if key.partition(".")[0] == "report"]:
        raise InputError(
            f"'{own[0]}' varies from flight to flight; a report is of all flights: set it for the"
            " whole scenario"
        )
    sections = {key.partition(".")[0] for key in values} & type(scenario).model_fields.keys()
    document = scenario.model_dump(include=sections)
    if "guidance.law" in values:
        # Keys that only the former law has are removed with it.
        for key in scenario.guidance.keys_lost_with(values["guidance.law"]):
            del document["guidance"][key]
    for name in {"plume", "payload"} & sections:
        changed = {
            key.partition(".")[2]: value
            for key, value in values.items()
            if key.startswith(f"{name}.")
        }
        for key in getattr(scenario, name).keys_lost_with(changed):
            del document[name][key]
    for key, value in values.items():
        set_value(document, key, value, Scenario)
    return _revised(scenario, document)


def aircraft_from(directory: Path, name: str, overrides: Sequence[str]) -> list[str]:
    """Return overrides that take the aircraft from ``directory``: that of ``--set aircraft=NAME``,
    else the scenario's if it is there, else the only one there.

    Parameters
    ----------
    directory : with folders of aircraft
    name : of the scenario
    overrides : of its keys

    Raises
    ------
    InputError : no such scenario, directory or aircraft, or several to choose from
    """
    from aircraft.fleet.find import folder_names

    keys = [parse_override(override) for override in overrides]
    demanded = next((str(value) for key, value in reversed(keys) if key == "aircraft"), None)
    if demanded is None:
        usual = load_document(name, overrides).get("aircraft")
        with _aircraft_errors():
            demanded = str(usual) if usual in folder_names(directory) else None
    path = folder_of(directory, demanded)
    return [
        *(of for of, (key, _) in zip(overrides, keys, strict=True) if key != "aircraft"),
        f"aircraft={json.dumps(path)}",
    ]


def folder_of(directory: Path, name: str | None) -> str:
    """Return the path of an aircraft in ``directory``: of the one called ``name``, or else of the
    only one.

    Raises
    ------
    InputError : there is none of this name, or there are several
    """
    from aircraft.fleet.find import folder_path

    with _aircraft_errors():
        return folder_path(directory, name)


@contextmanager
def _aircraft_errors() -> Iterator[None]:
    from aircraft.spec import AircraftError

    try:
        yield
    except AircraftError as error:
        raise InputError(str(error)) from None
