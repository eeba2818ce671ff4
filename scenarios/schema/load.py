"""Find a scenario file, apply overrides, and refuse what does not hold, in one line."""

import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from common.run_layout import FLIGHTS, MANIFEST
from scenarios.errors import InputError
from scenarios.schema.config import Scenario
from scenarios.schema.convergence import ConvergenceScenario
from scenarios.schema.monte_carlo_config import FalsifyScenario, MonteCarloScenario
from scenarios.schema.sea_config import SeaScenario, SeaTrial

Flown = TypeVar("Flown", Scenario, SeaScenario)
Study = TypeVar("Study", Scenario, ConvergenceScenario, SeaScenario, SeaTrial, MonteCarloScenario, FalsifyScenario)

AnyStudy = Scenario | ConvergenceScenario | SeaScenario | SeaTrial | MonteCarloScenario | FalsifyScenario

KINDS: dict[str, type[Any]] = {
    "flights": Scenario,
    "paper": Scenario,
    "convergence": ConvergenceScenario,
    "sea": SeaScenario,
    "sea_trial": SeaTrial,
    "monte_carlo": MonteCarloScenario,
    "falsify": FalsifyScenario,
}
"""What a file may say of ``study``, and the scenario that it then holds."""

_KEYS: dict[type, str] = {
    Scenario: "config",
    ConvergenceScenario: "convergence_config",
    MonteCarloScenario: "monte_carlo_config",
    FalsifyScenario: "monte_carlo_config",
}

CATALOG = Path(__file__).parents[1] / "catalog"


def catalog() -> dict[str, Path]:
    """Return the scenarios that come with the project, by name."""
    return {path.stem: path for path in sorted(CATALOG.glob("*.toml"))}


def is_flight(name: str) -> bool:
    """Return whether ``name`` is that of a flight in a run directory: ``RUN_DIR/flights/ID``."""
    path = Path(name)
    return path.parent.name == FLIGHTS and (path.parents[1] / MANIFEST).is_file()


def load_scenario(name: str, overrides: Sequence[str] = ()) -> Scenario:
    """Read a scenario of flights, as ``load_study`` does.

    Raises
    ------
    InputError : as there, or the file is a study of another kind
    """
    study = load_study(name, overrides)
    if not isinstance(study, Scenario):
        raise InputError(f"'{name}' is a study of {study.study}; give a scenario of flights")
    return study


def load_study(name: str, overrides: Sequence[str] = ()) -> AnyStudy:
    """Read a study by catalog name or file path.

    Parameters
    ----------
    name : name in the catalog, or path of a TOML file
    overrides : ``key=value`` with dotted keys and TOML values, e.g. ``guidance.preview=false``

    Raises
    ------
    InputError : no such scenario, unreadable TOML, an unknown key, or a value out of range
    """
    known = catalog()
    path = known.get(name, Path(name))
    if not path.is_file():
        what = (
            f"no scenario file '{name}'; check the path"
            if name.endswith(".toml")
            else f"unknown scenario '{name}'; give a TOML file"
        )
        raise InputError(f"{what} or name one of: {', '.join(known)}")
    try:
        document = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: not valid TOML: {error}; mend the file") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}; check the path and its permissions") from None
    if document.get("study") == "sea_trial":
        own = [override for override in overrides if override.partition("=")[0].strip() in SeaTrial.model_fields]
        for_trials = [override for override in overrides if override not in own]
        given = document.get("set", [])
        if for_trials and isinstance(given, list):
            document["set"] = [*given, *for_trials]
        overrides = own
    for override in overrides:
        key, value = _parse_override(override)
        _set(document, key, value)
        _take_from_cases(document, key)
        _take_from_draws(document, key)
    study = document.get("study", "flights")
    if not isinstance(study, str) or study not in KINDS:
        raise InputError(f"study is {study!r}; it must be one of {', '.join(KINDS)}")
    scenario: AnyStudy = checked(document, KINDS[study])
    return scenario


