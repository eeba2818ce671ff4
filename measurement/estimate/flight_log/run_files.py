"""The directory that an analysis leaves, of which reports are built."""

import hashlib
import importlib
import importlib.metadata
import importlib.util
import json
import os
import platform
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from measurement.errors import MeasurementError
from measurement.estimate.flight_log.analysis import Analysis
from measurement.estimate.flight_log.csv_file import LoggedFlight
from measurement.estimate.flight_log.gaps import found_gaps, interpolated
from measurement.estimate.result import plain
from measurement.gases import GASES, UNITS

MANIFEST, ESTIMATE, SAMPLES = "manifest.json", "estimate.json", "samples.csv"
"""What the directory holds."""

REPORTS, EXPORT = ("report.html", "report.pdf"), "export"
"""What others make of it: files and a directory."""

FORMAT = 1
"""Version of the directory, as the project's other runs count it."""

STUDY = "measurement"
"""What the manifest calls the kind of run."""

SAMPLE_MEANINGS = {
    "time_s": "time of the sample; between samples that are farther apart than others is a gap, or too few readings to use",
    "so2_ppb": "reading; empty where the log has none for all gases, and the sample is interpolated",
    "co2_ppm": "reading, likewise, with its background",
    "no_ppb": "reading, likewise, where the log has this gas",
    "no2_ppb": "reading, likewise, where the log has this gas",
    "co2_excess_ppm": "CO2 above its background, corrected, with the response of the slowest channel",
    "so2_excess_ppb": "SO2 above its background, likewise",
    "fit_ppb": "SO2 that the slope gives for this CO2",
    "residual_ppb": "SO2 less that fit",
    "north_m": "place, if it is in the log",
    "east_m": "place, if it is in the log",
    "height_m": "height, if it is in the log",
    "so2_true_ppb": "true concentration, of a simulated flight",
    "co2_true_ppm": "true concentration, of a simulated flight",
}
"""Columns of ``SAMPLES`` and their meanings."""

SOURCE_HASH = "source_hash"
"""Entry of the manifest with the SHA-256 of the log's content."""

_HASH_LETTERS = 16
"""Letters that are kept of the hash of all input."""

_TIME_DIGITS = 15
"""Digits of a time, all that a floating-point number has; the other columns have six."""

_PACKAGES = ("numpy", "scipy", "pandas")

_PROGRAM = "plume-flight-study"
"""The package that this one comes in."""

_MODULE = "measurement.estimate"
"""What is run as a module."""


def refuse_another_run(directory: Path) -> None:
    """Refuse a directory that holds a run of another kind: its manifest would be lost. An older
    estimate may be replaced.

    Raises
    ------
    MeasurementError : it does, or its manifest cannot be read
    """
    try:
        study = json.loads((directory / MANIFEST).read_text(encoding="utf-8")).get("study")
    except (FileNotFoundError, NotADirectoryError):
        return
    except (OSError, ValueError, AttributeError, RecursionError):
        study = None
    if study != STUDY:
        raise MeasurementError(
            f"output directory '{directory}' holds another run; choose another --out"
        )


def refuse_another_log(directory: Path, source: Path) -> None:
    """Refuse a directory with the estimate of another log, which nobody asked to replace: logs of
    one name share the default.

    Parameters
    ----------
    directory : that is named by the log alone
    source : file of the log, which can be read

    Raises
    ------
    MeasurementError : it holds the estimate of a log with other content
    """
    try:
        known = json.loads((directory / MANIFEST).read_text(encoding="utf-8")).get(SOURCE_HASH)
    except (FileNotFoundError, NotADirectoryError):
        return
    if known != _digest(source.read_bytes()):
        raise MeasurementError(
            f"'{directory}' holds the estimate of another log than '{source}'; give another --out"
        )


def write_run(
    directory: Path,
    flight: LoggedFlight,
    analysis: Analysis,
    source: Path,
    config: Path | None,
    given: Sequence[str],
) -> None:
    """Write manifest, estimate and samples of an analysis; reports and exports of an older one are
    removed.

    Parameters
    ----------
    directory : where to
    flight, analysis : what was read, and made of it
    source, config : files of the flight and of the configuration
    given : the command, as ``sys.argv``: the program, and its arguments

    Raises
    ------
    MeasurementError : the directory cannot be written, or holds another run
    """
    refuse_another_run(directory)
    try:
        directory.mkdir(parents=True, exist_ok=True)
        _remove_older(directory)
        _write_json(directory / ESTIMATE, _record(flight, analysis))
        table = samples(analysis.estimate.signals, flight)
        # A log's time may be seconds since 1970 or 1980, of which six digits are weeks.
        table["time_s"] = [f"{time:.{_TIME_DIGITS}g}" for time in table["time_s"]]
        _whole(
            directory / SAMPLES, lambda part: table.to_csv(part, index=False, float_format="%.6g")
        )
        _write_json(directory / MANIFEST, _manifest(analysis, source, config, given))
    except OSError as error:
        raise MeasurementError(
            f"'{directory}' cannot be written: {error.strerror}; give another --out"
        ) from None


