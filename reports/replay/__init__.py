"""Flights as they are replayed on the screen."""
