"""Intervals, sensitivity, stopping rules."""
