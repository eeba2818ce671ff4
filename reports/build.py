"""Command line: ``python -m reports.build RUN_DIR`` rebuilds a run's reports from what is on disk,
or exports it.
"""

import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from common.command_line import refuse, run_command
from common.registry import is_file_part
from common.run_layout import EXPORT, NAME_BYTES_MAX, REPORT_HTML, REPORT_PDF, is_file_name

if TYPE_CHECKING:
    from reports.export.exporter import Exporter
    from reports.run.run_data import RunData

MISSING = 1
"""Exit status of reports that lack pieces of their run."""

_NAMED = 5
"""Flights that a message names at most."""


def build_reports(
    directory: Path,
    *,
    all_flights: bool = False,
    settings: Sequence[str] = (),
    tell_missing: Callable[[str], None] = lambda _: None,
) -> list[Path]:
    """Write ``report.html`` and ``report.pdf`` into a run directory and return their paths.

    Parameters
    ----------
    directory : of the run
    all_flights : print every flight that can be picked on the screen, and not only a selection
    settings : ``report.KEY=VALUE`` of title, author, organisation and logo, in place of those of
        the run
    tell_missing : called with the path of each file of the run that is gone or cannot be read; the
        reports name it

    Raises
    ------
    ReportError : the directory holds no run that can be reported on, or cannot be written; or a
        setting is none, or no picture
    """
    from reports.registry import content
    from reports.render.html import write_html
    from reports.render.pdf import write_pdf
    from reports.run.files import damage_named, failure_named, written
    from reports.run.letterhead import parse_settings
    from reports.run.run_data import read_run

    given = parse_settings(settings)
    run = read_run(directory)
    print("building the report", file=sys.stderr)
    with damage_named(directory):
        report = content(run, given)
    for name in run.missing():
        tell_missing(name)
    with failure_named(f"the report of '{directory}' could not be drawn"):
        html = written(directory / REPORT_HTML, partial(write_html, report))
        return [
            html,
            written(directory / REPORT_PDF, partial(write_pdf, report, all_flights=all_flights)),
        ]


def export_run(
    directory: Path,
    name: str,
    flight_id: str | None = None,
    *,
    tell_missing: Callable[[str], None] = lambda _: None,
) -> list[Path]:
    """Write a run by an exporter into its subdirectory ``export`` and return the paths.

    Parameters
    ----------
    directory : of the run
    name : of the exporter, or ``FILE.py:NAME``
    flight_id : of the only flight to be written; all of them if not given, each into a file of its
        own where the format holds one
    tell_missing : called with the path of each file of the run that is gone or cannot be read, and
        so is not in the export

    Raises
    ------
    ReportError : the run cannot be read or written, has no such flight, or does not have what the
        format is about
    PluginError : there is no such exporter, or it does not load
    """
    from reports.errors import ReportError
    from reports.run.files import damage_named, failure_named, written

    exporter = made_exporter(name)
    run, folder = _run_of(directory, flight_id), directory / EXPORT
    run_name = run.manifest.get("name")
    if not is_file_name(run_name):
        raise ReportError(
            f"'{directory}' is that of a run called {run_name!r}, which is no name of a file; do"
            " not use this run"
        )
    if folder.is_symlink():
        raise ReportError(
            f"'{folder}' is a link; exports are written into '{directory}' alone: remove it"
        )
    parts = {_stem(str(run_name), flight_id) if flight_id else str(run_name): run}
    if getattr(exporter, "one_flight", False) and (recorded := run.recorded()):
        parts = {_stem(str(run_name), flight): run.of_flight(flight) for flight in recorded}
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise ReportError(
            f"'{folder}' cannot be written: {error.strerror}; check permissions and space"
        ) from None
    # What fails in one of the user's own is no damage of the run.
    with failure_named(f"exporter '{name}'") if is_file_part(name) else damage_named(directory):
        paths = [
            written(folder / f"{stem}{exporter.suffix}", partial(exporter.write, part))
            for stem, part in parts.items()
        ]
    for file in sorted(run.unread) if flight_id else run.missing():
        tell_missing(file)
    return paths


def _stem(run_name: str, flight_id: str) -> str:
    """Return what the file of a flight is called: RUN.FLIGHT, or FLIGHT where that begins with the
    run's name or is long.
    """
    both = f"{run_name}.{flight_id}"
    return (
        flight_id
        if flight_id.startswith(f"{run_name}_") or len(both.encode()) > NAME_BYTES_MAX
        else both
    )


def made_exporter(name: str) -> "Exporter":
    """Return an exporter.

    Raises
    ------
    ReportError : a package is missing that it needs, or it has no suffix
    PluginError : there is no such exporter, or it does not load
    """
    from reports.errors import ReportError
    from reports.export import EXPORTERS
    from reports.run.files import failure_named

    part = EXPORTERS.get(name)
    with failure_named(f"exporter '{name}'"):
        exporter = part()
        suffix = getattr(exporter, "suffix", None)
        if not (isinstance(suffix, str) and suffix.startswith(".") and is_file_name(suffix)):
            raise ReportError(
                f"exporter '{name}' has suffix = {suffix!r}; it needs one with a leading dot and"
                " no slash, as '.csv'"
            )
    return exporter


