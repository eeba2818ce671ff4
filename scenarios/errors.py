"""Bad input to a run."""

from common.errors import RefusedError


class InputError(RefusedError):
    """The input cannot be run. The message is one line: what, its value,
    the limit, the remedy.
    """
