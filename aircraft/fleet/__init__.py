"""Registry of aircraft: from this package, from installed packages, and from the user's files."""

from aircraft.spec import AircraftSpec
from common.registry import Registry

AIRCRAFT: Registry[AircraftSpec] = Registry("aircraft", folder="aircraft.fleet")
"""The registered aircraft.

An aircraft is added by registering its ``AircraftSpec`` in a file of this folder, by an entry point
in the group ``plume_flight_study.aircraft``, or by naming its file, ``FILE.py:NAME``.
"""
