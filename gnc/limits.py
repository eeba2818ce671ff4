"""Keeping a value within its bounds, at a third of what ``min`` and ``max`` take: the guidance does it at every step."""


def limited(value: float, limit: float) -> float:
    """Return ``value`` kept within minus and plus ``limit``, which is above 0; what is not a number stays so."""
    if value > limit:
        return limit
    return -limit if value < -limit else value
