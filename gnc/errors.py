"""Refusals of guidance problems that have no solution."""


class InfeasibleError(ValueError):
    """What is asked cannot be flown. The message names the quantity, its value, the limit and the remedy."""
