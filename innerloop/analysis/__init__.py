"""Margins, robustness and gust response of the linear loop."""
