"""A copy of a JSBSim model without its own outputs, sockets and autopilots, and a hash of it."""

import re
import shutil
import tempfile
import xml.etree.ElementTree as ET
from pathlib import Path

from aircraft.errors import AircraftError
from aircraft.model_files import SHARED, ModelFiles, read_model, read_xml
from common.files import files_hash

_OWN_AUTOPILOT = re.compile(r"(^|[^a-z])(ap|autopilot|autothrottle)([^a-z]|$)")
_PLAY = ("hysteresis_width", "deadband_width")


def copy_model(files: ModelFiles, directory: Path, *, play: bool = True) -> Path:
    """Copy a model with all it refers to into a JSBSim root of its own, and return the copy's model
    file.

    Outputs and inputs (files, sockets) are left out. So is every autopilot: ``<autopilot>``
    elements and systems that are called one. Their properties stay, at rest: flight controls that
    add an autopilot's command to the pilot's then add 0.

    Parameters
    ----------
    files : of the model; they are not changed
    directory : where to write the copy
    play : whether servos keep their hysteresis and dead bands; a linear model has none

    Raises
    ------
    AircraftError : a file of the model is missing, cannot be copied, or is not XML
    """
    if not files.file.is_file():
        raise AircraftError(f"no model file {files.file}; check the JSBSim root directory")
    target = directory / "aircraft" / files.model
    try:
        shutil.copytree(files.folder, target, dirs_exist_ok=True, ignore=_not_read)
    except shutil.Error as error:
        _, _, why = error.args[0][0]  # the first of them
        raise AircraftError(
            f"model files of {files.folder} cannot be copied: {why}; check that file"
        ) from None
    model_file = target / f"{files.model}.xml"
    document = read_model(files)
    config = document.getroot()
    at_rest = [*_take_out(config, files), *_of_another_program(config, files)]
    if at_rest:
        before = next(
            (i for i, element in enumerate(config) if element.tag == "flight_control"), len(config)
        )
        config.insert(before, _properties_at_rest(at_rest))
    _copy_referenced(config, files, directory)
    if not play:
        for folder in (target, directory / "systems"):
            for path in folder.rglob("*.xml"):
                _take_out_play(path)
        _remove_play(config)
    document.write(model_file, encoding="utf-8", xml_declaration=True)
    return model_file


def model_hash(files: ModelFiles) -> str:
    """Return a hash of a model: of every file that its copy has.

    Raises
    ------
    AircraftError : a file of the model is missing or not XML
    """
    with tempfile.TemporaryDirectory() as folder:
        copy_model(files, Path(folder))
        return files_hash(
            Path(folder), sorted(path for path in Path(folder).rglob("*") if path.is_file())
        )


def _not_read(folder: str, names: list[str]) -> list[str]:
    """Return the files that JSBSim does not read: pictures and sounds beside a model can be large,
    and links lead nowhere.
    """
    return [name for name in names if not _is_read(Path(folder, name))]


def _is_read(path: Path) -> bool:
    return path.is_dir() or (path.name.endswith((".xml", ".toml")) and path.is_file())


def _take_out(config: ET.Element, files: ModelFiles) -> list[str]:
    """Remove outputs, inputs and autopilots; return the properties that the autopilots had."""
    names: list[str] = []
    for element in list(config):
        if element.tag in ("output", "input"):
            config.remove(element)
        elif _is_autopilot(element):
            names += _properties(_content(element, files))
            config.remove(element)
    return list(dict.fromkeys(names))


def _of_another_program(config: ET.Element, files: ModelFiles) -> list[str]:
    """Return the properties that the model reads from FlightGear's tree, such as
    ``/sim/model/pushback``: JSBSim alone does not have them."""
    parts = [
        config,
        *(_content(element, files) for element in config.iter() if element.get("file")),
    ]
    words = (
        word.lstrip("-")
        for part in parts
        for element in part.iter()
        for word in (element.text or "").split()
    )
    return list(
        dict.fromkeys(word for word in words if re.fullmatch(r"/[A-Za-z_][\w.\-/\[\]]*", word))
    )


def _is_autopilot(element: ET.Element) -> bool:
    if element.tag == "autopilot":
        return True
    names = (element.get("name", ""), Path(element.get("file", "")).stem)
    return element.tag == "system" and any(_OWN_AUTOPILOT.search(name.lower()) for name in names)


def _content(element: ET.Element, files: ModelFiles) -> ET.Element:
    """Return the element itself, or the root of the file that it names."""
    found = files.find(element)
    return read_xml(found).getroot() if found else element


def _properties(autopilot: ET.Element) -> list[str]:
    """Return every property that an autopilot declares or writes."""
    names = [
        (element.text or "").strip()
        for element in autopilot.iter()
        if element.tag in ("property", "output")
    ]
    for channel in autopilot.iter("channel"):
        for component in channel:
            name = component.get("name", "")
            names.append(name if "/" in name else f"ap/{name.lower().replace(' ', '-')}")
    return [name.lstrip("-") for name in names if re.fullmatch(r"-?[A-Za-z_][\w.\-/\[\]]*", name)]


def _properties_at_rest(names: list[str]) -> ET.Element:
    system = ET.Element("system", name="The model's own autopilot, off")
    for name in names:
        ET.SubElement(system, "property", value="0").text = name
    return system


def _copy_referenced(config: ET.Element, files: ModelFiles, directory: Path) -> None:
    """Copy the engines, thrusters and systems of the roots' common folders, and engines that stand
    beside the model itself, where JSBSim does not look for them; the model's other files are copied
    already."""
    for element in config.iter():
        if element.tag not in SHARED or not (found := files.find(element)):
            continue
        if found.is_relative_to(files.folder) and not (
            SHARED[element.tag] == "engine" and found.parent == files.folder
        ):
            continue
        folder = directory / SHARED[element.tag]
        folder.mkdir(parents=True, exist_ok=True)
        shutil.copy(found, folder / found.name)


def _take_out_play(path: Path) -> None:
    try:
        document = read_xml(path)
    except AircraftError:
        return  # a file beside the model that JSBSim does not read
    if _remove_play(document.getroot()):
        document.write(path, encoding="utf-8", xml_declaration=True)


def _remove_play(config: ET.Element) -> bool:
    """Remove hysteresis and dead bands from every actuator; return whether there were any."""
    found = [
        (actuator, part)
        for actuator in config.iter("actuator")
        for part in actuator
        if part.tag in _PLAY
    ]
    for actuator, part in found:
        actuator.remove(part)
    return bool(found)
