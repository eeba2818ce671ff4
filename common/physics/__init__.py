"""Units, places on the Earth, the wind, and what two rooms have to agree on about a turn."""
