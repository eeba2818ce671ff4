"""Find an aircraft: a registered one, one that comes with JSBSim, or one in a user's folder.

A user's folder, ``DIR/NAME``, holds a JSBSim model and, if needed, a settings file.
"""

from pathlib import Path, PurePosixPath, PureWindowsPath

from aircraft.fleet import AIRCRAFT
from aircraft.fleet.from_model import ModelSettings, read_settings, spec_of_model
from aircraft.model import read_xml, stock_root
from aircraft.spec import (
    NAME,
    NAME_RULE,
    SHARED_FOLDERS,
    AircraftError,
    AircraftSpec,
    ModelFiles,
    check_spec,
)
from common.errors import PluginError
from common.files import is_path
from common.registry import is_file_part
from common.text import did_you_mean

_MODEL_TAG = "fdm_config"
"""Root element of a JSBSim model."""

_NOT_COPIED = ("input", "output")
"""Sections of a model that are left out of its copies."""


def aircraft_names() -> list[str]:
    """Names of all known aircraft, registered ones first; some of them cannot be flown."""
    registered = AIRCRAFT.names()
    return [*registered, *(name for name in stock_names() if name not in registered)]


def find_spec(name: str) -> AircraftSpec:
    """Spec of an aircraft by its known name, its file ``FILE.py:NAME`` or its folder ``DIR/NAME``.

    Raises
    ------
    AircraftError : the name is unknown, the aircraft does not load, or an autopilot cannot fly it
    """
    if is_file_part(name) or name in AIRCRAFT:
        return _registered(name)
    if name in stock_names():
        return stock_spec(name)
    if is_path(name):
        return folder_spec(name)
    guess = did_you_mean(name, aircraft_names()) or ";"
    raise AircraftError(
        f"unknown aircraft '{name}'{guess} `plume-flight design --list` lists the known ones, or"
        " give a folder as DIR/NAME, or a file as FILE.py:NAME"
    )


def _registered(name: str) -> AircraftSpec:
    try:
        spec = AIRCRAFT.get(name)
    except PluginError as error:
        raise AircraftError(str(error)) from error
    if not isinstance(spec, AircraftSpec):
        raise AircraftError(
            f"aircraft '{name}' is of type {type(spec).__name__}; it must be an AircraftSpec of"
            " aircraft/spec.py"
        )
    check_spec(spec)
    return spec


def stock_names() -> list[str]:
    """Names of JSBSim's own aircraft."""
    folder = stock_root() / "aircraft"
    return sorted(
        (entry.name for entry in folder.iterdir() if (entry / f"{entry.name}.xml").is_file()),
        key=str.lower,
    )


def stock_spec(name: str) -> AircraftSpec:
    """Spec of one of JSBSim's own aircraft.

    Raises
    ------
    AircraftError : the aircraft is not an aeroplane with engines and the usual controls
    """
    files = ModelFiles(model=name, folder=stock_root() / "aircraft" / name, roots=(stock_root(),))
    source = f"JSBSim's own model '{name}', gear up, fuel held, the model's autopilot off"
    return spec_of_model(files, name=name, source=source)


def folder_names(directory: Path) -> list[str]:
    """Names of the folders in ``directory`` that hold a model.

    Raises
    ------
    AircraftError : there is no such directory, or no aircraft in it
    """
    if not directory.is_dir():
        raise AircraftError(
            f"aircraft directory '{directory}': there is no such directory; check the path"
        )
    names = sorted(entry.name for entry in directory.iterdir() if entry.is_dir() and _models(entry))
    if not names:
        raise AircraftError(
            f"aircraft directory '{directory}' holds no aircraft; each needs a folder and a model,"
            " NAME/NAME.xml"
        )
    return names


def folder_path(directory: Path, name: str | None) -> str:
    """Path of the aircraft called ``name`` in ``directory``, or of the only one there.

    Raises
    ------
    AircraftError : there is no such directory, no such aircraft in it, or, without a name, more
        than one
    """
    names = folder_names(directory)
    if name is None and len(names) > 1:
        raise AircraftError(
            f"aircraft directory '{directory}' holds {len(names)} aircraft; name one of them:"
            f" {', '.join(names)}"
        )
    name = names[0] if name is None else name
    if name not in names:
        guess = did_you_mean(name, names) or ";"
        raise AircraftError(
            f"aircraft directory '{directory}' holds no aircraft '{name}'{guess} it has"
            f" {', '.join(names)}"
        )
    return str(directory.absolute() / name)


