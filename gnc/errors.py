"""Errors of guidance problems and of steering laws."""


class InfeasibleError(ValueError):
    """The problem has no solution that can be flown.

    The message names the quantity, its value, the limit and the remedy.
    """


class LawError(ValueError):
    """A steering law did not return a heading rate.

    The message names the law, its result, and the result that it has to return.
    """
