"""``make fast``: compile what guidance and closed loop spend their time in by mypyc.

A compiled module computes what its source does, to the last bit: a test compares flights. What is
compiled takes numbers alone. What takes arrays, or what parts of a user's own extend, is left out.
All is one library: calls within it cost least.
"""

import os
import shutil
import sys
import tempfile
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path

from mypyc.build import mypycify
from setuptools import Distribution
from setuptools.errors import BaseError, CompileError, LinkError

from common.files import write_json
from gnc.compiled import FOLDER, INDEX, ROOT, sources_hash

MODULES = {
    "gnc": (
        "guidance", "numeric", "steering", "tracker", "unicycle",
        "airspeed",
        "estimation/error_budget", "estimation/health", "estimation/navigation",
        "estimation/thrust", "estimation/vessel",
        "paper",
        "mission/follow", "mission/mission", "mission/standoff", "mission/track", "mission/way",
        "reference/moving_centre", "reference/oscillating", "reference/steered",
        "guard/guard", "guard/turn",
    ),
    "scenarios": (
        "flight/closed_loop", "flight/ending", "flight/record",
        "vehicles/jsbsim",
    ),
}  # fmt: skip
"""Modules that are compiled, by package."""

_MYPY = ("--config-file=", "--ignore-missing-imports", "--follow-imports=silent")
"""Types are checked by `make check`, with what is installed; here they are only read."""

_SAME_ARITHMETIC = "-ffp-contract=off"
"""Compiler's option: a product and a sum stay two operations with a rounding each, on every kind of
processor.
"""


def main() -> int:
    """Compile the modules; return the exit status."""
    sources = sources_hash()
    with tempfile.TemporaryDirectory() as folder:
        try:
            built = build(Path(folder))
        except (BaseError, CompileError, LinkError) as error:
            remedy = (
                "it needs a C compiler and the headers of Python (Debian: apt install gcc"
                " python3-dev)"
            )
            print(
                f"error: guidance and closed loop cannot be compiled: {error}; {remedy}",
                file=sys.stderr,
            )
            return 2
        except KeyboardInterrupt:
            print("interrupted; nothing is compiled", file=sys.stderr)
            return 130
        shutil.rmtree(FOLDER, ignore_errors=True)
        shutil.copytree(built, FOLDER)
    files = sorted(file.relative_to(FOLDER).as_posix() for file in FOLDER.rglob("*.*"))
    modules = {file.removesuffix(EXTENSION_SUFFIXES[0]).replace("/", "."): file for file in files}
    # Of the sources as they were before: one that was edited meanwhile is noticed.
    write_json(INDEX, {"sources": sources, "modules": modules})
    count = sum(len(names) for names in MODULES.values())
    print(
        f"{count} modules of guidance and closed loop are compiled; they are run until a source"
        " of the program is edited"
    )
    return 0


def build(folder: Path) -> Path:
    """Compile the modules in a folder of their own; return the one that holds them by packages."""
    files = [
        str(ROOT / package / f"{name}.py") for package, names in MODULES.items() for name in names
    ]
    options = [*_MYPY, "--cache-dir", str(folder / "cache")]
    extensions = mypycify([*options, *files], opt_level="3", target_dir=str(folder / "c"))
    for extension in extensions:
        extension.extra_compile_args.append(_SAME_ARITHMETIC)
    command = Distribution({"ext_modules": extensions}).get_command_obj("build_ext")
    command.build_lib, command.build_temp, command.parallel = (
        str(folder / "lib"),
        str(folder / "objects"),
        os.cpu_count(),
    )
    command.ensure_finalized()
    command.run()
    return folder / "lib"


if __name__ == "__main__":
    sys.exit(main())
