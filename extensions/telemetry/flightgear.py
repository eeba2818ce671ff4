"""FlightGear, which shows the aircraft of a flight while it is replayed."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from common.text import host_and_port
from scenarios.errors import InputError

if TYPE_CHECKING:
    from aircraft.fdm import Fdm

_OUTPUT = '<output name="{host}" type="FLIGHTGEAR" port="{port}" protocol="UDP" rate="30"/>'
"""JSBSim's output element, which sends FlightGear 30 packets a second."""


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
        host = host_and_port(self.address)
        if host is None:
            raise InputError(
                f"--flightgear is '{self.address}'; give HOST:PORT, as in localhost:5550"
            )
        object.__setattr__(self, "_host", host)

    def show(self, fdm: "Fdm") -> None:
        """Show an aircraft from now on."""
        host, port = self._host
        fdm.stream(_OUTPUT.format(host=host, port=port))
