"""Errors of guidance problems."""

from common.errors import RefusedError


class InfeasibleError(RefusedError):
    """The problem has no solution that can be flown.

    The message names the quantity, its value, the limit and the remedy.
    """