def folder_spec(path: str) -> AircraftSpec:
    """Spec of the aircraft in a folder, ``DIR/NAME``.

    The model is ``NAME.xml``, or the only JSBSim model in the folder. Its engines and systems are
    searched for in the folder, then in ``DIR/../engine`` and ``DIR/../systems``, then in JSBSim's
    own folders. Settings may stand in a file with the model's name, ``NAME.toml``.

    Raises
    ------
    AircraftError : the folder does not exist, or holds no model or several; a file is invalid; an
        autopilot cannot fly the aircraft
    """
    folder = Path(path).absolute()
    if not folder.is_dir():
        raise AircraftError(
            f"aircraft '{path}': there is no such directory; check the path, or name another with"
            " --aircraft-dir"
        )
    model = _only_model(folder)
    for name in (folder.name, model):
        if not NAME.fullmatch(name):
            raise AircraftError(f"aircraft '{path}': '{name}' is not a valid name; {NAME_RULE}")
    files = ModelFiles(model=model, folder=folder, roots=(folder.parent.parent, stock_root()))
    _check_files(files)
    settings = folder / f"{model}.toml"
    return spec_of_model(
        files,
        name=folder.name,
        source=f"the user's own model '{model}', gear up, fuel held, the model's autopilot off",
        settings=read_settings(settings) if settings.is_file() else ModelSettings(),
    )


def _models(folder: Path) -> list[str]:
    """Names of the models in a folder; only the one with the folder's name, if there is one."""
    if (folder / f"{folder.name}.xml").is_file():
        return [folder.name]
    return sorted(path.stem for path in folder.glob("*.xml") if path.is_file() and _is_model(path))


def _is_model(path: Path) -> bool:
    try:
        return read_xml(path).getroot().tag == _MODEL_TAG
    except AircraftError:
        return False


def _only_model(folder: Path) -> str:
    found = _models(folder)
    if not found:
        raise AircraftError(
            f"aircraft '{folder}' has no JSBSim model; put it there as {folder.name}.xml"
        )
    if len(found) > 1:
        listed = ", ".join(f"{name}.xml" for name in found)
        raise AircraftError(
            f"aircraft '{folder}' has {len(found)} models, {listed}; call one of them"
            f" {folder.name}.xml"
        )
    return found[0]


def _check_files(files: ModelFiles) -> None:
    """Refuse a model if a file of it is not XML, is missing, or leads out of its folders."""
    root = read_xml(files.file).getroot()
    if root.tag != _MODEL_TAG:
        raise AircraftError(
            f"{files.file}: its root element is <{root.tag}>; a JSBSim model has <{_MODEL_TAG}>"
        )
    checked: set[Path] = set()
    waiting = [files.file]
    while waiting:
        path = waiting.pop()
        if path in checked:
            continue
        checked.add(path)
        config = read_xml(path).getroot()
        required = [
            element for element in config if path == files.file and element.tag not in _NOT_COPIED
        ]
        for element in config.iter():
            file = element.get("file")
            if not file:
                continue
            _refuse_outside(path, element.tag, file)
            found = files.find(element)
            if found:
                waiting.append(found)
            elif element.tag in SHARED_FOLDERS or element in required:
                folders = [files.folder]
                if element.tag in SHARED_FOLDERS:
                    folders += [root / SHARED_FOLDERS[element.tag] for root in files.roots]
                listed = ", ".join(f"'{folder}'" for folder in folders)
                raise AircraftError(
                    f"{path}: {element.tag} file '{file}' is not in {listed}; put it there"
                )


def _refuse_outside(path: Path, tag: str, file: str) -> None:
    """Refuse a file name that is absolute or contains '..'."""
    for pure in (PurePosixPath(file), PureWindowsPath(file)):
        if pure.anchor or ".." in pure.parts:
            raise AircraftError(
                f"{path}: {tag} file '{file}' leads out of the aircraft's folders; put it into"
                " the model's folder"
            )
