"""Flights that were logged: their files, the analysis of them, and what it leaves."""
