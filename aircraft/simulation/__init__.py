"""Simulation of an aircraft in JSBSim: load, place, step, fail."""
