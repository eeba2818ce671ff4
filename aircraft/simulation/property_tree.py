"""JSBSim's properties by name; names that JSBSim does not have are refused."""

import re

import jsbsim

from aircraft.errors import ReadOnlyPropertyError, UnknownPropertyError

_PROPERTY_NAME = re.compile(r"[A-Za-z_][\w.\-]*(\[\d+\])?(/[A-Za-z_][\w.\-]*(\[\d+\])?)*")


class PropertyTree:
    """The properties of one aircraft. Each is looked up once.

    Parameters
    ----------
    aircraft : its name
    properties : of JSBSim
    """

    def __init__(self, aircraft: str, properties: jsbsim.FGPropertyManager) -> None:
        self._aircraft, self._properties = aircraft, properties
        self._nodes: dict[str, jsbsim.FGPropertyNode] = {}

    def has(self, name: str) -> bool:
        """Return whether there is a property of this name."""
        return self._find(name) is not None

    def node(self, name: str) -> jsbsim.FGPropertyNode:
        """Return the node of an existing property, for repeated access at the least cost."""
        node = self._find(name)
        if node is None:
            raise UnknownPropertyError(
                f"aircraft '{self._aircraft}' has no JSBSim property '{name}'; check its spelling"
            )
        return node

    def _find(self, name: str) -> jsbsim.FGPropertyNode | None:
        found = self._nodes.get(name)
        # An invalid name ends the whole process in JSBSim's property tree.
        if (
            found is None
            and _PROPERTY_NAME.fullmatch(name)
            and (found := self._properties.get_node(name))
        ):
            self._nodes[name] = found
        return found

    def writable_node(self, name: str) -> jsbsim.FGPropertyNode:
        """Return the node of an existing property that takes writes."""
        node = self.node(name)
        if not node.get_attribute(jsbsim.Attribute.WRITE):
            raise ReadOnlyPropertyError(
                f"JSBSim property '{name}' is read-only; a write to it would be ignored"
            )
        return node

    def read(self, name: str) -> float:
        """Return a property in JSBSim's own unit."""
        return float(self.node(name).get_double_value())

    def write(self, name: str, value: float) -> None:
        """Set a property in JSBSim's own unit."""
        self.writable_node(name).set_double_value(value)
