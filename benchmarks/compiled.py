"""``make fast``: compile what the guidance spends its time in by mypyc, each file to a module beside it.

A compiled module computes what its source does, to the last bit: a test compares flights. What is compiled takes numbers alone;
what takes arrays, is given what a user's own class returns, or is copied is left out.
"""

import os
import sys
import tempfile
from pathlib import Path

from mypyc.build import mypycify
from setuptools import Distribution
from setuptools.errors import BaseError

MODULES = (
    "numeric", "unicycle",
    "airspeed/along_track", "airspeed/pace_hold",
    "estimation/health", "estimation/health_monitor", "estimation/navigation", "estimation/own_motion", "estimation/target_motion",
    "estimation/vessel_filter", "estimation/wind_filter",
    "laws/delta",
    "mission/approach", "mission/direct_tracking", "mission/egress", "mission/mode", "mission/plume_following", "mission/transit",
    "reference/closing", "reference/moving_centre", "reference/orbit_tables", "reference/steered",
    "safety/closest_approach", "safety/free_commands", "safety/given_commands", "safety/guard_parameters",
    "safety/guarded_commands", "safety/keepout_guard", "safety/speed_reckoning", "safety/turn_prediction",
)  # fmt: skip
"""Modules of ``gnc`` that are compiled."""

_MYPY = ("--config-file=", "--ignore-missing-imports", "--follow-imports=silent")
"""Types are checked by `make check`, with what is installed; here they are only read."""

_SAME_ARITHMETIC = "-ffp-contract=off"
"""Compiler's option: a product and a sum stay two operations with a rounding each, on every kind of processor."""

_ROOM = Path(__file__).parents[1] / "gnc"


def main() -> int:
    """Compile the modules; return the exit status."""
    remove()
    files = [str(_ROOM / f"{name}.py") for name in MODULES]
    with tempfile.TemporaryDirectory() as folder:
        extensions = mypycify(
            [*_MYPY, "--cache-dir", folder, *files], opt_level="3", separate=True, target_dir=str(Path(folder) / "c")
        )
        for extension in extensions:
            extension.extra_compile_args.append(_SAME_ARITHMETIC)
        command = Distribution({"ext_modules": extensions}).get_command_obj("build_ext")
        command.inplace, command.build_temp, command.parallel = True, folder, os.cpu_count()
        try:
            command.ensure_finalized()
            command.run()
        except BaseError as error:
            remove()
            remedy = "it needs a C compiler and the headers of Python (Debian: apt install gcc python3-dev)"
            print(f"error: the guidance cannot be compiled: {error}; {remedy}", file=sys.stderr)
            return 2
    print(f"{len(MODULES)} modules of the guidance are compiled; they are run until a source of theirs is edited")
    return 0


def remove() -> None:
    """Remove what was compiled before, for any Python."""
    for form in (form for suffix in ("*.so", "*.pyd") for form in _ROOM.rglob(suffix)):
        form.unlink()


if __name__ == "__main__":
    sys.exit(main())
