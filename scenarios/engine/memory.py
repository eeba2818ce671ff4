"""What memory a process may have, and has."""

import re
import sys
from pathlib import Path

if sys.platform != "win32":
    import resource


def limit_memory(limit: int | None) -> None:
    """Let this process have no more than ``limit`` [bytes] of data from now on; beyond it there is a MemoryError.

    Without effect where the system has no such limit.
    """
    if limit is not None and sys.platform != "win32":
        _, hard = resource.getrlimit(resource.RLIMIT_DATA)
        resource.setrlimit(resource.RLIMIT_DATA, (limit if hard == resource.RLIM_INFINITY else min(limit, hard), hard))


def data_memory() -> int:
    """Return what this process has of what ``limit_memory`` limits [bytes]; 0 where the system does not say."""
    try:
        status = Path("/proc/self/status").read_text(encoding="ascii")
    except OSError:
        return 0
    found = re.search(r"^VmData:\s+(\d+) kB$", status, re.MULTILINE)
    return 1024 * int(found[1]) if found else 0


def peak_memory() -> float:
    """Return the most memory that this process has had [bytes]; 0 where the system does not say."""
    if sys.platform == "win32":
        return 0.0
    unit = 1 if sys.platform == "darwin" else 1024
    return float(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit)
