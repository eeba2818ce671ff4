"""The autopilot: designed from the linearised aircraft, and flown as a JSBSim ``<system>``."""
