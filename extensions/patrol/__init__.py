"""A patrol: one UAV with an endurance, several ships on their ways, each measured until there is a
verdict on its fuel.
"""

SHIPS = "ships.csv"
"""A row per ship of a patrol."""

PHASES = "phases.csv"
"""A row per stretch of a patrol: the way to a ship, and the flight beside it."""
