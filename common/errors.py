"""Errors that the user sees as one line."""


class RefusedError(ValueError):
    """The input cannot be used.

    The message is one line with the quantity, its value, the limit and the remedy.
    """


class PluginError(RefusedError):
    """A user's part is unknown, does not load, or is invalid."""
