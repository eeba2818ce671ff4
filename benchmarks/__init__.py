"""Measurements of computing time and memory; nothing is asserted."""
