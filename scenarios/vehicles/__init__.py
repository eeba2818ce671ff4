"""The vehicles, their sensors and their payload."""
