"""Software of a run: recorded in its manifest, printed in its report."""

import importlib.metadata
import platform
import shutil
import subprocess
from pathlib import Path
from typing import Any

_PACKAGES = ("jsbsim", "numpy", "scipy", "control", "slycot", "pandas", "pyarrow", "matplotlib", "pydantic", "typst")


def provenance() -> dict[str, Any]:
    """Return versions of Python, packages and source, without any path of the machine."""
    versions = {}
    for package in _PACKAGES:
        try:
            versions[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            versions[package] = "not installed"
    return {
        "python": platform.python_version(),
        "platform": f"{platform.system()} {platform.machine()}",
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
