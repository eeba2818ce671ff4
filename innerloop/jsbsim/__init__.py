"""The autopilot as a JSBSim system, script and root."""
