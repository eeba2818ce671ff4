"""Reads a run directory, never JSBSim: figures, HTML, PDF."""
