"""A patrol: one UAV with an endurance, several ships on their ways, each measured until there is a
verdict on its fuel.
"""
