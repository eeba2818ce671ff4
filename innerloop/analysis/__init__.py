"""Margins, robustness, gust response of the linear loop."""
