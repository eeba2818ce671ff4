"""Which flights: sweep, cases, variants, draws."""
