"""Trim, linear models, envelope."""
