"""Command line: ``python -m innerloop.design AIRCRAFT`` designs an autopilot and reports on it."""

import json
import os
import shutil
import sys
import time
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from common.command_line import refuse, run_command
from common.run_layout import DESIGN_RECORD, FORMAT, MANIFEST, MODEL
from common.verdict import INTERRUPTED

if TYPE_CHECKING:
    from innerloop.store import Record

_RUNS = Path("runs")
"""Default directory of designs."""

_FLIES = {True: "flies", False: "-", None: "?"}
"""Marks in the list: the aircraft flies, cannot fly, or has not been designed yet."""


def command(
    aircraft: Annotated[
        str | None,
        typer.Argument(
            metavar="AIRCRAFT",
            help="The aircraft to design for, e.g. x8, c172x, DIR/NAME or FILE.py:NAME.",
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Directory for the design; default runs/design-AIRCRAFT.")
    ] = None,
    altitude: Annotated[
        float,
        typer.Option(
            min=10.0,
            max=5000.0,
            help="Design altitude in metres; flights at another altitude have another design.",
        ),
    ] = 100.0,
    no_report: Annotated[
        bool, typer.Option("--no-report", help="Leave out report.html and report.pdf.")
    ] = False,
    reversals: Annotated[
        int | None,
        typer.Option(
            min=1,
            max=1_000_000,
            help="Repeat the search for the worst turn reversal with this many, e.g. 10000.",
        ),
    ] = None,
    overrides: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="report.KEY=VALUE",
            help="Title, author, organisation or logo of the reports; may be repeated.",
        ),
    ] = None,
    aircraft_dir: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            help="Directory with your JSBSim models, DIR/NAME/NAME.xml, to take AIRCRAFT from.",
        ),
    ] = None,
    list_aircraft: Annotated[
        bool,
        typer.Option(
            "--list",
            help="List every known aircraft, or those of --aircraft-dir, and which can be flown.",
        ),
    ] = False,
    check: Annotated[
        bool,
        typer.Option(
            "--check",
            help="With --list: design every aircraft that was not designed before; takes minutes.",
        ),
    ] = False,
) -> None:
    """Design the autopilot of an aircraft; write a report and a JSBSim root that flies it.

    The report shows trim, poles, margins and step responses.
    """
    from aircraft.fleet.find import folder_path
    from aircraft.spec import AircraftError
    from reports.errors import ReportError

    try:
        if check and not list_aircraft:
            raise AircraftError(
                "--check is for --list, and designs every aircraft listed;"
                " leave it out, or add --list"
            )
        if list_aircraft:
            if aircraft is not None:
                raise AircraftError(
                    f"aircraft '{aircraft}' is given with --list, which lists all aircraft;"
                    " leave out one of them"
                )
            _list(altitude, aircraft_dir, check=check)
            return
        name = aircraft if aircraft_dir is None else folder_path(aircraft_dir, aircraft)
        if name is None:
            raise AircraftError("no aircraft given; `--list` lists the known ones")
        _design(name, out, altitude, reversals, overrides or [], no_report=no_report)
    except (AircraftError, ReportError) as error:
        raise typer.Exit(refuse(error)) from None
    except OSError as error:
        raise typer.Exit(refuse(_file_refusal(error, out or _RUNS))) from None


def _file_refusal(error: OSError, out: Path) -> str:
    """Return why a file cannot be used, and the remedy; ``out`` is the output directory."""
    if error.filename is None:
        return f"a file cannot be written: {error.strerror}; check the space on disk"
    path, written = Path(str(error.filename)).absolute(), out.absolute()
    if path.is_relative_to(written) or written.is_relative_to(path):
        return f"'{error.filename}' cannot be written: {error.strerror}; choose another --out"
    return (
        f"'{error.filename}' cannot be read: {error.strerror}; check the path and its permissions"
    )


def _list(altitude: float, directory: Path | None, *, check: bool) -> None:
    """Print one line per aircraft, as soon as it is known whether the aircraft can be flown."""
    from aircraft.fleet.find import aircraft_names, folder_names, folder_path
    from innerloop.listing import discover, look_up

    if directory is None:
        names = aircraft_names()
    else:
        names = [folder_path(directory, name) for name in folder_names(directory)]
    width = max(18, 1 + max(map(len, names)))
    if check:
        print(
            "designing every aircraft that was not designed before: some minutes the first time",
            file=sys.stderr,
        )
        known = discover(names, altitude, os.cpu_count() or 1)
    else:
        known = (look_up(name, altitude) for name in names)
    flying = 0
    waiting = 0
    try:
        for found in known:
            flying += found.flies is True
            waiting += found.flies is None
            print(f"{_FLIES[found.flies]:6}{found.name:{width}}{found.text}", flush=True)
    except KeyboardInterrupt:
        print(
            "interrupted; finished designs are cached, and the next --list continues from there",
            file=sys.stderr,
        )
        raise typer.Exit(INTERRUPTED) from None
    summary = f"{flying} can be flown at {altitude:g} m (--altitude for another altitude)"
    if waiting:
        summary += (
            f"; {waiting} {'was' if waiting == 1 else 'were'} not designed for it before:"
            " --list --check designs them, which takes minutes, and shows which can be flown"
        )
    print(summary, file=sys.stderr)


