"""The point to be tracked: the shapes of its orbit, where that lies in the plume, its motion."""
