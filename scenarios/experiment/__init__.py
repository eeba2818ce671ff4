"""The flights of an experiment: sweep, cases, variants, draws."""
