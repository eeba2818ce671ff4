"""Data that stand in a page for its scripts."""

from typing import Any

from jinja2.utils import htmlsafe_json_dumps


def for_script(value: Any) -> str:
    """Return JSON for a script element: no text in it can end the element, nor begin a comment that
    hides its end.
    """
    return htmlsafe_json_dumps(value, separators=(",", ":"))
