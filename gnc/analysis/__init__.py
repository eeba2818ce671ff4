"""Stability and bounds of the steering laws: Lyapunov functions, bounds on commands, ensembles of
trajectories.
"""
