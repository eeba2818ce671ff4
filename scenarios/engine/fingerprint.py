"""The software that results depend on: versions of packages, and the project's own source."""

import functools
import hashlib
import importlib.metadata
import platform
from collections.abc import Mapping
from pathlib import Path

_PACKAGES = ("jsbsim", "numpy", "scipy", "control", "slycot", "pydantic", "cma")
_SOURCE = ("aircraft", "common", "gnc", "innerloop", "scenarios")


@functools.cache
def fingerprint() -> dict[str, str]:
    """Return the versions of Python and of the packages that results depend on, and a hash of the project's source."""
    versions = {package: importlib.metadata.version(package) for package in _PACKAGES}
    digest = hashlib.sha256()
    project = Path(__file__).parents[2]
    for package in _SOURCE:
        for path in sorted((project / package).rglob("*.py")):
            digest.update(str(path.relative_to(project)).encode())
            digest.update(path.read_bytes())
    return {"python": platform.python_version(), **versions, "source": digest.hexdigest()[:16]}


def differences(theirs: Mapping[str, str]) -> list[str]:
    """Return the names of the entries in which another fingerprint differs from that of this program."""
    return [name for name, mine in fingerprint().items() if theirs.get(name) != mine]
