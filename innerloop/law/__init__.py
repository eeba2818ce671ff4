"""The control law of the autopilot, nonlinear and linear."""
