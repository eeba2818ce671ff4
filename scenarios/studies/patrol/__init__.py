"""A patrol: one UAV with an endurance, several ships on their ways, each measured until there is a
verdict on her fuel.
"""

from scenarios.studies.patrol.study import PatrolStudy

__all__ = ["PatrolStudy"]
