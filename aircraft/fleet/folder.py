"""Aircraft of the user: a folder with a JSBSim model, ``DIR/NAME``, and perhaps a file of settings
beside the model.
"""

from pathlib import Path, PurePosixPath, PureWindowsPath

from aircraft.errors import AircraftError
from aircraft.fleet.model_spec import spec_of_model
from aircraft.fleet.settings import ModelSettings, read_settings
from aircraft.model_files import SHARED, ModelFiles, read_xml, stock_root
from aircraft.spec import NAME, AircraftSpec
from common.files import is_path
from common.text import did_you_mean

_MODEL = "fdm_config"
"""Root element of a JSBSim model."""

_LEFT_OUT = ("input", "output")
"""Sections of a model that no copy of it has."""


def folder_names(directory: Path) -> list[str]:
    """Return the name of every folder in ``directory`` that holds a model.

    Raises
    ------
    AircraftError : there is no such directory, or no aircraft in it
    """
    if not directory.is_dir():
        raise AircraftError(
            f"aircraft directory '{directory}': there is no such directory; check the path"
        )
    names = sorted(entry.name for entry in directory.iterdir() if entry.is_dir() and _models(entry))
    if not names and _models(directory):
        where = directory.absolute()
        raise AircraftError(
            f"aircraft directory '{directory}' is the folder of an aircraft itself, '{where.name}'; give the directory that it is"
            f" in, '{where.parent}'"
        )
    if not names:
        raise AircraftError(
            f"aircraft directory '{directory}' holds no aircraft; each needs a folder and a model, NAME/NAME.xml"
        )
    return names


def folder_path(directory: Path, name: str | None) -> str:
    """Return the path of the aircraft called ``name`` in ``directory``, or of the only one that is
    there.

    Raises
    ------
    AircraftError : there is no such directory, no such aircraft in it, or, without a name, more
        than one; the name is a path
    """
    if name is not None and is_path(name):
        raise AircraftError(
            f"aircraft '{name}' is a path; leave out --aircraft-dir, or give the name of a folder in '{directory}'"
        )
    names = folder_names(directory)
    if name is None and len(names) > 1:
        raise AircraftError(
            f"aircraft directory '{directory}' holds {len(names)} aircraft; name one of them: {', '.join(names)}"
        )
    name = names[0] if name is None else name
    if name not in names:
        guess = did_you_mean(name, names) or ";"
        raise AircraftError(
            f"aircraft directory '{directory}' holds no aircraft '{name}'{guess} it has {', '.join(names)}"
        )
    return str(directory.absolute() / name)


def folder_spec(path: str) -> AircraftSpec:
    """Return the spec of the aircraft in a folder, ``DIR/NAME``.

    Its model is ``NAME.xml``, or the only JSBSim model in the folder. Engines and systems that it
    names are looked for in the folder, then in ``DIR/../engine`` and ``DIR/../systems``, then in
    JSBSim's own. ``NAME.toml`` after the model's name may say more of it.

    Raises
    ------
    AircraftError : no such folder, no model in it, or several; a file is not as it should be; an
        autopilot cannot fly it
    """
    folder = Path(path).absolute()
    if not folder.is_dir():
        remedy = (
            f"give its folder, '{Path(path).parent}'"
            if folder.is_file()
            else "check the path, or name another with --aircraft-dir"
        )
        raise AircraftError(f"aircraft '{path}': there is no such directory; {remedy}")
    model = _model(folder)
    for name in (folder.name, model):
        if not NAME.fullmatch(name):
            raise AircraftError(
                f"aircraft '{path}': '{name}' is no name of an aircraft; use letters, digits, '_', '-' and '.'"
            )
    files = ModelFiles(model=model, folder=folder, roots=(folder.parent.parent, stock_root()))
    _check(files)
    settings = folder / f"{model}.toml"
    return spec_of_model(
        files,
        name=folder.name,
        source=f"the user's own model '{model}', gear up, fuel held, its own autopilot off",
        settings=read_settings(settings) if settings.is_file() else ModelSettings(),
    )


def _models(folder: Path) -> list[str]:
    """Return the names of the models in a folder: that of its own name alone, if there is one."""
    if (folder / f"{folder.name}.xml").is_file():
        return [folder.name]
    return sorted(path.stem for path in folder.glob("*.xml") if path.is_file() and _is_model(path))


def _is_model(path: Path) -> bool:
    try:
        return read_xml(path).getroot().tag == _MODEL
    except AircraftError:
        return False


def _model(folder: Path) -> str:
    found = _models(folder)
    if not found:
        raise AircraftError(
            f"aircraft '{folder}' has no JSBSim model; put it there as {folder.name}.xml"
        )
    if len(found) > 1:
        listed = ", ".join(f"{name}.xml" for name in found)
        raise AircraftError(
            f"aircraft '{folder}' has {len(found)} models, {listed}; call one of them {folder.name}.xml"
        )
    return found[0]


def _check(files: ModelFiles) -> None:
    """Refuse a model with a file that is not XML, or that names a file which is missing or leads
    out of its folders.
    """
    checked: set[Path] = set()
    waiting = [files.file]
    while waiting:
        path = waiting.pop()
        if path in checked:
            continue
        checked.add(path)
        config = read_xml(path).getroot()
        if path == files.file and config.tag != _MODEL:
            raise AircraftError(
                f"{path}: its root element is <{config.tag}>; that of a JSBSim model is <{_MODEL}>"
            )
        sections = [
            element for element in config if path == files.file and element.tag not in _LEFT_OUT
        ]
        for element in config.iter():
            if file := element.get("file"):
                _refuse_outside(path, element.tag, file)
                found = files.find(element)
                if found is None and (element.tag in SHARED or element in sections):
                    shared = [
                        root / SHARED[element.tag] for root in files.roots if element.tag in SHARED
                    ]
                    places = ", ".join(f"'{place}'" for place in (files.folder, *shared))
                    raise AircraftError(
                        f"{path}: {element.tag} file '{file}' is not in {places}; put it there"
                    )
                waiting += [found] if found else []


def _refuse_outside(path: Path, tag: str, file: str) -> None:
    """Refuse a file name that is absolute or has '..' in it."""
    for pure in (PurePosixPath(file), PureWindowsPath(file)):
        if pure.anchor or ".." in pure.parts:
            raise AircraftError(
                f"{path}: {tag} file '{file}' leads out of the aircraft's folders; put it beside the model"
            )
