"""The run directory: what is on disk, read and written."""
