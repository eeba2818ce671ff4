"""The reference, the point to be tracked: shape, position and motion of its orbit."""
