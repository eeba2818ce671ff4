"""JSBSim, and nothing else touches it: load, place, step, fail."""
