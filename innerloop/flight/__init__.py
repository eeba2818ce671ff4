"""The aircraft with its autopilot in JSBSim, and flight tests of both."""
