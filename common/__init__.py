"""Shared by all rooms: text, files, registries, run directories, command lines, physics."""
