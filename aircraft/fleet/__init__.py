"""The aircraft by name: those of this package, of installed packages, and of the user's files."""

from aircraft.spec import AircraftSpec
from common.registry import Registry

AIRCRAFT: Registry[AircraftSpec] = Registry("aircraft", folder="aircraft.fleet")
"""The registered aircraft.

To add one, register its ``AircraftSpec`` in a file of this folder, announce it as an entry point in
the group ``plume_flight_study.aircraft``, or name it by its file, ``FILE.py:NAME``.
"""
