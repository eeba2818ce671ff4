"""Pictures for the documentation: ``python -m benchmarks.pictures [NAME ...]`` makes the runs and
draws page 1 of each report.

Each picture is ``docs/pictures/NAME.png``. The runs are made anew, in a directory that is removed;
all of them take some minutes.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import pypdfium2
from PIL import Image

from common.run_layout import REPORT_PDF

_HOUSE = Path(__file__).parents[1]
_EXAMPLES = _HOUSE / "docs" / "examples"

COMMANDS = {
    "sweep": ("scenarios.run", "sweep_nu"),
    "monte_carlo": ("scenarios.run", "monte_carlo", "--set", "flights=64"),
    "sulphur": ("scenarios.run", "sulphur"),
    "measuring": (
        "measurement.estimate", str(_EXAMPLES / "example_flight.csv"), "--config", str(_EXAMPLES / "example_instrument.toml"),
    ),
    "design": ("innerloop.design", "x8"),
}  # fmt: skip
"""Module and arguments that make each run."""

FOLDER = _HOUSE / "docs" / "pictures"

WIDTH, COLOURS = 1000, 128
"""Width of a picture [px], and how many colours it has: few are enough, and make it small."""

SIZE_MAX = 250_000
"""Largest file of a picture."""

_FLOWN = (0, 1)
"""Exit statuses of runs that have a report: some of these flights do not meet every criterion."""


def draw_first_page(report: Path, picture: Path) -> int:
    """Draw page 1 of a PDF as a PNG file and return its size.

    Raises
    ------
    SystemExit : the file is larger than ``SIZE_MAX``
    """
    document = pypdfium2.PdfDocument(report)
    try:
        page = document[0]
        drawn = page.render(scale=WIDTH / page.get_width()).to_pil()
    finally:
        document.close()
    drawn.quantize(COLOURS, dither=Image.Dither.NONE).save(picture, optimize=True)
    if (size := picture.stat().st_size) > SIZE_MAX:
        raise SystemExit(
            f"error: '{picture.name}' has {size / 1000:.0f} kB, the limit is"
            f" {SIZE_MAX / 1000:.0f} kB; lower WIDTH"
        )
    return size


def make_picture(name: str, folder: Path) -> None:
    """Make the run of a name, and draw its report."""
    with tempfile.TemporaryDirectory() as directory:
        run = Path(directory) / name
        done = subprocess.run(
            [sys.executable, "-m", *COMMANDS[name], "--out", str(run)],
            check=False,
            stdout=subprocess.DEVNULL,
        )
        if done.returncode not in _FLOWN:
            raise SystemExit(
                f"error: the run for '{name}' ended with status {done.returncode}; see its"
                " message above"
            )
        folder.mkdir(parents=True, exist_ok=True)
        size = draw_first_page(run / REPORT_PDF, folder / f"{name}.png")
    print(f"{name}.png: {size / 1000:.0f} kB")


def main() -> None:
    """Entry point."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.pictures",
        description="Draw page 1 of reports for docs/pictures.",
    )
    parser.add_argument(
        "names",
        nargs="*",
        metavar="NAME",
        help=f"of {', '.join(COMMANDS)}; all of them if none is given",
    )
    names = parser.parse_args().names or list(COMMANDS)
    if unknown := [name for name in names if name not in COMMANDS]:
        parser.error(f"unknown picture '{unknown[0]}'; give one of {', '.join(COMMANDS)}")
    for name in names:
        make_picture(name, FOLDER)


if __name__ == "__main__":
    main()
