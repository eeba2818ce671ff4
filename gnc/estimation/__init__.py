"""Own motion, wind, vessel and plume, estimated on board; and the detection of faults."""
