"""A model whose sections are files of their own, as those of JSBSim's Short S.23 and F450 are."""

import shutil
import xml.etree.ElementTree as ET

from aircraft.model import stock_root

SECTIONS = {
    "mass_balance": "Mass.xml",
    "propulsion": "Propulsion",
    "flight_control": "Systems/controls.xml",
    "aerodynamics": "Systems/aero.xml",
}
"""Files of sections, as a model may name them."""


def split_model(name, folder):
    """Write one of JSBSim's models into a folder of its own name in ``folder``, with sections in
    files; return that folder.
    """
    own = shutil.copytree(stock_root() / "aircraft" / name, folder / name)
    document = ET.parse(own / f"{name}.xml")
    config = document.getroot()
    for tag, file in SECTIONS.items():
        section = config.find(tag)
        path = own / f"{file.removesuffix('.xml')}.xml"
        path.parent.mkdir(exist_ok=True)
        ET.ElementTree(section).write(path)
        config[list(config).index(section)] = ET.Element(tag, file=file)
    document.write(own / f"{name}.xml")
    return own
