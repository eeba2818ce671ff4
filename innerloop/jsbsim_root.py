"""A JSBSim root directory that flies an aircraft under its autopilot."""

import shutil
import xml.etree.ElementTree as ET
from pathlib import Path

from innerloop.jsbsim_system import system_name, system_xml
from innerloop.schedule import Schedule


def write_root(schedule: Schedule, directory: Path) -> Path:
    """Write a JSBSim root directory with the aircraft, its engine files and the autopilot; return the directory.

    Any JSBSim started on this root flies the aircraft under the autopilot.
    """
    spec = schedule.spec
    source = spec.root / "aircraft" / spec.model
    target = directory / "aircraft" / spec.model
    shutil.copytree(source, target, dirs_exist_ok=True)
    model_file = target / f"{spec.model}.xml"
    model = ET.parse(model_file)
    root = model.getroot()
    (directory / "engine").mkdir(parents=True, exist_ok=True)
    for element in [*root.iter("engine"), *root.iter("thruster")]:
        name = f"{element.get('file')}.xml"
        for folder in (spec.root / "engine", source / "Engines", source):
            if (folder / name).is_file():
                shutil.copy(folder / name, directory / "engine" / name)
                break
    systems = directory / "systems"
    systems.mkdir(exist_ok=True)
    (systems / f"{system_name(spec)}.xml").write_text(system_xml(schedule), encoding="utf-8")
    before = next(i for i, element in enumerate(root) if element.tag == "flight_control")
    root.insert(before, ET.Element("system", file=system_name(spec)))
    model.write(model_file, encoding="utf-8", xml_declaration=True)
    return directory
