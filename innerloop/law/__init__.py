"""The autopilot, nonlinear and linear."""
