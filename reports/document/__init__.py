"""Blocks, charts, tables."""
