"""The report of an arena of steering laws."""
