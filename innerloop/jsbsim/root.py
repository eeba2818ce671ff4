"""A JSBSim root directory that flies an aircraft under its autopilot."""

import xml.etree.ElementTree as ET
from pathlib import Path

from aircraft.model import copy_model, read_xml
from innerloop.jsbsim.properties import system_name
from innerloop.jsbsim.system import system_xml
from innerloop.synthesis.schedule import Schedule


def write_root(schedule: Schedule, directory: Path) -> Path:
    """Write a JSBSim root directory with a copy of the aircraft, its engine files and the
    autopilot; return the directory.

    Any JSBSim started on this root flies the aircraft under the autopilot. The model's own outputs
    and autopilot are left out (``aircraft.model``); its servos keep their play.
    """
    spec = schedule.spec
    model_file = copy_model(spec.files, directory)
    model = read_xml(model_file)
    root = model.getroot()
    systems = directory / "systems"
    systems.mkdir(exist_ok=True)
    (systems / f"{system_name(spec)}.xml").write_text(system_xml(schedule), encoding="utf-8")
    before = next(
        (i for i, element in enumerate(root) if element.tag == "flight_control"), len(root)
    )
    root.insert(before, ET.Element("system", file=system_name(spec)))
    model.write(model_file, encoding="utf-8", xml_declaration=True)
    return directory
