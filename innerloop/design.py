"""Command line: ``python -m innerloop.design AIRCRAFT`` designs an autopilot, prints, plots and writes it out for JSBSim."""

import json
import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from reports.command_line import BAD_INPUT, run_command

if TYPE_CHECKING:
    from innerloop.record import Record


def command(
    aircraft: Annotated[str, typer.Argument(metavar="AIRCRAFT", help="What to design for, e.g. x8.")],
    out: Annotated[Path | None, typer.Option(help="Directory for the design; default runs/design-AIRCRAFT.")] = None,
    altitude: Annotated[float, typer.Option(min=10.0, max=5000.0, help="Design altitude in metres.")] = 100.0,
) -> None:
    """Design the autopilot of an aircraft: trim, poles, margins, step responses; a JSBSim root that flies it."""
    from aircraft.errors import AircraftError

    try:
        _design(aircraft, out or Path("runs") / f"design-{aircraft}", altitude)
    except AircraftError as error:
        print(f"error: {error}", file=sys.stderr)
        raise typer.Exit(BAD_INPUT) from None
    except OSError as error:
        print(f"error: '{error.filename}' cannot be written: {error.strerror}; choose another --out", file=sys.stderr)
        raise typer.Exit(BAD_INPUT) from None


def _design(aircraft: str, out: Path, altitude: float) -> None:
    from aircraft.spec import find_spec

    spec = find_spec(aircraft)

    from innerloop.jsbsim_root import write_root
    from innerloop.record import design_record
    from innerloop.schedule import design_schedule
    from reports.innerloop_charts import innerloop_charts
    from reports.matplotlib_charts import draw

    print(f"designing the autopilot of {spec.title}", file=sys.stderr)
    out.mkdir(parents=True, exist_ok=True)
    schedule = design_schedule(spec, altitude=altitude)
    write_root(schedule, out / "model")
    record = design_record(schedule, out / "model")
    (out / "innerloop.json").write_text(json.dumps(record, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    _print(record)
    for chart in innerloop_charts(record):
        draw(chart).savefig(out / f"{chart.name}.png", dpi=150)
    print(f"\nplots and record: {out}\nJSBSim root with the autopilot: {out / 'model'}")


def _print(record: "Record") -> None:
    from rich.console import Console

    console = Console(width=None if sys.stdout.isatty() else 120)
    console.print(f"[bold]{record['title']}[/bold], designed at {record['altitude_m']:g} m. {record['source']}")
    for table in (_trims(record), _poles(record), _margins(record), _steps(record)):
        console.print()
        console.print(table)
    console.print(f"\nFlown heading rate lags its command by {record['heading_rate_lag_s']:.3f} s.")


def _table(title: str, head: tuple[str, ...], rows: list[list[str]]) -> Any:
    from rich.table import Table
    from rich.text import Text

    table = Table(title=Text(title), title_justify="left", box=None, pad_edge=False)
    for i, name in enumerate(head):
        table.add_column(Text(name), justify="left" if i == 0 else "right")
    for row in rows:
        table.add_row(*row)
    return table


def _trims(record: "Record") -> Any:
    head = ("airspeed [m/s]", "bank [deg]", "alpha [rad]", "sideslip [rad]", "pitch [rad]", "elevator", "aileron", "throttle")
    rows = [
        [
            f"{t['airspeed_mps']:g}",
            f"{round(math.degrees(t['bank_rad']), 1) + 0.0:.1f}",
            *(f"{t[name]:.4f}" for name in ("alpha_rad", "sideslip_rad", "pitch_rad", "elevator", "aileron", "throttle")),
        ]
        for t in record["trims"]
    ]
    return _table("Equilibria", head, rows)


def _poles(record: "Record") -> Any:
    rows = [
        [f"{poles['airspeed_mps']:g}", kind.replace("_", " "), "  ".join(_pole(*p) for p in poles[kind] if p[1] >= 0.0)]
        for poles in record["poles"]
        if poles["airspeed_mps"] == record["design_airspeed_mps"]
        for kind in ("open_loop", "closed_loop")
    ]
    return _table("Poles [1/s]", ("airspeed [m/s]", "", "poles"), rows)


def _pole(real: float, imaginary: float) -> str:
    return f"{real:.2f}±{imaginary:.2f}j" if imaginary else f"{real:.3g}"


def _margins(record: "Record") -> Any:
    head = ("airspeed [m/s]", "loop opened at", "gain [dB]", "phase [deg]", "disk gain [dB]", "disk phase [deg]")
    rows = [
        [
            f"{m['airspeed_mps']:g}",
            m["loop"].replace("_", " "),
            *("-" if m[k] is None else f"{m[k]:.1f}" for k in ("gain_db", "phase_deg", "disk_gain_db", "disk_phase_deg")),
        ]
        for m in record["margins"]
    ]
    return _table("Margins, servos, propeller and computing delay included", head, rows)


def _steps(record: "Record") -> Any:
    head = ("step [rad/s, m/s, m]", "", "rise [s]", "overshoot [%]", "altitude moves [m]", "airspeed moves [m/s]")
    rows = [
        [
            f"{r['command'].replace('_', ' ')} {r['size']:g}",
            r["kind"],
            "-" if r["rise_time_s"] is None else f"{r['rise_time_s']:.2f}",
            f"{100.0 * r['overshoot']:.1f}",
            f"{r['altitude_largest_m']:.3f}",
            f"{r['airspeed_largest_mps']:.3f}",
        ]
        for r in record["responses"]
    ]
    return _table("Step responses", head, rows)


def main() -> None:
    """Entry point."""
    run_command(command, "python -m innerloop.design")


if __name__ == "__main__":
    main()
