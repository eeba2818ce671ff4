"""The world and the runs: vessel, plume, the one closed loop, metrics, sweeps and the command line."""
