"""The aircraft with its autopilot, and flight tests of it."""
