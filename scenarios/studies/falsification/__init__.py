"""A search for the flight that comes closest to the vessel, as a study."""

from scenarios.studies.falsification.study import FalsificationStudy

__all__ = ["FalsificationStudy"]