def _remove_older(directory: Path) -> None:
    """Remove the files of an older estimate, its manifest last; the new manifest is written when
    all files are there.
    """
    if (directory / MANIFEST).exists():
        for name in REPORTS:
            (directory / name).unlink(missing_ok=True)
        shutil.rmtree(directory / EXPORT, ignore_errors=True)
        (directory / MANIFEST).unlink()


def _record(flight: LoggedFlight, analysis: Analysis) -> dict[str, Any]:
    gaps = found_gaps(flight.readings, analysis.estimate.signals, flight.about.readings)
    return analysis.record() | {"flight": flight.about.record(), "gaps": gaps.record()}


def samples(signals: pd.DataFrame, flight: LoggedFlight) -> pd.DataFrame:
    """Return the signals of an estimate with place and truth at their times; what is interpolated
    is no reading, and left out.
    """
    table, place = signals.copy(), flight.place
    readings = [name for name in (f"{gas}_{UNITS[gas]}" for gas in GASES) if name in table]
    table.loc[interpolated(flight.readings, signals), readings] = np.nan
    for name in place.columns:
        known = np.isfinite(place[name].to_numpy())
        if name != "time_s" and known.any():
            table[name] = np.interp(table["time_s"], place["time_s"][known], place[name][known])
    return table


def build_report(directory: Path) -> str:
    """Have the reports of a directory built by the room ``reports``, where it is installed; return
    what there is to say.
    """
    if importlib.util.find_spec("reports") is None:
        return "report: not built, as the package 'reports' is not installed; estimate.json has everything"
    outcome = subprocess.run(
        [sys.executable, "-m", "reports.build", str(directory)],
        capture_output=True,
        text=True,
        check=False,
    )
    if outcome.returncode:
        last = (outcome.stderr.strip().splitlines() or ["no reason given"])[-1]
        return f"report: not built: {last}"
    return outcome.stdout.strip()


def _manifest(
    analysis: Analysis, source: Path, config: Path | None, given: Sequence[str]
) -> dict[str, Any]:
    command, revision = _told(given)
    log, settings = source.read_bytes(), config.read_bytes() if config else b""
    return {
        "format": FORMAT,
        "study": STUDY,
        "begun_utc": f"{datetime.now(UTC):%Y-%m-%dT%H:%M:%SZ}",
        "command": command,
        "name": source.stem,
        "title": f"Fuel sulphur content of {source.stem}",
        "state": "complete",
        "overrides": [],
        "config": {
            "description": f"Logged flight {source.name}, measured with: {analysis.instrument.title}."
        },
        "config_hash": _digest(log + settings)[:_HASH_LETTERS],
        "source": source.name,
        SOURCE_HASH: _digest(log),
        "settings": config.name if config else None,
        "settings_hash": _digest(settings) if config else None,
        "version": _version(),
        "git_revision": revision,
        "python": platform.python_version(),
        "platform": f"{platform.system()} {platform.machine()}",
        "cores": os.cpu_count(),
        "packages": {name: importlib.metadata.version(name) for name in _PACKAGES},
        "files": [ESTIMATE, SAMPLES],
    }


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def _version() -> str:
    """Return the version of the program, where it is installed."""
    try:
        return importlib.metadata.version(_PROGRAM)
    except importlib.metadata.PackageNotFoundError:
        return "not recorded"


def _told(given: Sequence[str]) -> tuple[str, str]:
    """Return command and revision of the source as the project's other runs record them; without
    these, the arguments alone.
    """
    if importlib.util.find_spec("common") is None:
        return shlex.join(
            ["python", "-m", _MODULE, *(Path(argument).name or argument for argument in given[1:])]
        ), "not recorded"
    shared = importlib.import_module("common.provenance")
    return str(shared.command_line(_MODULE, given)), str(shared.provenance()["git_revision"])


def _write_json(path: Path, value: dict[str, Any]) -> None:
    text = json.dumps(plain(value), indent=1, allow_nan=False) + "\n"
    _whole(path, lambda part: part.write_text(text, encoding="utf-8"))


def _whole(path: Path, write: Callable[[Path], object]) -> None:
    """Write a file whole or not at all."""
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        write(part)
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
