"""Refusals of guidance problems that have no solution."""


class InfeasibleError(ValueError):
    """The problem has no solution that can be flown. The message names the quantity, its value, the limit and the remedy."""
