"""Bounds on the commands of the cascade law."""
