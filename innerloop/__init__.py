"""The autopilot: its design from the linearised aircraft, and its flight as a JSBSim system."""