def stream_run(
    directory: Path, address: str, flight_id: str | None = None
) -> tuple[str, int, float]:
    """Send a flight of a run to an address in real time; return its name, the number of messages,
    its duration [s].

    Raises
    ------
    ReportError : the run cannot be read, or has no such flight, or nothing can be sent to the
        address
    PluginError : what sends there does not load
    """
    from reports.export.exporter import stream_to
    from reports.export.geographic import recorded_flights
    from reports.run.files import damage_named

    stream = stream_to(address)
    run = _run_of(directory, flight_id)
    with damage_named(directory):
        flight = next(recorded_flights(run))
        seconds = float(flight.time[-1] - flight.time[0])
        print(
            f"streaming {flight.flight_id}, {seconds:.0f} s of flight, to {address}; Ctrl-C ends"
            " it",
            file=sys.stderr,
        )
        return flight.flight_id, stream.send(flight), seconds


def _run_of(directory: Path, flight_id: str | None) -> "RunData":
    """Return a run, or one flight of it."""
    from reports.errors import ReportError
    from reports.run.run_data import read_run

    run = read_run(directory)
    if flight_id is None:
        return run
    if flight_id not in (recorded := run.recorded()):
        known = ", ".join(recorded[:_NAMED]) + (", ..." if len(recorded) > _NAMED else "")
        raise ReportError(
            f"'{directory}' has no time history of a flight {flight_id[:80]!r}; it has those of"
            f" {known or 'none'}"
        )
    return run.of_flight(flight_id)


def check_settings(settings: Sequence[str]) -> None:
    """Refuse settings of a report before anything is computed for it.

    Raises
    ------
    ReportError : a setting is none, or its logo is no picture
    """
    from reports.run.letterhead import parse_settings

    parse_settings(settings)


def print_design(record: dict[str, Any]) -> None:
    """Print the summary of an autopilot's design, given its record (``innerloop.json``)."""
    from reports.design.console import print_summary

    print_summary(record)


FlightOption = Annotated[
    str | None, typer.Option(metavar="ID", help="Export or stream this flight alone.")
]
"""Which flight an export is of."""

StreamOption = Annotated[
    str | None,
    typer.Option(
        metavar="SCHEME://ADDRESS",
        help="Send a flight to another program in real time, as to udp://HOST:PORT.",
    ),
]
"""Where a flight is sent to."""


def command(
    directory: Annotated[
        Path,
        typer.Argument(
            metavar="RUN_DIR", help="A directory that plume-flight run or design wrote."
        ),
    ],
    export: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME,...",
            help=(
                "Write RUN_DIR/export/... by these exporters, or by FILE.py:NAME, instead of the"
                " reports."
            ),
        ),
    ] = None,
    flight: FlightOption = None,
    stream: StreamOption = None,
    overrides: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="report.KEY=VALUE",
            help="Title, author, organisation or logo of these reports; may be repeated.",
        ),
    ] = None,
    all_flights: Annotated[
        bool,
        typer.Option(
            "--all-flights",
            help="Print every flight that report.html shows, and not only a selection.",
        ),
    ] = False,
) -> None:
    """Rebuild report.html and report.pdf of a run or of a design, without flying anything; or
    export a run.

    Exit status: 0 written, 1 written but pieces of the run are missing, 2 bad input.
    """
    from common.errors import PluginError
    from reports.errors import ReportError

    missing: dict[str, None] = {}
    try:
        if flight is not None and not (export or stream):
            raise ReportError(
                "--flight is of use beside --export or --stream; reports are of the whole run:"
                " leave it out"
            )
        if overrides and (export or stream):
            raise ReportError(
                "--set is of the reports, which --export and --stream do not write: leave it out"
            )
        if export or stream:
            exporters = [name for names in export or () for name in names.split(",")]
            # Before any of them writes.
            for name in exporters:
                made_exporter(name)
            for name in exporters:
                for path in export_run(directory, name, flight, tell_missing=missing.setdefault):
                    print(f"export: {path}")
            if stream:
                sent, messages, seconds = stream_run(directory, stream, flight)
                print(
                    f"stream: {messages} messages of {sent}, {seconds:.0f} s of flight, to {stream}"
                )
        else:
            for path in build_reports(
                directory,
                all_flights=all_flights,
                settings=overrides or (),
                tell_missing=missing.setdefault,
            ):
                print(f"report: {path}")
    except (ReportError, PluginError) as error:
        raise typer.Exit(refuse(error)) from None
    lack = "the export lacks it" if export else "the report says what it does not show"
    for name in missing:
        print(f"missing: {directory / name} is gone or cannot be read; {lack}", file=sys.stderr)
    if missing:
        raise typer.Exit(MISSING)


def main() -> None:
    """Entry point."""
    run_command(command, "python -m reports.build")


if __name__ == "__main__":
    main()
