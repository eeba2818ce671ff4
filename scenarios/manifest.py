"""What a run says about itself."""

import hashlib
import importlib.metadata
import json
import platform
import shutil
import subprocess
from pathlib import Path
from typing import Any

from scenarios.config import Scenario

_PACKAGES = ("jsbsim", "numpy", "scipy", "control", "slycot", "pandas", "pyarrow", "matplotlib", "plotly", "pydantic", "typst")


def config_hash(scenario: Scenario) -> str:
    """Return a hash of everything in the scenario that the result depends on."""
    text = json.dumps(scenario.model_dump(mode="json"), sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


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
