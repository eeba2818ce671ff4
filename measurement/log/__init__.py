"""Logged flights: reading their files, the analysis, and the command that writes its results."""
