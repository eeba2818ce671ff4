"""Steering laws: one file each, behind one Protocol."""
