"""Own motion, wind, vessel motion, health."""
