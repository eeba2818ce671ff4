"""Faults in flight: an actuator that sticks at its trim position, and the loss of the engines.

An aircraft with faults flies from a copy of its JSBSim root. In the copy a switch overwrites each
actuator's command after everything else has written it. The switch of a control input stands after
the autopilot, any other switch before the ``<actuator>`` that reads the command. Without a fault
the switch passes the command on unchanged, so the copy flies exactly like the original.

JSBSim's own ``malfunction/fail_stuck`` is not used: it would stop an actuator at its present
position, and few of JSBSim's models have an ``<actuator>``.
"""

import shutil
import xml.etree.ElementTree as ET
from pathlib import Path

from aircraft.fdm import Fdm
from aircraft.model import insert_before_flight_control, read_xml, write_xml
from aircraft.spec import AircraftError, AircraftSpec

ENGINE = "engine"
"""Name of the fault in which all thrust is lost: throttle 0 and engines shut down."""

OF_THRUST = frozenset({ENGINE, "throttle"})
"""Parts whose failure ends thrust or keeps it constant."""

_FAILED = "fault/{}/failed"
_HELD = "fault/{}/held"

_SHUT_DOWN = (("propulsion/magneto_cmd", 0.0), ("propulsion/cutoff_cmd", 1.0))
"""Properties that shut engines down, if a model has them: a windmilling engine would restart."""


def fault_names(spec: AircraftSpec) -> tuple[str, ...]:
    """Names of all possible faults."""
    return (ENGINE, *(actuator.name for actuator in spec.actuators))


def failable_root(spec: AircraftSpec, root: Path, directory: Path) -> Path:
    """Write a copy of a JSBSim root in which parts can fail to ``directory``, and return it.

    Raises
    ------
    AircraftError : an actuator's command belongs to no control input, and no ``<actuator>`` of the
        model reads it
    """
    shutil.copytree(root, directory, dirs_exist_ok=True)
    model_file = directory / "aircraft" / spec.model / f"{spec.model}.xml"
    document = read_xml(model_file)
    config = document.getroot()
    channel = ET.Element("channel", name="Faults")
    of_inputs = {command for control_input in spec.inputs for command in control_input.commands}
    throttles = spec.input("throttle").commands
    for actuator in spec.actuators:
        for command in actuator.commands:
            faults = (ENGINE, actuator.name) if command in throttles else (actuator.name,)
            switch = _switch(command, faults)
            if command in of_inputs:
                channel.append(switch)
            else:
                _insert_before_actuator(config, command, switch, spec)
    system = ET.Element("system", name="Faults")
    for name in fault_names(spec):
        for pattern in (_FAILED, _HELD):
            ET.SubElement(system, "property", value="0").text = pattern.format(name)
    system.append(channel)
    insert_before_flight_control(config, system)
    write_xml(document, model_file)
    return directory


def _switch(command: str, faults: tuple[str, ...]) -> ET.Element:
    """JSBSim component that overwrites a command once one of the faults has occurred."""
    label = command.replace("/", "-").replace("[", "-").replace("]", "")
    switch = ET.Element("switch", name=f"fault/{label}")
    ET.SubElement(switch, "default", value=command)
    for name in faults:
        test = ET.SubElement(switch, "test", value=_HELD.format(name))
        test.text = f"{_FAILED.format(name)} gt 0.5"
    ET.SubElement(switch, "output").text = command
    return switch


def _insert_before_actuator(
    config: ET.Element, command: str, switch: ET.Element, spec: AircraftSpec
) -> None:
    for parent in config.iter():
        for i, element in enumerate(parent):
            if element.tag == "actuator" and (element.findtext("input") or "").strip() == command:
                parent.insert(i, switch)
                return
    raise AircraftError(
        f"aircraft '{spec.name}': no <actuator> of its model reads '{command}';"
        " check its spec's actuators"
    )


class Faults:
    """The faults of one aircraft in flight, loaded from a ``failable_root``.

    Attributes
    ----------
    failed : names of the faults that have occurred
    """

    def __init__(self, fdm: Fdm) -> None:
        self._fdm = fdm
        self._shut_down = [(name, value) for name, value in _SHUT_DOWN if fdm.has(name)]
        self.failed: list[str] = []

    def store_trim_positions(self) -> None:
        """Store each actuator's command as its trim position, at the release from trim."""
        for actuator in self._fdm.spec.actuators:
            self._fdm.write(_HELD.format(actuator.name), self._fdm.read(actuator.commands[0]))

    def fail(self, name: str) -> None:
        """Make a part fail from the next time step on.

        Raises
        ------
        AircraftError : there is no such part
        """
        names = fault_names(self._fdm.spec)
        if name not in names:
            raise AircraftError(
                f"aircraft '{self._fdm.spec.name}' has no '{name}' to fail; it has"
                f" {', '.join(names)}"
            )
        self._fdm.write(_FAILED.format(name), 1.0)
        self.failed.append(name)
        if name == ENGINE:
            for property_name, value in self._shut_down:
                self._fdm.write(property_name, value)

    def clear(self) -> None:
        """Undo every fault, before the next placing of the aircraft, which restarts its engines."""
        for name in self.failed:
            self._fdm.write(_FAILED.format(name), 0.0)
        self.failed.clear()
