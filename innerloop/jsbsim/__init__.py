"""The autopilot as a JSBSim system, root directory and script."""
