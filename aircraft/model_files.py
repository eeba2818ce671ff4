"""The files of a JSBSim model: where they are found, its own folder and the folders that models
share, and their XML.
"""

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path

from aircraft.errors import AircraftError

SHARED = {
    "propulsion": "engine", "engine": "engine", "thruster": "engine",
    "flight_control": "systems", "system": "systems", "autopilot": "systems",
}  # fmt: skip
"""Folder of a JSBSim root where files of an element stand."""

_NO_SECTIONS = ("system", "autopilot", "input", "output")
"""Parts of a model of which it has any number; of its sections it has one each."""

_OWN = ("", "Engines", "Systems", "systems")
"""Folders of a model in which JSBSim looks for files, in order."""


def stock_root() -> Path:
    """Return JSBSim's own root directory."""
    import jsbsim

    return Path(jsbsim.get_default_root_dir())


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelFiles:
    """The files of one model.

    Attributes
    ----------
    model : its name
    folder : with the model file, ``MODEL.xml``
    roots : JSBSim roots whose engines and systems the model may name; the first that has a file is
        taken
    """

    model: str
    folder: Path
    roots: tuple[Path, ...]

    @property
    def file(self) -> Path:
        """Return the model file."""
        return self.folder / f"{self.model}.xml"

    def find(self, element: ET.Element) -> Path | None:
        """Return the file that an element of the model names, searched as JSBSim does; None if
        there is none.
        """
        if not (file := element.get("file")):
            return None
        name = file if file.endswith(".xml") else f"{file}.xml"
        folders = [self.folder / own for own in _OWN]
        if element.tag in SHARED:
            folders += [root / SHARED[element.tag] for root in self.roots]
        return next((folder / name for folder in folders if (folder / name).is_file()), None)


def read_model(files: ModelFiles) -> "ET.ElementTree[ET.Element]":
    """Return the XML of a model, in which each section that is a file of its own stands in its
    place, as JSBSim reads it.

    A section whose file is missing stays as it is.

    Raises
    ------
    AircraftError : as of ``read_xml``
    """
    document = read_xml(files.file)
    config = document.getroot()
    for i, section in enumerate(config):
        if section.tag not in _NO_SECTIONS and (found := files.find(section)):
            content = read_xml(found).getroot()
            content.tag, content.tail = section.tag, section.tail
            config[i] = content
    return document


def read_xml(path: Path) -> "ET.ElementTree[ET.Element]":
    """Return the XML of a file.

    Raises
    ------
    AircraftError : it cannot be read, or is not XML, or not in the encoding that it declares
    """
    try:
        return ET.parse(path)
    except OSError as error:
        raise AircraftError(f"{path}: cannot be read: {error.strerror}; check the file") from None
    except (
        ET.ParseError,
        LookupError,
        ValueError,
    ) as error:  # the last two by encodings that the parser does not know
        raise AircraftError(f"{path}: not valid XML: {error}; correct it") from None
