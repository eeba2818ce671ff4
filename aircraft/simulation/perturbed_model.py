"""An aircraft that is not quite as modelled: another mass, other moments of inertia, other
effectiveness of its controls.
"""

import re
import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path

from aircraft.model_files import read_xml

_DEFLECTION = re.compile(r"^-?fcs/.*pos")
"""Properties of surfaces' deflections, as JSBSim's own and those of models are called."""

_MASSES, _MOMENTS = ("emptywt", "pointmass/weight"), ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
_TANKS = ("tank/contents", "tank/capacity")
"""A tank that holds more than it can is no model."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Perturbation:
    """By what factors an aircraft differs from its model.

    Attributes
    ----------
    mass : of the empty aircraft, its point masses and its fuel [-]
    inertia : of every moment of the empty aircraft [-]
    effectiveness : of every deflection as the aerodynamics have it, but where a table is read at it
        [-]
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
"""As little as an aircraft is taken to be known: a design's margins and its search over reversals
allow for it.
"""


def perturb(model_file: Path, by: Perturbation) -> None:
    """Change the file of a JSBSim model that has all its sections, as a copy has.

    A model without perturbation is left as it is, to the last byte.
    """
    if by == Perturbation():
        return
    document = read_xml(model_file)
    for tag, change in _CHANGES.items():
        section = document.getroot().find(tag)
        if section is not None:
            change(section, by)
    document.write(model_file, encoding="utf-8", xml_declaration=True)


def _change_balance(balance: ET.Element, by: Perturbation) -> None:
    for paths, factor in ((_MASSES, by.mass), (_MOMENTS, by.inertia)):
        for element in (found for path in paths for found in balance.findall(path)):
            _scale(element, factor)


def _change_fuel(propulsion: ET.Element, by: Perturbation) -> None:
    for element in (found for path in _TANKS for found in propulsion.findall(path)):
        _scale(element, by.mass)


def _change_aerodynamics(aerodynamics: ET.Element, by: Perturbation) -> None:
    if by.effectiveness != 1.0:
        _scale_deflections(aerodynamics, by.effectiveness)


_CHANGES = {
    "mass_balance": _change_balance,
    "propulsion": _change_fuel,
    "aerodynamics": _change_aerodynamics,
}
"""What is changed in each section of a model; JSBSim reads the first of each."""


def _scale(element: ET.Element, factor: float) -> None:
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
