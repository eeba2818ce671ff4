"""Bounds on the commands of the steering laws, and ensembles of trajectories."""
