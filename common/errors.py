"""Errors that are told to the user in one line."""


class RefusedError(ValueError):
    """The input cannot be used.

    The message says in one line what is wrong with it: what, its value, the limit, the remedy.
    """


class PluginError(RefusedError):
    """A part of a user's own is unknown, does not load, or is not what it should be."""
