"""Autopilots are designed, recorded, cached and listed here."""
