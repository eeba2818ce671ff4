"""Steering laws side by side, as a study."""

from scenarios.studies.arena.study import ArenaStudy

__all__ = ["ArenaStudy"]
