"""Command line: ``python -m reports.build RUN_DIR`` rebuilds a run's reports from what is on disk."""

import sys
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from common.command_line import BAD_INPUT, run_command
from common.run_layout import REPORT_HTML, REPORT_PDF


def build_reports(directory: Path) -> list[Path]:
    """Write ``report.html`` and ``report.pdf`` into a run directory and return their paths.

    Raises
    ------
    ReportError : the directory holds no run that can be reported on, or cannot be written
    """
    from common.files import write_whole
    from reports.errors import ReportError
    from reports.registry import content
    from reports.render.html import write_html
    from reports.render.pdf import write_pdf
    from reports.run.run_data import read_run

    run = read_run(directory)
    print("building the report", file=sys.stderr)
    try:
        report = content(run)
    except ReportError:
        raise
    except (LookupError, TypeError, ValueError, AttributeError, OSError) as error:
        what = f"{type(error).__name__}: {error}".splitlines()[0]
        raise ReportError(f"'{directory}' is damaged ({what}); run it again in another --out") from None
    paths = []
    for name, write in ((REPORT_HTML, write_html), (REPORT_PDF, write_pdf)):
        try:
            write_whole(directory / name, partial(write, report))
        except OSError as error:
            raise ReportError(f"'{directory / name}' cannot be written: {error.strerror}; check permissions and space") from None
        paths.append(directory / name)
    return paths


def print_design(record: dict[str, Any]) -> None:
    """Print the summary of an autopilot's design, given its record (``innerloop.json``)."""
    from reports.design.console import print_summary

    print_summary(record)


def command(
    directory: Annotated[Path, typer.Argument(metavar="RUN_DIR", help="A directory that scenarios.run or innerloop.design wrote.")],
) -> None:
    """Rebuild report.html and report.pdf of a run or of a design, without flying anything."""
    from reports.errors import ReportError

    try:
        for path in build_reports(directory):
            print(f"report: {path}")
    except ReportError as error:
        print(f"error: {error}", file=sys.stderr)
        raise typer.Exit(BAD_INPUT) from None


def main() -> None:
    """Entry point."""
    run_command(command, "python -m reports.build")


if __name__ == "__main__":
    main()
