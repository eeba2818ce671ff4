"""Executes the tasks of a study in many processes, and keeps every result on disk as it arrives."""
