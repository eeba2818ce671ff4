"""Command line: ``python -m innerloop.design AIRCRAFT`` designs an autopilot, prints, reports and writes it out for JSBSim."""

import json
import os
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from common.command_line import BAD_INPUT, INTERRUPTED, run_command
from common.run_layout import DESIGN_RECORD, MANIFEST, MODEL

if TYPE_CHECKING:
    from innerloop.designs.record import Record
    from reports.document.blocks import Table


def command(
    aircraft: Annotated[str | None, typer.Argument(metavar="AIRCRAFT", help="What to design for, e.g. x8.")] = None,
    out: Annotated[Path | None, typer.Option(help="Directory for the design; default runs/design-AIRCRAFT.")] = None,
    altitude: Annotated[float, typer.Option(min=10.0, max=5000.0, help="Design altitude in metres.")] = 100.0,
    no_report: Annotated[bool, typer.Option("--no-report", help="Leave out report.html and report.pdf.")] = False,
    list_aircraft: Annotated[
        bool, typer.Option("--list", help="Say of every aircraft whether it can be flown, or why not, and exit.")
    ] = False,
) -> None:
    """Design the autopilot of an aircraft: trim, poles, margins, step responses; a report, and a JSBSim root that flies it."""
    from aircraft.errors import AircraftError
    from reports.errors import ReportError

    if list_aircraft:
        _list(altitude)
        return
    if aircraft is None:
        print("error: no aircraft given; `--list` names those there are", file=sys.stderr)
        raise typer.Exit(BAD_INPUT)
    try:
        _design(aircraft, out or Path("runs") / f"design-{aircraft}", altitude, no_report=no_report)
    except (AircraftError, ReportError) as error:
        print(f"error: {error}", file=sys.stderr)
        raise typer.Exit(BAD_INPUT) from None
    except OSError as error:
        print(f"error: '{error.filename}' cannot be written: {error.strerror}; choose another --out", file=sys.stderr)
        raise typer.Exit(BAD_INPUT) from None


def _list(altitude: float) -> None:
    """Print a line for every aircraft, as soon as it is known."""
    from innerloop.designs.listing import discover

    print("designing every aircraft that is not remembered; the first time, some minutes", file=sys.stderr)
    flown = 0
    try:
        for found in discover(altitude, os.cpu_count() or 1):
            flown += found.flies
            print(f"{'flies' if found.flies else '-':6}{found.name:18}{found.text}", flush=True)
    except KeyboardInterrupt:
        print("interrupted; what was designed is remembered, and the list goes on from there", file=sys.stderr)
        raise typer.Exit(INTERRUPTED) from None
    print(f"{flown} can be flown", file=sys.stderr)


def _design(aircraft: str, out: Path, altitude: float, *, no_report: bool) -> None:
    from aircraft.fleet.find import find_spec

    spec = find_spec(aircraft)
    _refuse_another_run(out)

    from common.files import write_json
    from innerloop.designs.cache import designed
    from innerloop.designs.manifest import design_manifest
    from innerloop.jsbsim.root import write_root
    from innerloop.jsbsim.script import write_script
    from reports.build import build_reports

    print(f"designing the autopilot of {spec.title}", file=sys.stderr)
    started = time.monotonic()
    out.mkdir(parents=True, exist_ok=True)
    found = designed(spec, altitude)
    record = found.record
    write_script(found.design.schedule, write_root(found.design.schedule, out / MODEL))
    write_json(out / DESIGN_RECORD, record)
    write_json(out / MANIFEST, design_manifest(record, wall_time=time.monotonic() - started))
    _print(record)
    print(f"\ndesign: {out}\nJSBSim root with the autopilot: {out / 'model'}")
    for path in () if no_report else build_reports(out):
        print(f"report: {path}")


def _refuse_another_run(out: Path) -> None:
    """Refuse a directory that holds flights: their manifest would be lost. An older design may be replaced."""
    from aircraft.errors import AircraftError

    try:
        study = json.loads((out / MANIFEST).read_text(encoding="utf-8")).get("study")
    except FileNotFoundError:
        return
    except (ValueError, AttributeError):
        study = None
    if study != "design":
        raise AircraftError(f"output directory '{out}' holds another run; choose another --out")


def _print(record: "Record") -> None:
    from rich.console import Console

    from reports.design.data import at_middle, complete, excess_overshoot
    from reports.design.tables import extreme_trims, pole_table, robustness_table, step_table, trim_table, worst_margin_table
    from reports.design.verdict import design_verdict

    design = complete(record)
    tables = [
        ("Equilibria", trim_table(extreme_trims(design))),
        ("Poles of the grid", pole_table(design)),
        (f"Poles at {design['design_airspeed_mps']:g} m/s in level flight [1/s]", _poles(at_middle(design, design["poles"])[0])),
        ("Margins, the worst of the grid; servos, engine and computing delay included", worst_margin_table(design)),
        *([("Margins of perturbed aircraft, the worst of loops and grid", robustness_table(design))] * bool(design["robustness"])),
        ("Step responses", step_table(design)),
    ]
    console = Console(width=None if sys.stdout.isatty() else 140)
    console.print(f"[bold]{record['title']}[/bold], designed at {record['altitude_m']:g} m. {record['source']}")
    for title, table in tables:
        console.print()
        console.print(_console_table(title, table))
    console.print(f"\nFlown heading rate lags its command by {record['heading_rate_lag_s']:.3f} s.")
    excess = excess_overshoot(design)
    if excess is not None:
        console.print(f"A heading-rate step overshoots its reference model by {100.0 * excess:.1f} %.")
    verdict = design_verdict(design)
    for line in (verdict.headline, *verdict.failures):
        console.print(line, markup=False, highlight=False)


def _poles(poles: "Record") -> "Table":
    from reports.document.blocks import Table

    names = {"open_loop": "aircraft", "closed_loop": "under the autopilot"}
    rows = [[name, "  ".join(_pole(*p) for p in poles[kind] if p[1] >= 0.0)] for kind, name in names.items()]
    return Table(head=["", ""], rows=rows, widths=[1.0, 4.0], left_columns=2)


def _pole(real: float, imaginary: float) -> str:
    return f"{real:.2f}±{imaginary:.2f}j" if imaginary else f"{real:.3g}"


def _console_table(title: str, table: "Table") -> Any:
    """Return a table of the report for the console."""
    from rich.table import Table as ConsoleTable
    from rich.text import Text

    printed = ConsoleTable(title=Text(title), title_justify="left", box=None, pad_edge=False)
    for i, name in enumerate(table.head):
        printed.add_column(Text(name), justify="left" if i < table.left_columns else "right")
    for row in table.rows:
        printed.add_row(*(Text(cell) for cell in row))
    return printed


def main() -> None:
    """Entry point."""
    run_command(command, "python -m innerloop.design")


if __name__ == "__main__":
    main()
