"""Read, copy and change the XML of a JSBSim model.

JSBSim's own models write files, open sockets and have their own autopilots. The copies that this
project flies have none of these.
"""

import contextlib
import re
import shutil
import tempfile
import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

from aircraft.spec import SHARED_FOLDERS, AircraftError, AircraftSpec, ModelFiles
from common.files import files_hash

Document: TypeAlias = "ET.ElementTree[ET.Element]"

_REPEATABLE_SECTIONS = ("system", "autopilot", "input", "output")
"""Sections that a model may have several times; it has every other section once."""

_AUTOPILOT_NAME = re.compile(r"(^|[^a-z])(ap|autopilot|autothrottle)([^a-z]|$)")
_PLAY = ("hysteresis_width", "deadband_width")


def stock_root() -> Path:
    """JSBSim's own root directory."""
    import jsbsim

    return Path(jsbsim.get_default_root_dir())


def read_xml(path: Path) -> Document:
    """XML document in a file.

    Raises
    ------
    AircraftError : the file cannot be read, is not XML, or has another encoding than it declares
    """
    try:
        return ET.parse(path)
    except OSError as error:
        raise AircraftError(f"{path}: cannot be read: {error.strerror}; check the file") from None
    except (ET.ParseError, LookupError, ValueError) as error:
        # An encoding that the parser does not know raises LookupError or ValueError.
        raise AircraftError(f"{path}: not valid XML: {error}; correct it") from None


def read_model(files: ModelFiles) -> Document:
    """XML document of a model, with the sections from other files inserted.

    A section whose file is missing stays as it is.

    Raises
    ------
    AircraftError : same as ``read_xml``
    """
    document = read_xml(files.file)
    config = document.getroot()
    for i, section in enumerate(config):
        if section.tag in _REPEATABLE_SECTIONS:
            continue
        found = files.find(section)
        if found:
            content = read_xml(found).getroot()
            content.tag = section.tag
            content.tail = section.tail
            config[i] = content
    return document


def write_xml(document: Document, path: Path) -> None:
    """Write XML to a file."""
    document.write(path, encoding="utf-8", xml_declaration=True)


def insert_before_flight_control(config: ET.Element, system: ET.Element) -> None:
    """Add a system to a model; JSBSim computes it before the flight control."""
    tags = [element.tag for element in config]
    place = tags.index("flight_control") if "flight_control" in tags else len(tags)
    config.insert(place, system)


def copy_model(files: ModelFiles, directory: Path, *, play: bool = True) -> Path:
    """Copy a model and every file that it refers to into a new JSBSim root; return the model file.

    Outputs, inputs (files, sockets) and autopilots are left out: ``<autopilot>`` elements, and
    systems named like an autopilot. The autopilots' properties stay, at 0, so that flight controls
    that add an autopilot's command to the pilot's add 0.

    Parameters
    ----------
    files : the model's files, which stay unchanged
    directory : where to write the copy
    play : whether servos keep their hysteresis and dead bands, which a linear model does not have

    Raises
    ------
    AircraftError : a file of the model is missing, cannot be copied, or is not XML
    """
    if not files.file.is_file():
        raise AircraftError(f"no model file {files.file}; check the JSBSim root directory")
    target = directory / "aircraft" / files.model
    try:
        shutil.copytree(files.folder, target, dirs_exist_ok=True, ignore=_unread_files)
    except shutil.Error as error:
        _, _, why = error.args[0][0]  # the first of them
        raise AircraftError(
            f"model files of {files.folder} cannot be copied: {why}; check that file"
        ) from None
    document = read_model(files)
    config = document.getroot()
    at_rest = [*_remove_autopilots_and_io(config, files), *_flightgear_properties(config, files)]
    if at_rest:
        system = ET.Element("system", name="The model's own autopilot, off")
        for name in at_rest:
            ET.SubElement(system, "property", value="0").text = name
        insert_before_flight_control(config, system)
    _copy_referenced(config, files, directory)
    if not play:
        for folder in (target, directory / "systems"):
            for path in folder.rglob("*.xml"):
                # The folder may hold files that are not XML; JSBSim does not read them.
                with contextlib.suppress(AircraftError):
                    part = read_xml(path)
                    if _remove_play(part.getroot()):
                        write_xml(part, path)
        _remove_play(config)
    model_file = target / f"{files.model}.xml"
    write_xml(document, model_file)
    return model_file


