"""How sure, how bad, what drives it."""
