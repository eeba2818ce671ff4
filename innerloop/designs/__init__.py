"""Designing, recording, caching and listing autopilots."""
