"""Software and hosts of a run: recorded in its manifest, printed in its report. No name and no path of a machine is."""

import importlib.metadata
import os
import platform
import re
import shlex
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

_PACKAGES = ("jsbsim", "numpy", "scipy", "control", "slycot", "pandas", "pyarrow", "matplotlib", "pydantic", "typst")


_HOSTS = ("--scheduler", "--flightgear")
"""Options whose values name a host."""

_FOLDERS = re.compile(r"""(?<![^\s=,'"\[({])(?:~|[A-Za-z]:)?[/\\](?:[^,'"\])}]*[/\\])?""")
"""The folders of an absolute path, up to its last name."""


def command_line(module: str, arguments: Sequence[str]) -> str:
    """Return the command line of a module, as a shell reads it, with no host and with absolute paths cut to their last name."""
    shown = []
    host = False
    for argument in arguments:
        option, equals, _ = argument.partition("=")
        text = "HOST:PORT" if host else f"{option}=HOST:PORT" if equals and option in _HOSTS else _FOLDERS.sub("", argument)
        shown.append(shlex.quote(text))
        host = argument in _HOSTS
    return " ".join(["python -m", module, *shown])


def provenance() -> dict[str, Any]:
    """Return versions of Python, packages and source, and the kind of host."""
    versions = {}
    for package in _PACKAGES:
        try:
            versions[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            versions[package] = "not installed"
    return {
        "python": platform.python_version(),
        "platform": f"{platform.system()} {platform.machine()}",
        "cores": os.cpu_count(),
        "packages": versions,
        "git_revision": _git_revision(),
    }


def _git_revision() -> str:
    git = shutil.which("git")
    if git is None:
        return "unknown"
    here = Path(__file__).parent
    revision = subprocess.run(
        [git, "describe", "--always", "--dirty", "--abbrev=12"], cwd=here, capture_output=True, text=True, check=False
    )
    return revision.stdout.strip() or "unknown"
