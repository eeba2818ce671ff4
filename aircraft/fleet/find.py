"""Find an aircraft by name: registered ones first, then those that come with JSBSim; or by the path
of its folder.
"""

from aircraft.errors import AircraftError
from aircraft.fleet.folder import folder_spec
from aircraft.fleet.registry import AIRCRAFT
from aircraft.fleet.stock import stock_names, stock_spec
from aircraft.spec import AircraftSpec
from aircraft.spec_check import check_spec
from common.files import is_path
from common.registry import PluginError, is_file_part
from common.text import did_you_mean


def aircraft_names() -> list[str]:
    """Return the name of every known aircraft, registered ones first. Not all of them can be flown."""
    registered = AIRCRAFT.names()
    return [*registered, *(name for name in stock_names() if name not in registered)]


def find_spec(name: str) -> AircraftSpec:
    """Return the aircraft called ``name``, or that of a file, ``FILE.py:NAME``, or of a folder,
    ``DIR/NAME``.

    Raises
    ------
    AircraftError : the name is unknown, the aircraft does not load, or an autopilot cannot fly it,
        with the reason
    """
    if is_file_part(name) or name in AIRCRAFT:
        return _registered(name)
    if name in stock_names():
        return stock_spec(name)
    if is_path(name):
        return folder_spec(name)
    guess = did_you_mean(name, aircraft_names()) or ";"
    listed = "`plume-flight design --list` lists the known ones, or give a folder as DIR/NAME, or a file as FILE.py:NAME"
    raise AircraftError(f"unknown aircraft '{name}'{guess} {listed}")


def _registered(name: str) -> AircraftSpec:
    try:
        spec = AIRCRAFT.get(name)
    except PluginError as error:
        raise AircraftError(str(error)) from error
    if not isinstance(spec, AircraftSpec):
        raise AircraftError(
            f"aircraft '{name}' is of type {type(spec).__name__}; it must be an AircraftSpec of aircraft/spec.py"
        )
    check_spec(spec)
    return spec
