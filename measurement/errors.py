"""Refusals of input from which nothing can be measured."""


class MeasurementError(ValueError):
    """The input cannot be used. The message is one line that names the quantity, its value, the limit and the remedy."""
