"""The keys of a scenario file, their checks and their documentation."""
