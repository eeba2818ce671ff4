"""FlightGear, which shows the aircraft of a flight while it is replayed."""

import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from scenarios.errors import InputError

if TYPE_CHECKING:
    from aircraft.fdm import Fdm

_ADDRESS = re.compile(r"([A-Za-z0-9.\-]+):(\d{1,5})")

_PORT_MAX = 65535

_OUTPUT = '<output name="{host}" type="FLIGHTGEAR" port="{port}" protocol="UDP" rate="30"/>'
"""JSBSim's output of FlightGear's packets, 30 a second."""


@dataclass(frozen=True)
class FlightGear:
    """A FlightGear that listens for packets of a flight dynamics model.

    Attributes
    ----------
    address : HOST:PORT

    Raises
    ------
    InputError : it is not of that form
    """

    address: str
    _host: tuple[str, int] = field(init=False)

    def __post_init__(self) -> None:
        found = _ADDRESS.fullmatch(self.address)
        if found is None or not 0 < int(found[2]) <= _PORT_MAX:
            raise InputError(
                f"--flightgear is '{self.address}'; give HOST:PORT, as in localhost:5550"
            )
        object.__setattr__(self, "_host", (found[1], int(found[2])))

    def show(self, fdm: "Fdm") -> None:
        """Show an aircraft from now on."""
        host, port = self._host
        fdm.stream(_OUTPUT.format(host=host, port=port))
