"""Faults in flight: an actuator that goes to its trim position and sticks there, and the loss of
the engines.

An aircraft with faults flies from a copy of its JSBSim root in which a switch follows each
actuator's command, after everything that writes it: behind the autopilot for the command of a
control input, before the ``<actuator>`` that reads it for any other. Without a fault the switch
passes the command on unchanged, so the copy flies exactly as the original does. JSBSim's own
``malfunction/fail_stuck`` would stop an actuator wherever it is at that time, and few of JSBSim's
own models have an ``<actuator>``.
"""

import shutil
import xml.etree.ElementTree as ET
from pathlib import Path

from aircraft.errors import AircraftError
from aircraft.model_files import read_xml
from aircraft.simulation.fdm import Fdm
from aircraft.spec import Actuator, AircraftSpec

ENGINE = "engine"
"""Name of the loss of all thrust: the throttle's command is 0, and running engines are shut down.
"""

OF_THRUST = frozenset({ENGINE, "throttle"})
"""Parts by whose failure thrust is lost, or stays what it was."""

_FAILED, _HELD = "fault/{}/failed", "fault/{}/held"
_SHUT_DOWN = (("propulsion/magneto_cmd", 0.0), ("propulsion/cutoff_cmd", 1.0))
"""Properties that shut engines down, if a model has them; with ``set-running`` alone a windmilling
engine restarts.
"""


def fault_names(spec: AircraftSpec) -> tuple[str, ...]:
    """Return the names of all possible faults."""
    return (ENGINE, *(actuator.name for actuator in spec.actuators))


def failable_root(spec: AircraftSpec, root: Path, directory: Path) -> Path:
    """Write a copy of a JSBSim root whose aircraft can fail; return ``directory``.

    Parameters
    ----------
    spec : the aircraft
    root : with the aircraft and its autopilot; it is not changed
    directory : where to write the copy

    Raises
    ------
    AircraftError : an actuator's command is neither that of a control input nor read by an
        ``<actuator>`` of the model
    """
    shutil.copytree(root, directory, dirs_exist_ok=True)
    model_file = directory / "aircraft" / spec.model / f"{spec.model}.xml"
    document = read_xml(model_file)
    config = document.getroot()
    channel = ET.Element("channel", name="Faults")
    by_inputs = {command for control_input in spec.inputs for command in control_input.commands}
    for actuator in spec.actuators:
        for command in actuator.commands:
            switch = _switch(actuator, command, engine=command in spec.input("throttle").commands)
            if command in by_inputs:
                channel.append(switch)
            else:
                _insert_before_actuator(config, command, switch, spec)
    system = ET.Element("system", name="Faults")
    for name in fault_names(spec):
        for pattern in (_FAILED, _HELD):
            ET.SubElement(system, "property", value="0").text = pattern.format(name)
    system.append(channel)
    before = next(
        (i for i, element in enumerate(config) if element.tag == "flight_control"), len(config)
    )
    config.insert(before, system)
    document.write(model_file, encoding="utf-8", xml_declaration=True)
    return directory


def _switch(actuator: Actuator, command: str, *, engine: bool) -> ET.Element:
    """Return a component that overwrites a command where its actuator has failed."""
    switch = ET.Element(
        "switch", name=f"fault/{command.replace('/', '-').replace('[', '-').replace(']', '')}"
    )
    ET.SubElement(switch, "default", value=command)
    for name in (ENGINE, actuator.name) if engine else (actuator.name,):
        ET.SubElement(
            switch, "test", value=_HELD.format(name)
        ).text = f"{_FAILED.format(name)} gt 0.5"
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
        f"aircraft '{spec.name}': no <actuator> of its model reads '{command}'; check its spec's actuators"
    )


class Faults:
    """The faults of one aircraft in flight.

    Parameters
    ----------
    fdm : loaded from a ``failable_root``
    """

    def __init__(self, fdm: Fdm) -> None:
        self._fdm = fdm
        self._engine_properties = [(name, value) for name, value in _SHUT_DOWN if fdm.has(name)]
        self.failed: list[str] = []
        """Names of the faults that have occurred."""

    def note_trim(self) -> None:
        """Store every actuator's command as its trim position; call it at the release from trim."""
        for actuator in self._fdm.spec.actuators:
            self._fdm.write(_HELD.format(actuator.name), self._fdm.read(actuator.commands[0]))

    def fail(self, name: str) -> None:
        """Let a part fail from the next time step on.

        Raises
        ------
        AircraftError : there is no such part
        """
        names = fault_names(self._fdm.spec)
        if name not in names:
            raise AircraftError(
                f"aircraft '{self._fdm.spec.name}' has no '{name}' to fail; it has {', '.join(names)}"
            )
        self._fdm.write(_FAILED.format(name), 1.0)
        self.failed.append(name)
        if name == ENGINE:
            for property_name, value in self._engine_properties:
                self._fdm.write(property_name, value)

    def clear(self) -> None:
        """Undo every fault before the aircraft is placed for another flight; placing it starts its
        engines.
        """
        for name in self.failed:
            self._fdm.write(_FAILED.format(name), 0.0)
        self.failed.clear()
