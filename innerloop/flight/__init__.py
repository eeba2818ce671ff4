"""Flight of the aircraft under its autopilot in JSBSim, and measurements in flight."""
