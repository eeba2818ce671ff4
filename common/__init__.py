"""Shared by all rooms: registries, files, the layout of run directories, command lines, provenance;
units and places.
"""
