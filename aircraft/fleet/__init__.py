"""The known aircraft: one file each, those of the user, and those that come with JSBSim."""
