"""Dotted keys of configurations, such as ``vessel.speed_mps``."""


def at_or_below(key: str, above: str) -> bool:
    """Return whether a dotted key is another one, or below it: ``wind.speed_mps`` is below
    ``wind``.
    """
    return key == above or key.startswith(f"{above}.")
