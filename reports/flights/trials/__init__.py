"""Figures and tables of a trial."""
