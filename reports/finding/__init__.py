"""Flights that search for a plume: what was believed of it, how soon it was found, and how well it
was hit.
"""
