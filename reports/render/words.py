"""How sentences are broken into lines, the same on the screen and in print."""

import re

_UNIT = re.compile(r"(?<=\d) (?=(?:%|°|m|km|s|min|h|deg|dB|m/s|rad/s)(?![\w/]))|(?<=%) (?=m/m)")
"""The space between a number and its unit, and within one."""


def unbroken(sentence: str) -> str:
    """Return a sentence in which no line ends between a number and its unit."""
    return _UNIT.sub("\N{NO-BREAK SPACE}", sentence)
