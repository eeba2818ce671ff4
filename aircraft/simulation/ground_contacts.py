"""Ground contacts, left out of copies of models that never land: wheels in the air cost up to a
quarter of each time step.
"""

import re
from pathlib import Path

from aircraft.model_files import read_xml
from aircraft.spec import AircraftSpec

_OF_CONTACTS = re.compile(r"(gear|contact)/(unit|num-units)|steer-pos-deg")
"""Properties that JSBSim has by contacts only."""


def leave_out_ground_contacts(spec: AircraftSpec, root: Path) -> None:
    """Remove the ground contacts of an aircraft's model from a JSBSim root, unless the model or the
    spec names their properties.

    In the air forces and moments of contacts are exactly 0: an aircraft flies the same without
    them, to the last bit.
    """
    # Whatever their encoding: in those of two bytes the other one is 0.
    files = (path for path in root.rglob("*.xml") if path.is_file())
    texts = (path.read_bytes().replace(b"\0", b"").decode("latin-1") for path in files)
    if any(_OF_CONTACTS.search(text) for text in (repr(spec), *texts)):
        return
    model_file = root / "aircraft" / spec.model / f"{spec.model}.xml"
    document = read_xml(model_file)
    parents = document.getroot().findall("ground_reactions")
    contacts = [(parent, contact) for parent in parents for contact in parent.findall("contact")]
    for parent, contact in contacts:
        parent.remove(contact)
    if contacts:
        document.write(model_file, encoding="utf-8", xml_declaration=True)
