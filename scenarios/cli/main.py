"""Console command: ``plume-flight
run|design|estimate|calibrate|report|export|compare|describe|new|schema``. Each command calls the
module that does the work.
"""

import importlib
import importlib.metadata
import importlib.util
import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

from common.command_line import PROGRAM, refuse, run_command
from common.registry import announced, load_announced
from reports.build import FlightOption, StreamOption


def export(
    directory: Annotated[
        Path, typer.Argument(metavar="RUN_DIR", help="A directory that plume-flight run wrote.")
    ],
    to: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME,...",
            help="Formats, as kmz, geojson, netcdf or tracks_csv, those of extensions, or"
            " FILE.py:NAME.",
        ),
    ] = None,
    flight: FlightOption = None,
    stream: StreamOption = None,
) -> None:
    """Write the flights of a run in other formats, into RUN_DIR/export, or send one in real
    time.
    """
    from reports.build import command

    if not (to or stream):
        raise typer.Exit(
            refuse(
                "nothing to export; give --to NAME,..., as in --to kmz, or --stream udp://HOST:PORT"
            )
        )
    command(directory, export=to, flight=flight, stream=stream)


def estimate(
    flight: Annotated[
        Path,
        typer.Argument(
            metavar="FLIGHT.csv", help="Log with time_s, so2_ppb, co2_ppm, and optional columns."
        ),
    ],
    config: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.toml", help="Instrument, columns, limits; default an unknown instrument."
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR",
            help="Directory of files and report.",
            show_default="runs/measurement_FLIGHT",
        ),
    ] = None,
    ais: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="AIS reports of the ship, which the log has to lie beside."
        ),
    ] = None,
    mmsi: Annotated[
        int | None,
        typer.Option(
            metavar="NUMBER",
            help="The ship in that file.",
            show_default="flight.mmsi of the configuration",
        ),
    ] = None,
    calibration: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="FILE",
            help="Calibration of `plume-flight calibrate`; one, or one before and one after.",
        ),
    ] = None,
    record: Annotated[
        Path | None,
        typer.Option(metavar="FILE.json", help="Record to hand over, with a CSV beside it."),
    ] = None,
    picture: Annotated[
        list[Path] | None,
        typer.Option(metavar="FILE", help="Picture that the record names; may be repeated."),
    ] = None,
    no_report: Annotated[
        bool, typer.Option("--no-report", help="Do not write report.html and report.pdf.")
    ] = False,
) -> None:
    """Estimate the sulphur content of a ship's fuel from the log of a flight through its plume, and
    judge it.

    Other gases that the log has are estimated as well.
    """
    from measurement.log.command import main as estimate_logged
    from scenarios.cli.ship import read_ship

    options = [
        *(("--config", config), ("--out", out), ("--ais", ais), ("--mmsi", mmsi)),
        *(("--calibration", path) for path in calibration or ()),
        ("--record", record),
        *(("--picture", path) for path in picture or ()),
    ]
    given = [f"{name}={value}" for name, value in options if value is not None]
    # A name may begin with a dash; it is not an option.
    words = [*given, *(["--no-report"] if no_report else []), "--", str(flight)]
    raise typer.Exit(estimate_logged(words, read_ship=read_ship))


def calibrate(
    log: Annotated[
        Path,
        typer.Argument(
            metavar="ZERO_AND_SPAN.csv",
            help="Readings beside what was supplied, as so2_ppb and so2_supplied_ppb.",
        ),
    ],
    instrument: Annotated[
        str, typer.Option(metavar="NAME", help="Preset, or the title of the instrument's table.")
    ],
    serial: Annotated[str, typer.Option(help="Number of the instrument.")] = "",
    time: Annotated[
        str | None,
        typer.Option(metavar="UTC", help="Of the first reading, where the log has no date."),
    ] = None,
    span_sd_percent: Annotated[
        float, typer.Option(help="Standard uncertainty of the span gas [%].")
    ] = 1.0,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.json",
            help="Calibration to write.",
            show_default="ZERO_AND_SPAN.calibration.json",
        ),
    ] = None,
) -> None:
    """Find gain, offset, drift, t90 and delay of a sniffer in a log of zero and span gas, for
    estimates.
    """
    from measurement.log.calibrate_command import main as calibrate_logged

    options = [("--serial", serial), ("--time", time), ("--out", out)]
    given = [f"{name}={value}" for name, value in options if value]
    given += [f"--instrument={instrument}", f"--span-sd-percent={span_sd_percent}"]
    raise typer.Exit(calibrate_logged([*given, "--", str(log)]))


def describe(
    key: Annotated[
        str | None,
        typer.Argument(
            metavar="KEY|SECTION",
            help="Such as wind.speed_mps or wind; lists the sections if left out.",
        ),
    ] = None,
) -> None:
    """Say what a key of the scenario file means, its unit, range and default, and the studies that
    take it.
    """
    from scenarios.cli.describe import described
    from scenarios.errors import InputError

    try:
        for line in described(key):
            print(line)
    except InputError as error:
        raise typer.Exit(refuse(error)) from None


def new(
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE.toml", help="The file to write; an existing file is not overwritten."
        ),
    ],
    source: Annotated[
        str,
        typer.Option("--from", metavar="NAME|FILE.toml", help="The scenario that it is made from."),
    ] = "sweep_nu",
) -> None:
    """Write a scenario file with every key, its meaning, unit, range and default, and with the
    values of another scenario.

    Its flights have other seeds, which follow from the name of the file, unless nu is swept or the
    file is called as the scenario.
    """
    from scenarios.cli.template import write_template
    from scenarios.errors import InputError

    try:
        write_template(file, source)
    except InputError as error:
        raise typer.Exit(refuse(error)) from None
    print(f"scenario: {file}")


def schema() -> None:
    """Print a JSON Schema of scenario files, with which an editor completes their keys, shows what
    they mean, and marks a wrong one.
    """
    from scenarios.cli.schema import file_schema

    print(json.dumps(file_schema(), indent=2, ensure_ascii=False))


def commands() -> dict[str, Callable[..., None]]:
    """Return the commands by their words, last those that installed packages announce in the group
    ``plume_flight_study.command``; each is a function with options as typer has them.
    """
    from innerloop.design import command as design
    from reports.build import command as report
    from scenarios.run import command as run

    found: dict[str, Callable[..., None]] = {
        "run": run,
        "design": design,
        "estimate": estimate,
        "calibrate": calibrate,
        "report": report,
        "export": export,
    }
    if importlib.util.find_spec("reports.compare"):
        found["compare"] = importlib.import_module("reports.compare.__main__").command
    added = {word: load_announced("command", word) for word in sorted(announced("command"))}
    return {**found, "describe": describe, "new": new, "schema": schema, **added}


def main() -> None:
    """Entry point."""
    # As in scenarios.run: small matrices in several processes need no threads of their own.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    run_command(commands(), PROGRAM, importlib.metadata.version("plume-flight-study"))