def _design(
    aircraft: str,
    out: Path | None,
    altitude: float,
    reversals: int | None,
    overrides: list[str],
    *,
    no_report: bool,
) -> None:
    from aircraft.fleet.find import find_spec
    from aircraft.user_check import check_user_aircraft
    from reports.build import build_reports, check_settings, print_design

    check_settings(overrides)
    spec = find_spec(aircraft)
    check_user_aircraft(spec)
    out = out or _RUNS / f"design-{spec.name}"
    _refuse_another_run(out)

    from common.files import remove_reports, write_json
    from common.provenance import command_line
    from innerloop.flight.turn_reversal import repeat_search
    from innerloop.jsbsim.script import write_script
    from innerloop.jsbsim.system import write_root
    from innerloop.store import designed

    print(f"designing the autopilot of {spec.title}", file=sys.stderr)
    started = time.monotonic()
    out.mkdir(parents=True, exist_ok=True)
    found = designed(spec, altitude)
    record = found.record
    # The directory may hold the design of another aircraft. The manifest is removed first and
    # written last, so that it always belongs to a complete design.
    remove_reports(out)
    if (out / MANIFEST).exists():
        shutil.rmtree(out / MODEL, ignore_errors=True)
        (out / MANIFEST).unlink()
    root = write_root(found.design.schedule, out / MODEL)
    write_script(found.design.schedule, root)
    if reversals:
        searched = repeat_search(
            found.design.schedule,
            record,
            root,
            reversals,
            done=lambda count, deviation: print(
                f"{count} of {reversals} reversals, largest deviation {deviation:.2f} m",
                file=sys.stderr,
            ),
        )
        record = record | {"turn_reversal": record["turn_reversal"] | {"repeated_search": searched}}
    write_json(out / DESIGN_RECORD, record, indent=None)
    command = command_line("innerloop.design", sys.argv)
    write_json(out / MANIFEST, _manifest(record, command, time.monotonic() - started))
    print_design(record)
    print(f"\ndesign: {out}\nJSBSim root with the autopilot: {root}")
    for path in () if no_report else build_reports(out, settings=overrides):
        print(f"report: {path}")


def _manifest(record: "Record", command_line: str, wall_time: float) -> dict[str, Any]:
    """Return the manifest of a design, with title, description and provenance for its report.

    ``wall_time`` is the duration of the design [s].
    """
    from common.provenance import provenance

    airspeeds = record["airspeeds_mps"]
    return {
        "format": FORMAT,
        "study": "design",
        "name": record["aircraft"],
        "title": f"Autopilot of the {record['title']}",
        "overrides": [],
        "state": "complete",
        "config": {
            "study": "design",
            "description": (
                f"Designed at {record['altitude_m']:g} m of altitude for {airspeeds[0]:.4g} to"
                f" {airspeeds[-1]:.4g} m/s: equilibria, linear models, gains, margins, and step"
                " responses flown in JSBSim."
            ),
            "aircraft": record["aircraft"],
            "altitude_m": record["altitude_m"],
        },
        **provenance(),
        "command": command_line,
        "begun_utc": f"{datetime.now(UTC) - timedelta(seconds=wall_time):%Y-%m-%dT%H:%M:%SZ}",
        "wall_time_s": wall_time,
    }


def _refuse_another_run(out: Path) -> None:
    """Refuse an output directory that holds a run with flights; a design may be overwritten."""
    from aircraft.spec import AircraftError

    try:
        study = json.loads((out / MANIFEST).read_text(encoding="utf-8")).get("study")
    except FileNotFoundError:
        return
    except (ValueError, AttributeError):
        study = None
    if study != "design":
        raise AircraftError(f"output directory '{out}' holds another run; choose another --out")


def main() -> None:
    """Entry point."""
    run_command(command, "python -m innerloop.design")


if __name__ == "__main__":
    main()
