"""How soon an estimate of the plume finds it, in flights of a point across simulated plumes."""