def model_hash(files: ModelFiles) -> str:
    """Hash of all files in the copy of a model.

    Raises
    ------
    AircraftError : a file of the model is missing or not XML
    """
    with tempfile.TemporaryDirectory() as folder:
        copy_model(files, Path(folder))
        return files_hash(
            Path(folder), sorted(path for path in Path(folder).rglob("*") if path.is_file())
        )


def _unread_files(folder: str, names: list[str]) -> list[str]:
    """Names of files that JSBSim does not read, such as large pictures, sounds and broken links."""

    def is_read(path: Path) -> bool:
        return path.is_dir() or (path.name.endswith((".xml", ".toml")) and path.is_file())

    return [name for name in names if not is_read(Path(folder, name))]


def _remove_autopilots_and_io(config: ET.Element, files: ModelFiles) -> list[str]:
    """Remove outputs, inputs and autopilots; return the properties that the autopilots had."""
    names: list[str] = []
    for element in list(config):
        if element.tag in ("output", "input"):
            config.remove(element)
        elif _is_autopilot(element):
            names += _autopilot_properties(content_of(element, files))
            config.remove(element)
    return list(dict.fromkeys(names))


def _is_autopilot(element: ET.Element) -> bool:
    if element.tag == "autopilot":
        return True
    names = (element.get("name", ""), Path(element.get("file", "")).stem)
    return element.tag == "system" and any(_AUTOPILOT_NAME.search(name.lower()) for name in names)


def content_of(element: ET.Element, files: ModelFiles) -> ET.Element:
    """The root element of the file that an element names, or else the element itself."""
    found = files.find(element)
    return read_xml(found).getroot() if found else element


def _autopilot_properties(autopilot: ET.Element) -> list[str]:
    """Every property that an autopilot declares or writes."""
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


def _flightgear_properties(config: ET.Element, files: ModelFiles) -> list[str]:
    """FlightGear's properties that the model reads, such as ``/sim/model/pushback``."""
    referenced = [content_of(element, files) for element in config.iter() if element.get("file")]
    texts = [element.text or "" for part in (config, *referenced) for element in part.iter()]
    words = [word.lstrip("-") for text in texts for word in text.split()]
    found = [word for word in words if re.fullmatch(r"/[A-Za-z_][\w.\-/\[\]]*", word)]
    return list(dict.fromkeys(found))


def _copy_referenced(config: ET.Element, files: ModelFiles, directory: Path) -> None:
    """Copy engines, thrusters and systems from outside of the model's folder.

    Engines beside the model file are copied as well, because JSBSim does not search there. The
    other files of the folder are already in the copy.
    """
    for element in config.iter():
        found = files.find(element) if element.tag in SHARED_FOLDERS else None
        if found is None:
            continue
        shared_folder = SHARED_FOLDERS[element.tag]
        engine_beside_model = shared_folder == "engine" and found.parent == files.folder
        if found.is_relative_to(files.folder) and not engine_beside_model:
            continue
        folder = directory / shared_folder
        folder.mkdir(parents=True, exist_ok=True)
        shutil.copy(found, folder / found.name)


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


def has_play(root: Path) -> bool:
    """Whether any servo of the aircraft in a JSBSim root has hysteresis or a dead band."""
    for path in sorted(root.rglob("*.xml")):
        # The folder may hold files that are not XML; JSBSim does not read them.
        with contextlib.suppress(AircraftError):
            for actuator in read_xml(path).getroot().iter("actuator"):
                if any(part.tag in _PLAY and _is_wide(part) for part in actuator):
                    return True
    return False


def _is_wide(play: ET.Element) -> bool:
    """Whether the width of a hysteresis or dead band is not 0; a property's value is unknown."""
    try:
        return float(play.text or "0") != 0.0
    except ValueError:
        return True


