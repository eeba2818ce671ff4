"""Where a plume is, how wide and how strong, from the readings of a gas sensor."""
