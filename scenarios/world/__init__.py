"""Truth outside the UAV: vessel, plume, weather, reports, faults."""