_CONTACT_PROPERTIES = re.compile(r"(gear|contact)/(unit|num-units)|steer-pos-deg")
"""Properties that exist in JSBSim only with ground contacts."""


def remove_ground_contacts(spec: AircraftSpec, root: Path) -> None:
    """Remove an aircraft's ground contacts from a JSBSim root if neither model nor spec uses them.

    In the air the forces and moments of contacts are exactly 0, so the aircraft flies the same to
    the last bit, and a time step takes up to a quarter less computing time.
    """
    # Latin-1 shows property names in every encoding; two-byte encodings put zeros between letters.
    paths = (path for path in root.rglob("*.xml") if path.is_file())
    texts = (path.read_bytes().replace(b"\0", b"").decode("latin-1") for path in paths)
    if any(_CONTACT_PROPERTIES.search(text) for text in (repr(spec), *texts)):
        return
    model_file = root / "aircraft" / spec.model / f"{spec.model}.xml"
    document = read_xml(model_file)
    parents = document.getroot().findall("ground_reactions")
    contacts = [(parent, contact) for parent in parents for contact in parent.findall("contact")]
    for parent, contact in contacts:
        parent.remove(contact)
    if contacts:
        write_xml(document, model_file)


@dataclass(frozen=True, slots=True, kw_only=True)
class Perturbation:
    """Factors by which an aircraft differs from its model.

    Attributes
    ----------
    mass : factor of the masses of the empty aircraft, point masses and fuel [-]
    inertia : factor of every moment of inertia of the empty aircraft [-]
    effectiveness : factor of every deflection that the aerodynamics multiply by; a deflection with
        which a table is read stays unchanged [-]
    """

    mass: float = 1.0
    inertia: float = 1.0
    effectiveness: float = 1.0


PERTURBATIONS = {
    "control effectiveness +20 %": Perturbation(effectiveness=1.2),
    "control effectiveness -20 %": Perturbation(effectiveness=0.8),
    "mass +20 %": Perturbation(mass=1.2),
    "mass -20 %": Perturbation(mass=0.8),
    "inertia +20 %": Perturbation(inertia=1.2),
    "inertia -20 %": Perturbation(inertia=0.8),
}
"""Uncertainties for which a design's margins and turn reversals are computed."""

_MASSES = ("emptywt", "pointmass/weight")
_MOMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
_TANKS = ("tank/contents", "tank/capacity")
"""Elements of a tank that are scaled together: JSBSim allows no contents above the capacity."""

_DEFLECTION = re.compile(r"^-?fcs/.*pos")
"""Properties of surface deflections, JSBSim's own and the models'."""


def perturb(model_file: Path, by: Perturbation) -> None:
    """Apply a perturbation to the model file of a copy, which has all its sections in one file.

    Without a perturbation the file stays unchanged, to the last byte.
    """
    if by == Perturbation():
        return
    document = read_xml(model_file)
    config = document.getroot()
    _scale(config.find("mass_balance"), _MASSES, by.mass)
    _scale(config.find("mass_balance"), _MOMENTS, by.inertia)
    _scale(config.find("propulsion"), _TANKS, by.mass)
    aerodynamics = config.find("aerodynamics")
    if aerodynamics is not None and by.effectiveness != 1.0:
        _scale_deflections(aerodynamics, by.effectiveness)
    write_xml(document, model_file)


def _scale(section: ET.Element | None, paths: tuple[str, ...], factor: float) -> None:
    if section is None:
        return
    for path in paths:
        for element in section.findall(path):
            element.text = repr(float(element.text or 0.0) * factor)


def _scale_deflections(parent: ET.Element, factor: float) -> None:
    for i, child in enumerate(list(parent)):
        if child.tag in ("property", "p") and _DEFLECTION.match((child.text or "").strip()):
            product = ET.Element("product")
            ET.SubElement(product, "value").text = repr(factor)
            parent.remove(child)
            product.append(child)
            parent.insert(i, product)
        else:
            _scale_deflections(child, factor)
