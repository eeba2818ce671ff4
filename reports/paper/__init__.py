"""The three simulations against the printed numbers."""
