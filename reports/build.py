"""Command line: ``python -m reports.build RUN_DIR`` rebuilds a run's reports from what is on disk, or exports it."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from common.command_line import refuse, run_command
from common.run_layout import EXPORT, REPORT_HTML, REPORT_PDF, is_file_name

MISSING = 1
"""Exit status of reports that lack pieces of their run."""


def build_reports(
    directory: Path, *, all_flights: bool = False, tell_missing: Callable[[str], None] = lambda _: None
) -> list[Path]:
    """Write ``report.html`` and ``report.pdf`` into a run directory and return their paths.

    Parameters
    ----------
    directory : of the run
    all_flights : print every flight that can be picked on the screen, not the telling ones alone
    tell_missing : called with the path of each file of the run that is gone or cannot be read; the reports name it

    Raises
    ------
    ReportError : the directory holds no run that can be reported on, or cannot be written
    """
    from reports.registry import content
    from reports.render.html import write_html
    from reports.render.pdf import write_pdf
    from reports.run.run_data import read_run

    run = read_run(directory)
    print("building the report", file=sys.stderr)
    with _damage_named(directory):
        report = content(run)
    for name in run.missing():
        tell_missing(name)
    html = _written(directory / REPORT_HTML, partial(write_html, report))
    return [html, _written(directory / REPORT_PDF, partial(write_pdf, report, all_flights=all_flights))]


def export_run(directory: Path, name: str) -> Path:
    """Write a run by an exporter into its subdirectory ``export`` and return the path.

    Parameters
    ----------
    directory : of the run
    name : of the exporter, or ``FILE.py:NAME``

    Raises
    ------
    ReportError : the run cannot be read or written, or does not have what the format is about
    PluginError : there is no such exporter, or it does not load
    """
    from reports.errors import ReportError
    from reports.export import EXPORTERS
    from reports.run.run_data import read_run

    exporter = EXPORTERS.get(name)()
    run = read_run(directory)
    run_name, folder = run.manifest.get("name"), directory / EXPORT
    if not is_file_name(run_name):
        raise ReportError(f"'{directory}' is that of a run called {run_name!r}, which is no name of a file; do not use this run")
    if folder.is_symlink():
        raise ReportError(f"'{folder}' is a link; exports are written into '{directory}' alone: remove it")
    path = folder / f"{run_name}{exporter.suffix}"
    with _damage_named(directory):
        folder.mkdir(exist_ok=True)
        return _written(path, partial(exporter.write, run))


@contextmanager
def _damage_named(directory: Path) -> Iterator[None]:
    """Refuse a run in one line, where reading what it holds fails."""
    from reports.errors import ReportError

    try:
        yield
    except ReportError:
        raise
    except (LookupError, TypeError, ValueError, AttributeError, OSError) as error:
        what = f"{type(error).__name__}: {error}".splitlines()[0]
        raise ReportError(f"'{directory}' is damaged ({what}); run it again in another --out") from None


def _written(path: Path, write: Callable[[Path], object]) -> Path:
    """Write a file, whole or not at all, and return its path."""
    from common.files import write_whole
    from reports.errors import ReportError

    try:
        write_whole(path, write)
    except OSError as error:
        raise ReportError(f"'{path}' cannot be written: {error.strerror}; check permissions and space") from None
    return path


def print_design(record: dict[str, Any]) -> None:
    """Print the summary of an autopilot's design, given its record (``innerloop.json``)."""
    from reports.design.console import print_summary

    print_summary(record)


def command(
    directory: Annotated[Path, typer.Argument(metavar="RUN_DIR", help="A directory that scenarios.run or innerloop.design wrote.")],
    export: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="Write RUN_DIR/export/... by this exporter, or by FILE.py:NAME, instead of the reports."),
    ] = None,
    all_flights: Annotated[
        bool, typer.Option("--all-flights", help="Print every flight that report.html shows, not the telling ones alone.")
    ] = False,
) -> None:
    """Rebuild report.html and report.pdf of a run or of a design, without flying anything; or export a run.

    Exit status: 0 written, 1 written but pieces of the run are missing, 2 bad input.
    """
    from common.registry import PluginError
    from reports.errors import ReportError

    try:
        if export:
            for name in export:
                print(f"export: {export_run(directory, name)}")
        else:
            missing: list[str] = []
            for path in build_reports(directory, all_flights=all_flights, tell_missing=missing.append):
                print(f"report: {path}")
            for name in missing:
                print(
                    f"missing: {directory / name} is gone or cannot be read; the report says what it does not show", file=sys.stderr
                )
            if missing:
                raise typer.Exit(MISSING)
    except (ReportError, PluginError) as error:
        raise typer.Exit(refuse(error)) from None


def main() -> None:
    """Entry point."""
    run_command(command, "python -m reports.build")


if __name__ == "__main__":
    main()
