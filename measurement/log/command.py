"""The command ``plume-flight estimate FLIGHT.csv``: fuel sulphur content of a logged flight."""

import argparse
import math
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

from common.command_line import PROGRAM, refuse
from measurement.errors import MeasurementError, naming
from measurement.estimate.gas import SCREENING, GasEstimate, error_words, value_words
from measurement.estimate.gas import verdict_words as verdict_words_of
from measurement.estimate.result import Figures, FscEstimate
from measurement.estimate.verdict import (
    OPEN,
    content_words,
    decision_words,
    needed,
    next_step,
    rate_words,
    verdict_words,
)
from measurement.gases import ASSUMED_LEAST, FUEL_SULPHUR_MOST, GASES
from measurement.log.analysis import (
    Analysis,
    GasAnalysis,
    analyse,
    estimate_gases,
    find_gaps,
)
from measurement.log.calibration import read_calibration
from measurement.log.config import FlightDetails, LogConfig, read_config
from measurement.log.handover import NOT_APPROVED, record_of, write_record
from measurement.log.prepare import Prepared, prepare
from measurement.log.read import LoggedFlight, read_flight
from measurement.log.run_files import (
    build_report,
    check_directory,
    write_run,
)
from measurement.log.ship import ShipTrack
from measurement.sniffer.sniffer import Readings
from measurement.sniffer.spec import SnifferSpec

_ERRORS = {
    "calibration": "calibration of SO2 and CO2",
    "no": "correction for NO",
    "no2": "correction for NO2",
    "response": "response time and delay",
    "carbon": "carbon content of the fuel",
    "overlap": "passes that overlap",
    "sampling": "time between readings",
}
"""Names of the common errors in words."""


ReadShip = Callable[[Path, int | None], ShipTrack]
"""Reads the track of a ship from a file of AIS reports, by its MMSI if that is known."""


def main(arguments: list[str] | None = None, *, read_ship: ReadShip | None = None) -> int:
    """Estimate, print and write; return the exit status, 0 or 2 for bad input.

    ``read_ship`` reads a file of AIS reports; without it there is no option for one.
    """
    given = _parser(with_ship=read_ship is not None).parse_args(arguments)
    directory = given.out or Path("runs") / f"measurement_{given.flight.stem}"
    try:
        config = read_config(given.config) if given.config else LogConfig()
        ships = list(_ships(config.flight, given, read_ship))
        flight = read_flight(given.flight, config, ships)
        check_directory(directory, given.flight, named_after_log=given.out is None)
        calibrations = [read_calibration(path) for path in given.calibration]
        with naming(given.flight):
            prepared = prepare(flight, config, calibrations, ships)
            config = prepared.config
            if prepared.changed:
                flight = read_flight(given.flight, config, ships)
            gases, remarks = estimate_gases(
                flight.gases,
                config.declared,
                method=config.method,
                air=config.air,
                engine=config.engine,
                problems=prepared.problems,
                carbon=dict.fromkeys(config.species, config.carbon) if config.carbon_stated else {},
            )
            analysis = _analysed(flight, prepared, gases, remarks)
        write_run(directory, flight, analysis, given.flight, given.config, _command(arguments))
        handed = list(_handed_over(given, flight, analysis, prepared))
    except MeasurementError as error:
        return refuse(error)
    for line in (
        *_summary(analysis, given.flight.name),
        *_gases(analysis),
        *prepared.remarks,
        *handed,
        *_missing(flight, analysis),
        *(_unused_gases(flight.readings, config.instrument) if config.with_sulphur else ()),
        f"files: {directory}" if given.no_report else build_report(directory),
    ):
        print(line)
    return 0


def _analysed(
    flight: LoggedFlight,
    prepared: Prepared,
    gases: Sequence[GasEstimate],
    remarks: Sequence[str],
) -> Analysis | GasAnalysis:
    """Return the analysis of a flight, with SO2 or without.

    Raises
    ------
    MeasurementError : there are no readings, or they cannot be of a flight through a plume
    """
    config = prepared.config
    if not config.with_sulphur:
        if not gases:
            why = f": {'; '.join(remarks)}" if remarks else ""
            raise MeasurementError(
                f"columns.so2 is empty, and there is no other gas to compare with CO2{why}"
            )
        return GasAnalysis(
            gases=tuple(gases), gas_remarks=tuple(remarks), instrument=config.instrument
        )
    return analyse(
        flight.readings,
        config.instrument,
        method=config.method,
        carbon=config.carbon,
        limits_percent=config.limits_percent,
        rule=config.rule,
        problems=prepared.problems.get("so2", ()),
        gases=gases,
        gas_remarks=remarks,
    )


