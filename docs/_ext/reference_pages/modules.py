"""Every public name of a room of the house, from its docstrings: a page for each folder."""

import importlib
import pkgutil
from collections.abc import Iterator
from types import ModuleType

ROOMS = ("gnc", "measurement", "aircraft", "innerloop", "common")
"""Rooms whose modules are of use by themselves; what is for users of ``scenarios`` stands in a page
of its own.
"""


def module_pages() -> Iterator[tuple[str, str]]:
    """Yield the name of each page and its text."""
    for room in ROOMS:
        for package in _packages(room):
            yield package.__name__, _page(package)


def _packages(room: str) -> Iterator[ModuleType]:
    package = importlib.import_module(room)
    yield package
    for found in pkgutil.walk_packages(package.__path__, f"{room}."):
        if found.ispkg:
            yield importlib.import_module(found.name)


def _page(package: ModuleType) -> str:
    lines = [f"# {package.__name__}", "", *_automodule(package.__name__, members=False)]
    for found in pkgutil.iter_modules(package.__path__, f"{package.__name__}."):
        if not found.ispkg and not found.name.endswith("__main__"):
            lines += [
                f"## {found.name.rpartition('.')[2]}",
                "",
                *_automodule(found.name, members=True),
            ]
    return "\n".join(lines)


def _automodule(name: str, *, members: bool) -> list[str]:
    options = ["   :members:"] if members else []
    return ["```{eval-rst}", f".. automodule:: {name}", *options, "```", ""]
