"""Trim, linear models, control effectiveness and envelope of an aircraft, computed with JSBSim."""
