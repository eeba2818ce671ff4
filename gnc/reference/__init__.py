"""The virtual target: oscillation, orbit, placement, motion."""