def checked(document: Mapping[str, Any], kind: type[Study]) -> Study:
    """Return a scenario of some kind, or raise an InputError that names the key, its value and the limit."""
    try:
        return kind.model_validate(document)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        more = len({entry["loc"] for entry in error.errors()}) - 1
        others = f" (and {more} more keys)" if more else ""
        keys = f"scenarios/{_KEYS.get(kind, 'sea_config')}.py"
        raise InputError(f"{_explain(key, first['type'], first['msg'], first.get('input'), keys)}{others}") from None


def with_values(scenario: Flown, values: Mapping[str, object]) -> Flown:
    """Return the scenario with dotted keys set to new values, checked again."""
    document = scenario.model_dump()
    for key, value in values.items():
        _set(document, key, value)
    return checked(document, type(scenario))


def _explain(key: str, kind: str, message: str, value: object, keys: str) -> str:
    if kind == "extra_forbidden":
        return f"unknown key '{key}'; check its spelling against {keys} or an example in scenarios/catalog"
    if kind == "missing":
        *parents, last = key.split(".")
        if last.isdigit():
            return f"{'.'.join(parents)} has too few values; give one more, as in [400, 800]"
        return f"key '{key}' is missing; add it to the scenario"
    text = message.removeprefix("Value error, ")
    where = f"{key}: " if key else ""
    if kind == "value_error":
        return f"{where}{text}"
    if kind == "tuple_type":
        return f"{where}value is {value!r}; give a list in brackets, as in [0.5] or [400, 800]"
    return f"{where}value is {value!r}; {text[0].lower()}{text[1:]}"


def _take_from_cases(document: dict[str, Any], key: str) -> None:
    """Let an override have its way in every case: none sets that key otherwise."""
    cases = document.get("cases", [])
    for case in cases if isinstance(cases, list) else []:
        for values in (case.get("set"), case.get("set_kinematic")) if isinstance(case, dict) else ():
            if isinstance(values, dict):
                values.pop(key, None)


def _take_from_draws(document: dict[str, Any], key: str) -> None:
    """Let an override have its way in every flight: the key is no longer drawn."""
    draws = document.get("draws", [])
    if key != "draws" and isinstance(draws, list):
        document["draws"] = [draw for draw in draws if not (isinstance(draw, dict) and draw.get("key") == key)]
        if not draws and "draws" in document:
            del document["draws"]


def _parse_override(override: str) -> tuple[str, object]:
    key, equals, text = override.partition("=")
    if not equals or not key.strip():
        raise InputError(f"--set '{override}' is not of the form key=value, e.g. --set guidance.preview=false")
    try:
        value = tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError as error:
        if text.strip().startswith(("[", "{")):
            raise InputError(
                f"--set '{override}' is not valid TOML: {error}; words in a list are quoted: 'key=[\"word\"]'"
            ) from None
        value = text  # a bare word is a string
    return key.strip(), value


def _set(document: dict[str, Any], dotted: str, value: object) -> None:
    *parents, last = dotted.split(".")
    section: Any = document
    for parent in parents:
        section = _entered(section, parent, dotted)
    if isinstance(section, list):
        section[_place(section, last, dotted)] = value
    else:
        section[last] = value


def _entered(section: Any, name: str, dotted: str) -> Any:
    """Return what is called ``name`` in a section, made if there is none; or at that place of a list."""
    key: Any = _place(section, name, dotted) if isinstance(section, list) else name
    child = section[key] if isinstance(section, list) else section.setdefault(key, {})
    if isinstance(child, tuple):
        section[key] = child = list(child)
    if not isinstance(child, dict | list):
        raise InputError(f"unknown key '{dotted}'; '{name}' is a value, not a section")
    return child


def _place(entries: list[Any], name: str, dotted: str) -> int:
    if not (name.isdigit() and int(name) < len(entries)):
        raise InputError(f"unknown key '{dotted}'; '{name}' is no place in a list of {len(entries)}: they count from 0")
    return int(name)