def _handed_over(
    given: argparse.Namespace,
    flight: LoggedFlight,
    analysis: Analysis | GasAnalysis,
    prepared: Prepared,
) -> Iterator[str]:
    """Write the record, if one is wanted, and yield a line on it.

    Raises
    ------
    MeasurementError : it cannot be written, or a picture cannot be read
    """
    if given.record is None:
        if given.picture:
            raise MeasurementError("--picture names a picture of --record FILE; give that, too")
        return
    inputs = {given.flight: "log"}
    if given.config:
        inputs[given.config] = "configuration"
    inputs |= dict.fromkeys(given.calibration, "calibration")
    if getattr(given, "ais", None):
        inputs[given.ais] = "AIS"
    record = record_of(
        flight,
        analysis,
        prepared.config,
        inputs=inputs,
        calibrations=prepared.calibrations,
        pictures=given.picture,
    )
    table = write_record(given.record, record)
    yield f"record: {given.record}, {record['sha256'][:12]}; {table.name}, {NOT_APPROVED}"


def _ships(
    details: FlightDetails, given: argparse.Namespace, read_ship: ReadShip | None
) -> Iterator[ShipTrack]:
    """Yield where the ship was, by the configuration and by a file.

    Raises
    ------
    MeasurementError : the file has no track of it, or two numbers are given for it
    """
    if details.position is not None:
        latitude, longitude = (np.array([of]) for of in details.position)
        name = (
            f"flight.latitude_deg, longitude_deg = {details.position[0]:g}, {details.position[1]:g}"
        )
        yield ShipTrack(name=name, latitude=latitude, longitude=longitude, time=np.empty(0))
    if read_ship is None:
        return
    if given.mmsi is not None and details.mmsi not in (None, given.mmsi):
        raise MeasurementError(
            f"--mmsi is {given.mmsi}, and flight.mmsi of the configuration is {details.mmsi}; leave"
            " one of them out"
        )
    if given.ais is not None:
        yield read_ship(given.ais, details.mmsi if given.mmsi is None else given.mmsi)
    elif given.mmsi is not None:
        raise MeasurementError("--mmsi names a ship of --ais FILE; give that file, too")


def _parser(*, with_ship: bool) -> argparse.ArgumentParser:
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
    if with_ship:
        parser.add_argument("--ais", type=Path)
        parser.add_argument("--mmsi", type=int)
    parser.add_argument(
        "--calibration",
        type=Path,
        action="append",
        default=[],
        metavar="FILE",
        help="of plume-flight calibrate; one, or one before and one after the flight",
    )
    parser.add_argument("--record", type=Path, metavar="FILE.json", help="record to hand over")
    parser.add_argument(
        "--picture",
        type=Path,
        action="append",
        default=[],
        metavar="FILE",
        help="picture that the record names, with its hash",
    )
    parser.add_argument("--no-report", action="store_true", help="write no report")
    return parser


def _command(arguments: list[str] | None) -> list[str]:
    """Return the program and its arguments; with arguments alone, no program is known."""
    console = Path(sys.argv[0]).stem == PROGRAM
    return sys.argv if arguments is None or console else ["", *arguments]


def _summary(analysis: Analysis | GasAnalysis, name: str) -> Iterator[str]:
    """Yield the lines of a summary of a flight called ``name``."""
    if isinstance(analysis, GasAnalysis):
        yield f"{name}, with: {analysis.instrument.title}, without SO2"
        yield _passes(analysis.gases[0].figures)
        return
    found, figures = analysis.estimate, analysis.estimate.figures
    yield f"{name}, with: {analysis.instrument.title}"
    yield _passes(figures)
    yield from _result(found)
    reasons = "; ".join(found.quality_reasons)
    yield f"quality {found.quality}: {reasons}" if reasons else f"quality {found.quality}"
    for verdict in found.verdicts:
        chance = verdict.probability_above
        words = verdict_words(verdict.verdict, verdict.limit_percent, chance, found.quality)
        is_open = verdict.verdict == OPEN and found.quality != "C"
        yield f"{words}; {needed(chance)}" if is_open else words
        if found.quality != "C":
            yield f"  {rate_words(verdict)}"
    if found.quality != "C" and any(verdict.verdict == OPEN for verdict in found.verdicts):
        yield f"open, as {_largest_part(found)}"
    if analysis.decision is not None:
        yield decision_words(analysis.decision)
    step = next_step(
        found.quality,
        passes=figures.passes,
        undecided=any(verdict.verdict == OPEN for verdict in found.verdicts),
        noise=found.noise_percent,
        errors={_ERRORS.get(key, key): size for key, size in found.common_percent.items()},
    )
    if step:
        yield step


def _passes(figures: Figures) -> str:
    """Return how long a record is, and its passes."""
    passes = "1 pass" if figures.passes == 1 else f"{figures.passes} passes"
    every = f" every {figures.interval_s:.1f} s" if figures.passes > 1 else ""
    return f"{figures.duration_s:.0f} s, {passes}{every}, CO2 signal to noise {figures.co2_snr:.0f}"


