"""Command line: ``python -m reports.compare RUN_A RUN_B [...]`` compares runs flight by flight."""

import hashlib
import os
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from common.command_line import refuse, run_command
from common.run_layout import MANIFEST

if TYPE_CHECKING:
    from reports.compare.content import Compared
    from reports.compare.pairs import Run

_NAME_MAX = 38
"""Letters of a run's name in that of the directory that is made beside it: six of them fit into the
name of a directory.
"""

_HASH_LETTERS = 8
"""Letters of the hash that tells runs apart whose names alone do not."""

HTML, PDF, TABLE = "compare.html", "compare.pdf", "differences.csv"
"""What is written."""


def compare_runs(paths: list[Path], out: Path | None) -> list[Path]:
    """Compare runs with the first, print the figures, and write report and table; return the paths.

    Parameters
    ----------
    paths : of the run directories
    out : where to write; beside the first run if not given

    Raises
    ------
    ReportError : a run cannot be compared, none of its flights is in the first, or nothing can be
        written there
    """
    from reports.compare.content import compare, comparison_content
    from reports.compare.pairs import read_runs
    from reports.compare.table_of_pairs import write_differences
    from reports.render.html import write_html
    from reports.render.pdf import write_pdf
    from reports.run.files import damage_named, written

    runs = read_runs(paths)
    directory = out or _beside([path.resolve() for path in paths])
    with damage_named(*paths):
        compared = compare(runs)
        report = comparison_content(runs, compared)
    # Runs that cannot be compared leave nothing behind.
    _make(directory)
    _print(runs, compared)
    return [
        written(directory / TABLE, partial(write_differences, compared)),
        written(directory / HTML, partial(write_html, report)),
        written(directory / PDF, partial(write_pdf, report)),
    ]


def _beside(paths: list[Path]) -> Path:
    """Return the directory beside the first run that is named after all of them; other runs have
    another one.
    """
    names = [path.name[:_NAME_MAX] for path in paths]
    if any(path != paths[0].parent / name for path, name in zip(paths, names, strict=True)):
        names.append(
            hashlib.sha256(b"\n".join(map(os.fsencode, paths))).hexdigest()[:_HASH_LETTERS]
        )
    return paths[0].parent / "-".join(["compare", *names])


def _make(directory: Path) -> None:
    """Make the directory that is written into.

    Raises
    ------
    ReportError : it is that of a run, or cannot be made
    """
    from reports.errors import ReportError

    if (directory / MANIFEST).exists():
        raise ReportError(
            f"--out '{directory}' is the directory of a run; name another one for the comparison"
        )
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ReportError(
            f"'{directory}' cannot be made: {error.strerror}; name another directory by --out"
        ) from None


def _print(runs: "Sequence[Run]", compared: "Sequence[Compared]") -> None:
    """Print what differs: keys, figures of whole runs, and of pairs of flights."""
    from reports.compare.configuration import configuration_table
    from reports.compare.content import difference_table, headline, pairing_sentences, side_by_side
    from reports.document.console import console_table, wide_console

    console = wide_console()
    keys = configuration_table(runs)
    for run in runs:
        console.print(f"{run.title}, {run.state}", markup=False, highlight=False)
    for title, table in (
        ("Keys that differ", keys),
        ("Figures of all flights", side_by_side(runs)),
    ):
        if table is not None:
            console.print()
            console.print(console_table(title, table))
    for of in compared:
        console.print(
            f"\n{of.pairs.other.letter}: {' '.join(pairing_sentences(of.pairs))}",
            markup=False,
            highlight=False,
        )
        if of.differing and (differences := difference_table(of.pairs, of.found)).rows:
            console.print(console_table("Differences of the flights of each pair", differences))
    console.print(f"\n{headline(compared)}", markup=False, highlight=False)


def command(
    runs: Annotated[
        list[Path],
        typer.Argument(
            metavar="RUN_DIR", help="Directories that plume-flight run wrote, two or more."
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            help="Where to write; compare-RUN_A-RUN_B... beside the first run if not given.",
        ),
    ] = None,
) -> None:
    """Compare runs with the first one: configuration, figures, and the flights that they have in
    common.

    Writes compare.html, compare.pdf and differences.csv. Exit status: 0 written, 2 bad input.
    """
    from reports.errors import ReportError

    try:
        for path in compare_runs(runs, out):
            print(f"comparison: {path}")
    except ReportError as error:
        raise typer.Exit(refuse(error)) from None


def main() -> None:
    """Entry point."""
    run_command(command, "python -m reports.compare")


if __name__ == "__main__":
    main()
