"""The aircraft: one file each, and those JSBSim brings."""
