"""Errors of the vehicle's own motion by air and sensors: of the estimated wind, and of dead
reckoning.
"""
