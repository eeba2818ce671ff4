"""Reports on a measured fuel sulphur content."""
