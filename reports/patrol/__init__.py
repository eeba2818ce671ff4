"""The report of patrols."""
