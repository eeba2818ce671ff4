"""The vehicles, and their sensors."""
