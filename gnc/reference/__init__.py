"""The point to be tracked: shapes of its orbit, where the orbit lies in the plume, and its motion."""