def _gases(analysis: Analysis | GasAnalysis) -> Iterator[str]:
    """Yield lines on the other gases: the figure, its uncertainty, quality and verdict."""
    for found in analysis.gases:
        yield f"{found.title}: {value_words(found)} ({'; '.join(found.remarks)})"
        if math.isfinite(found.total):
            yield f"  ratio to CO2 {found.slope:.4g} {found.slope_unit}"
            parts = {"noise": found.noise, **found.common}
            largest = sorted(parts.items(), key=lambda item: -item[1])[:_PARTS]
            words = ", ".join(
                f"{error_words(name, found.title)} {size:.{found.digits}f}"
                for name, size in largest
            )
            yield f"  standard uncertainty {found.total:.{found.digits}f} {found.unit}: {words}"
        if found.per_fuel_unit != found.unit and math.isfinite(found.per_fuel):
            load = f"{found.load:.2f} ± {found.load_sd:.2f}" if math.isfinite(found.load) else "?"
            yield (
                f"  {found.per_fuel:.{found.digits}f} {found.per_fuel_unit} of fuel, burnt at"
                f" {1000.0 * found.consumption_kg_kwh:.0f} g/kWh with a load of {load}, which has"
                f" {100.0 * found.load_share:.0f} % of the variance"
            )
        reasons = "; ".join(found.quality_reasons)
        yield f"  quality {found.quality}{f': {reasons}' if reasons else ''}"
        yield f"  {verdict_words_of(found)}"
    yield from analysis.gas_remarks
    if any(found.verdict is not None for found in analysis.gases):
        yield f"NOx: {SCREENING}"


_PARTS = 3
"""Parts of the uncertainty of a gas that are printed, the largest first."""


def _largest_part(found: FscEstimate) -> str:
    """Return which part makes up most of the uncertainty, and how much of it."""
    so2 = found.instrument.known("so2")
    squares = {key: size**2 for key, size in found.common_percent.items()}
    squares["noise"] = found.noise_percent**2
    words = _ERRORS | {"noise": "noise, background and differences between passes"}
    unknown = [gas for gas, sd in so2.cross_sd.items() if sd and not so2.cross.get(gas)]
    if unknown:
        squares["cross"] = sum(squares.pop(gas, 0.0) for gas in unknown)
        gases = " and ".join(gas.upper() for gas in unknown)
        words["cross"] = f"the response of SO2 to {gases} is not stated (`cross`)"
    largest = max(squares, key=lambda key: squares[key])
    share = 100.0 * squares[largest] / sum(squares.values())
    return f"{share:.0f} % of the uncertainty: {words.get(largest, largest)}"


def _result(found: FscEstimate) -> Iterator[str]:
    """Yield the lines of the sulphur content and its uncertainty."""
    if found.total_percent <= FUEL_SULPHUR_MOST:
        content = content_words(found.fsc_percent, found.low_percent, found.high_percent)
        yield f"fuel sulphur content {content}"
    else:
        yield "fuel sulphur content: none can be given"
    if abs(found.assumed_percent) >= ASSUMED_LEAST:
        yield (
            f"of it {found.assumed_percent:+.3f} % correct SO2 for NO and NO2 that the log does"
            " not have, as ships emit them on average"
        )
    if math.isfinite(found.total_percent):
        yield f"standard uncertainty (1 sigma) {found.total_percent:.4f} %, of which"
        yield f"  noise {found.noise_percent:.4f}"
        for key, size in sorted(found.common_percent.items(), key=lambda item: -item[1]):
            yield f"  {_ERRORS.get(key, key)} {size:.4f}"


def _missing(flight: LoggedFlight, analysis: Analysis | GasAnalysis) -> Iterator[str]:
    """Yield lines on how the log was read, on repeated rows, missing readings, gaps, and places
    that count as missing.
    """
    yield f"table: {flight.about.table}"
    signals, readings = analysis.sampled(flight)
    gaps = find_gaps(readings, signals, flight.about.readings)
    yield from (f"{title.lower()}: {words}" for title, words in gaps.remarks.items())
    if flight.about.place_remark:
        yield f"places: {flight.about.place_remark}"
    yield from (f"ship: {distance}" for distance in flight.about.ships)


def _unused_gases(readings: Readings, instrument: SnifferSpec) -> Iterator[str]:
    """Yield a line for each gas with readings that SO2 responds to, but without a channel."""
    so2 = instrument.known("so2")
    for i, gas in enumerate(GASES):
        measured = np.isfinite(readings.values[:, i]).any()
        matters = so2.cross.get(gas) or so2.cross_sd.get(gas)
        if measured and matters and not instrument.channel(gas):
            yield (
                f"{gas.upper()} is not used to correct SO2: '{instrument.name}' has no channel for"
                f" it; add a table channels.{gas}"
            )
