"""Search for the point of the unit cube with the least clearance.

Search methods propose points and receive their clearances.
"""
