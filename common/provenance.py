"""Software and host of a run for its manifest, without the machine's names and paths."""

import functools
import importlib.metadata
import os
import platform
import re
import shlex
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from common.command_line import PROGRAM
from common.registry import announced

_PACKAGES = (
    "jsbsim",
    "numpy",
    "scipy",
    "control",
    "slycot",
    "pandas",
    "pyarrow",
    "matplotlib",
    "pydantic",
    "typst",
)


_FOLDERS = re.compile(r"""(?<![^\s=,'"\[({])(?:~|[A-Za-z]:)?[/\\](?:[^,'"\])}]*[/\\])?""")
"""Matches the folders of an absolute path, up to its last name."""


def without_folders(text: str) -> str:
    """Return a text with absolute paths shortened to their last name."""
    return _FOLDERS.sub("", text)


def command_line(module: str, given: Sequence[str]) -> str:
    """Return a command line for a shell, without hosts and without folders of absolute paths.

    Parameters
    ----------
    module : module that was run, unless it was the console command
    given : ``sys.argv``, the program and its arguments
    """
    # Options with the address of a cluster, or of a program that shows a flight.
    hosts = ("--scheduler", *(f"--{name.replace('_', '-')}" for name in announced("viewer")))
    program = PROGRAM if Path(given[0]).stem == PROGRAM else f"python -m {module}"
    shown = []
    is_host = False
    for argument in given[1:]:
        option, equals, _ = argument.partition("=")
        if is_host:
            text = "HOST:PORT"
        elif equals and option in hosts:
            text = f"{option}=HOST:PORT"
        else:
            text = without_folders(argument)
        shown.append(shlex.quote(text))
        is_host = argument in hosts
    return " ".join([program, *shown])


def provenance() -> dict[str, Any]:
    """Return versions of Python, packages and source, and the type of host."""
    return {
        "python": platform.python_version(),
        "platform": f"{platform.system()} {platform.machine()}",
        "cores": os.cpu_count(),
        "packages": dict(_versions()),
        "git_revision": _git_revision(),
    }


@functools.cache
def _versions() -> Mapping[str, str]:
    """Return the version of each package; the result is cached."""
    versions = {}
    for package in _PACKAGES:
        try:
            versions[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            versions[package] = "not installed"
    return versions


@functools.cache
def _git_revision() -> str:
    git = shutil.which("git")
    if git is None:
        return "unknown"
    here = Path(__file__).parent
    revision = subprocess.run(
        [git, "describe", "--always", "--dirty", "--abbrev=12"],
        cwd=here,
        capture_output=True,
        text=True,
        check=False,
    )
    return revision.stdout.strip() or "unknown"
