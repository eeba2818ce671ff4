"""Software and host of a run, for its manifest and report, without names or paths of a machine."""

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
"""The folders of an absolute path, up to its last name."""


def without_folders(text: str) -> str:
    """Return a text in which absolute paths are cut to their last name."""
    return _FOLDERS.sub("", text)


def command_line(module: str, given: Sequence[str]) -> str:
    """Return a command line for a shell, without hosts, and absolute paths cut to their last name.

    Parameters
    ----------
    module : that was run, if it was not the console command
    given : ``sys.argv``: the program, and its arguments
    """
    # The address of a cluster, and of a program that shows a flight.
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
    """Return the version of each package; they do not change within a process."""
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
