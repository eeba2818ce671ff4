"""The one closed loop and its record."""
