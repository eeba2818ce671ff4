"""Wind, MIL-F-8785C turbulence, discrete gusts."""
