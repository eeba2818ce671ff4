"""Bad input to a run."""


class InputError(ValueError):
    """The user asked for something that cannot be run. The message is one line: what, its value,
    the limit, the remedy.
    """
