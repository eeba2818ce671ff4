"""Command line: ``python -m measurement.estimate FLIGHT.csv`` estimates the fuel sulphur content of
a logged flight.
"""

import argparse
import contextlib
import sys
from collections.abc import Iterator
from pathlib import Path

from measurement.errors import MeasurementError
from measurement.estimate.flight_log.analysis import analyse
from measurement.estimate.flight_log.config import LogConfig, read_config
from measurement.estimate.flight_log.csv_file import read_flight
from measurement.estimate.flight_log.run_files import (
    build_report,
    refuse_another_log,
    refuse_another_run,
    write_run,
)
from measurement.estimate.flight_log.words import lacking, summary, unused

BAD_INPUT = 2
"""Exit status of input that cannot be used."""

_CONSOLE = "plume-flight"
"""The project's command, one of whose sub-commands this is."""


def main(arguments: list[str] | None = None) -> int:
    """Estimate, print, write; return the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m measurement.estimate",
        description="Estimate the fuel sulphur content of a ship from a flight through its plume.",
        epilog="Exit status: 0 done, 2 bad input.",
    )
    parser.add_argument(
        "flight",
        type=Path,
        metavar="FLIGHT.csv",
        help="time_s, so2_ppb, co2_ppm, and where known no_ppb, no2_ppb, place and height",
    )
    parser.add_argument(
        "--config",
        type=Path,
        metavar="TOML",
        help="instrument, columns, limits; without it the instrument counts as unknown",
    )
    parser.add_argument(
        "--out",
        type=Path,
        metavar="DIR",
        help="directory of files and report; default runs/measurement_FLIGHT",
    )
    parser.add_argument("--no-report", action="store_true", help="write no report")
    given = parser.parse_args(arguments)
    directory = given.out or Path("runs") / f"measurement_{given.flight.stem}"
    try:
        refuse_another_run(directory)
        config = read_config(given.config) if given.config else LogConfig()
        with _naming(given.flight):
            flight = read_flight(given.flight, config)
        if given.out is None:
            refuse_another_log(directory, given.flight)
        with _naming(given.flight):
            analysis = analyse(
                flight.readings,
                config.instrument,
                method=config.method,
                carbon=config.carbon,
                limits_percent=config.limits_percent,
            )
        write_run(directory, flight, analysis, given.flight, given.config, _command(arguments))
    except MeasurementError as error:
        line = "".join(
            letter if letter.isprintable() else letter.encode("unicode_escape").decode()
            for letter in str(error)
        )
        print(f"error: {line}", file=sys.stderr)
        return BAD_INPUT
    more = (*lacking(flight, analysis), *unused(flight.readings, config.instrument))
    print(*summary(analysis, given.flight.name), *more, sep="\n")
    print(f"files: {directory}" if given.no_report else build_report(directory))
    return 0


@contextlib.contextmanager
def _naming(path: Path) -> Iterator[None]:
    """Name the file in a refusal of what is in it, where that does not."""
    try:
        yield
    except MeasurementError as error:
        where = "" if str(path) in str(error) else f"'{path}': "
        raise MeasurementError(f"{where}{error}") from None


def _command(arguments: list[str] | None) -> list[str]:
    """Return the program and its arguments: those of the console command where that hands on to
    this one.
    """
    console = Path(sys.argv[0]).stem == _CONSOLE
    return sys.argv if arguments is None or console else ["", *arguments]


if __name__ == "__main__":
    sys.exit(main())
