"""The directory of an analysis: manifest, estimate and samples, from which its report is built."""

import hashlib
import importlib.metadata
import importlib.util
import json
import subprocess
import sys
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from common.files import remove_reports, write_json, write_whole
from common.provenance import command_line, provenance
from common.run_layout import ESTIMATE, FORMAT, MANIFEST, SAMPLES
from measurement.errors import MeasurementError
from measurement.estimate.result import plain
from measurement.gases import GASES, UNITS
from measurement.log.analysis import Analysis, GasAnalysis, find_gaps, interpolated
from measurement.log.read import LoggedFlight
from measurement.sniffer.sniffer import Readings

SAMPLE_MEANINGS = {
    "time_s": "time of the sample; longer intervals are gaps, or have too few readings to use",
    "so2_ppb": "reading; empty where the log has none for all gases: the sample is interpolated",
    "co2_ppm": "reading, likewise, with its background",
    "no_ppb": "reading, likewise, where the log has this gas",
    "no2_ppb": "reading, likewise, where the log has this gas",
    "co2_excess_ppm": "CO2 above its background, corrected, with the slowest channel's response",
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

_STUDY = "measurement"
"""Kind of the run in the manifest."""

_SOURCE_HASH = "source_hash"
"""Entry of the manifest with the SHA-256 of the log's content."""

_SHOWS = {Analysis: "Fuel sulphur content", GasAnalysis: "Emissions"}
"""Title of an analysis."""

_PACKAGES = ("numpy", "scipy", "pandas")
"""Packages whose versions the manifest has."""


def check_directory(directory: Path, source: Path, *, named_after_log: bool) -> None:
    """Check that a directory holds no run of another kind; an older estimate may be replaced.

    Raises
    ------
    MeasurementError : it holds one, or its manifest cannot be read; or, where it is named after the
        log, it holds the estimate of another log
    """
    try:
        manifest = json.loads((directory / MANIFEST).read_text(encoding="utf-8"))
    except (FileNotFoundError, NotADirectoryError):
        return
    except (OSError, ValueError, RecursionError):
        manifest = None
    if not isinstance(manifest, dict) or manifest.get("study") != _STUDY:
        raise MeasurementError(
            f"output directory '{directory}' holds another run; choose another --out"
        )
    if named_after_log and manifest.get(_SOURCE_HASH) != sha256(source.read_bytes()):
        raise MeasurementError(
            f"'{directory}' holds the estimate of another log than '{source}'; give another --out"
        )


def write_run(
    directory: Path,
    flight: LoggedFlight,
    analysis: Analysis | GasAnalysis,
    source: Path,
    config: Path | None,
    arguments: Sequence[str],
) -> None:
    """Write manifest, estimate and samples of an analysis, and remove an older report.

    Parameters
    ----------
    source, config : files of the log and of the configuration
    arguments : of the command, same as ``sys.argv``

    Raises
    ------
    MeasurementError : the directory cannot be written
    """
    signals, readings = analysis.sampled(flight)
    gaps = find_gaps(readings, signals, flight.about.readings)
    record = analysis.record() | {
        "flight": flight.about.record(),
        "gaps": vars(gaps),
        "gases": [found.record() for found in analysis.gases],
        "gas_remarks": list(analysis.gas_remarks),
    }
    table = samples(signals, flight, readings)
    if isinstance(analysis, GasAnalysis):
        table = _of_gas(table, analysis.gases[0].gas)
    # A log's time may be seconds since 1970 or 1980, whose first six digits are weeks: all digits
    # of a floating-point number.
    table["time_s"] = [f"{time:.15g}" for time in table["time_s"]]
    try:
        directory.mkdir(parents=True, exist_ok=True)
        if (directory / MANIFEST).exists():
            # Without a manifest until all files are there.
            remove_reports(directory)
            (directory / MANIFEST).unlink()
        write_json(directory / ESTIMATE, plain(record))
        write_whole(
            directory / SAMPLES,
            lambda part: table.to_csv(part, index=False, float_format="%.6g"),
        )
        write_json(directory / MANIFEST, plain(_manifest(analysis, source, config, arguments)))
    except OSError as error:
        raise MeasurementError(
            f"'{directory}' cannot be written: {error.strerror}; give another --out"
        ) from None


def samples(
    signals: pd.DataFrame, flight: LoggedFlight, readings: Readings | None = None
) -> pd.DataFrame:
    """Return the signals of an estimate with place and truth at their times.

    Interpolated readings are left empty. ``readings`` are those of the flight unless given.
    """
    table, place = signals.copy(), flight.place
    names = [name for name in (f"{gas}_{UNITS[gas]}" for gas in GASES) if name in table]
    table.loc[interpolated(readings or flight.readings, signals), names] = np.nan
    for name in place.columns:
        known = np.isfinite(place[name].to_numpy())
        if name != "time_s" and known.any():
            table[name] = np.interp(table["time_s"], place["time_s"][known], place[name][known])
    return table


def _of_gas(table: pd.DataFrame, gas: str) -> pd.DataFrame:
    """Return samples with another gas in the place of SO2 under its name, in steps of its fit."""
    names = {"so2_ppb": f"{gas}_reading", "so2_excess_ppb": f"{gas}_excess"}
    return table.rename(columns={**names, "fit_ppb": "fit", "residual_ppb": "residual"})


def build_report(directory: Path) -> str:
    """Build the report of a directory, if the package ``reports`` is there; return a line on it."""
    if importlib.util.find_spec("reports") is None:
        return (
            "report: not built, as the package 'reports' is not installed; estimate.json has"
            " everything"
        )
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
    analysis: Analysis | GasAnalysis, source: Path, config: Path | None, arguments: Sequence[str]
) -> dict[str, Any]:
    software = provenance()
    log, settings = source.read_bytes(), config.read_bytes() if config else b""
    return {
        "format": FORMAT,
        "study": _STUDY,
        "begun_utc": f"{datetime.now(UTC):%Y-%m-%dT%H:%M:%SZ}",
        "command": command_line("measurement.estimate", arguments),
        "name": source.stem,
        "title": f"{_SHOWS[type(analysis)]} of {source.stem}",
        "state": "complete",
        "overrides": [],
        "config": {
            "description": f"Logged flight {source.name}, measured with:"
            f" {analysis.instrument.title}."
        },
        "config_hash": sha256(log + settings)[:16],
        "source": source.name,
        _SOURCE_HASH: sha256(log),
        "settings": config.name if config else None,
        "settings_hash": sha256(settings) if config else None,
        "version": version(),
        **{key: software[key] for key in ("git_revision", "python", "platform", "cores")},
        "packages": {name: software["packages"][name] for name in _PACKAGES},
        "files": [ESTIMATE, SAMPLES],
    }


def sha256(content: bytes) -> str:
    """Return the hash of a file's content."""
    return hashlib.sha256(content).hexdigest()


def version() -> str:
    """Return the version of the program, if it is installed."""
    try:
        return importlib.metadata.version("plume-flight-study")
    except importlib.metadata.PackageNotFoundError:
        return "not recorded"
