"""Bad input to a report."""

from common.errors import RefusedError


class ReportError(RefusedError):
    """A run directory cannot be reported on. The message is one line."""
