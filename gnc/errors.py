"""Refusals of guidance problems that have no solution, and of steering laws that return no heading
rate.
"""


class InfeasibleError(ValueError):
    """The problem has no solution that can be flown. The message names the quantity, its value, the
    limit and the remedy.
    """


class LawError(ValueError):
    """A steering law did not return a heading rate. The message names the law, what it returned,
    and what it has to return.
    """
