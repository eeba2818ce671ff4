"""Command line: ``python -m reports.build RUN_DIR`` rebuilds a run's reports from what is on disk, or exports it."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
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
    from reports.registry import content
    from reports.render.html import write_html
    from reports.render.pdf import write_pdf
    from reports.run.run_data import read_run

    run = read_run(directory)
    print("building the report", file=sys.stderr)
    with _damage_named(directory):
        report = content(run)
    return [
        _written(directory / name, partial(write, report)) for name, write in ((REPORT_HTML, write_html), (REPORT_PDF, write_pdf))
    ]


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
    from reports.export import EXPORTERS
    from reports.run.run_data import read_run

    exporter = EXPORTERS.get(name)()
    run = read_run(directory)
    (directory / "export").mkdir(exist_ok=True)
    path = directory / "export" / f"{run.manifest['name']}{exporter.suffix}"
    with _damage_named(directory):
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
) -> None:
    """Rebuild report.html and report.pdf of a run or of a design, without flying anything; or export a run."""
    from common.registry import PluginError
    from reports.errors import ReportError

    try:
        if export:
            for name in export:
                print(f"export: {export_run(directory, name)}")
        else:
            for path in build_reports(directory):
                print(f"report: {path}")
    except (ReportError, PluginError) as error:
        print(f"error: {error}", file=sys.stderr)
        raise typer.Exit(BAD_INPUT) from None


def main() -> None:
    """Entry point."""
    run_command(command, "python -m reports.build")


if __name__ == "__main__":
    main()
