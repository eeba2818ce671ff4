"""Steering laws side by side: those of autopilots and of the literature beside the paper's."""

ARENA = "arena.json"
"""Results of an arena, and the tuning of each law."""

TUNING_TABLE = "tuning.csv"
"""A row for each setting that the tuner tried."""

WINDOW_TABLE = "window.csv"
"""A row for each flight: figures of its end."""

TRACKING, STANDOFF = "tracking", "standoff"
"""The tasks: to track the oscillating reference, and to circle the vessel."""

ALL = "all"
"""Stands for all conditions together."""
