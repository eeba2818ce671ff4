"""Bad input to a report."""


class ReportError(ValueError):
    """A run directory cannot be reported on. The message is one line."""
