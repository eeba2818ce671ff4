"""Estimates of own motion, wind and the vessel's motion, and the detection of the vehicle's faults."""
