"""The command ``plume-flight calibrate ZERO_AND_SPAN.csv``: a calibration for estimates."""

import argparse
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path

from common.command_line import refuse
from measurement.errors import MeasurementError, check_range
from measurement.log.calibration import (
    SPAN_SD,
    CalibratedChannel,
    Calibration,
    calibrate,
    write_calibration,
)


def main(arguments: list[str] | None = None) -> int:
    """Calibrate, print and write.

    The exit status is 0, 1 for a calibration that must not be used, as with a leak, or 2 for bad
    input.
    """
    given = _parser().parse_args(arguments)
    out = given.out or given.log.with_suffix(".calibration.json")
    try:
        check_range("--span-sd-percent", given.span_sd_percent, 0.0, 50.0, " %")
        found = calibrate(
            given.log,
            instrument=given.instrument,
            serial=given.serial,
            time_utc=_time(given.time),
            span_sd=given.span_sd_percent / 100.0,
        )
        write_calibration(out, found)
    except MeasurementError as error:
        return refuse(error)
    for line in (*_lines(found), f"calibration: {out}"):
        print(line)
    return 1 if any(of.problems for of in found.channels.values()) else 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="plume-flight calibrate",
        description="Find gain, offset, drift, t90 and delay in a log of zero and span gas.",
        epilog="Exit status: 0 done, 1 a leak was found, 2 bad input.",
    )
    parser.add_argument("log", type=Path, metavar="ZERO_AND_SPAN.csv")
    parser.add_argument("--instrument", required=True, help="name of a preset, or title of a table")
    parser.add_argument("--serial", default="")
    parser.add_argument("--time", help="UTC of the first reading, where the log has no date")
    parser.add_argument("--span-sd-percent", type=float, default=100.0 * SPAN_SD)
    parser.add_argument("--out", type=Path, metavar="FILE.json")
    return parser


def _time(text: str | None) -> datetime | None:
    if text is None:
        return None
    try:
        time = datetime.fromisoformat(text)
    except ValueError:
        raise MeasurementError(
            f"--time is {text!r}; give a time of ISO 8601, as 2026-06-01T09:00:00Z"
        ) from None
    return time.astimezone(UTC) if time.tzinfo else time.replace(tzinfo=UTC)


def _lines(found: Calibration) -> Iterator[str]:
    """Yield what a calibration shows, in words."""
    number = f" number {found.serial}" if found.serial else ""
    yield f"'{found.instrument}'{number}, {found.time_utc:%Y-%m-%d %H:%M} UTC"
    for gas, channel in found.channels.items():
        yield f"{gas.upper()}: {_figures(channel)}"
        for line in (*channel.remarks, *channel.problems):
            yield f"  {line}"


def _figures(of: CalibratedChannel) -> str:
    return (
        f"gain {of.gain:.4f} ± {of.gain_sd:.4f}, offset {of.offset:.2f} ± {of.offset_sd:.2f}"
        f" {of.unit}, drift {of.gain_drift:+.4f} ± {of.gain_drift_sd:.4f} and"
        f" {of.offset_drift:+.2f} ± {of.offset_drift_sd:.2f} {of.unit} per hour, t90"
        f" {of.t90_s:.2f} ± {of.t90_sd_s:.2f} s, delay {of.delay_s:.2f} ± {of.delay_sd_s:.2f} s,"
        f" noise {of.noise:.2f} {of.unit} (1σ)"
    )
