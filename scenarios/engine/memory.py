"""Memory limit and memory use of a process."""

import re
import sys
from pathlib import Path

if sys.platform != "win32":
    import resource


def limit_memory(limit: int | None) -> None:
    """Limit the data memory of this process to ``limit`` [bytes]; allocations beyond it raise
    MemoryError.

    Without effect on systems that have no such limit.
    """
    if limit is not None and sys.platform != "win32":
        _, hard = resource.getrlimit(resource.RLIMIT_DATA)
        resource.setrlimit(
            resource.RLIMIT_DATA,
            (limit if hard == resource.RLIM_INFINITY else min(limit, hard), hard),
        )


def data_memory() -> int:
    """Return the data memory of this process [bytes]; 0 if the system does not report it."""
    try:
        status = Path("/proc/self/status").read_text(encoding="ascii")
    except OSError:
        return 0
    found = re.search(r"^VmData:\s+(\d+) kB$", status, re.MULTILINE)
    return 1024 * int(found[1]) if found else 0


def peak_memory() -> float:
    """Return the peak resident memory of this process [bytes]; 0 if the system does not report it."""
    if sys.platform == "win32":
        return 0.0
    unit = 1 if sys.platform == "darwin" else 1024
    return float(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit)
