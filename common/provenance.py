"""Software and hosts of a run: recorded in its manifest, printed in its report. No name and no path
of a machine is.
"""

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


_HOSTS = ("--scheduler", "--flightgear")
"""Options whose values name a host."""

_FOLDERS = re.compile(r"""(?<![^\s=,'"\[({])(?:~|[A-Za-z]:)?[/\\](?:[^,'"\])}]*[/\\])?""")
"""The folders of an absolute path, up to its last name."""


def without_folders(text: str) -> str:
    """Return a text with the absolute paths in it cut to their last name."""
    return _FOLDERS.sub("", text)


def command_line(module: str, given: Sequence[str]) -> str:
    """Return a command line as a shell reads it, with no host and with absolute paths cut to their
    last name.

    Parameters
    ----------
    module : that was run, where it was not the console command
    given : ``sys.argv``: the program, and its arguments
    """
    program = PROGRAM if Path(given[0]).stem == PROGRAM else f"python -m {module}"
    shown = []
    host = False
    for argument in given[1:]:
        option, equals, _ = argument.partition("=")
        text = (
            "HOST:PORT"
            if host
            else f"{option}=HOST:PORT"
            if equals and option in _HOSTS
            else without_folders(argument)
        )
        shown.append(shlex.quote(text))
        host = argument in _HOSTS
    return " ".join([program, *shown])


def provenance() -> dict[str, Any]:
    """Return versions of Python, packages and source, and the kind of host."""
    return {
        "python": platform.python_version(),
        "platform": f"{platform.system()} {platform.machine()}",
        "cores": os.cpu_count(),
        "packages": dict(_versions()),
        "git_revision": _git_revision(),
    }


@functools.cache
def _versions() -> Mapping[str, str]:
    """Return the version of each package: those of a process stay what they are."""
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
