"""Wind, MIL-F-8785C turbulence and discrete gusts in JSBSim."""
