"""Search for the point of the unit cube with the least clearance: methods that propose points and
receive the clearances.
"""
