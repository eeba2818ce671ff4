"""Names of the files in a run directory."""

from pathlib import Path

MANIFEST = "manifest.json"
"""Configuration, software, and the end of the run."""

FORMAT = 1
"""Version of the run directory's format, in the manifest; it increases if a meaning changes."""

FILES = "files"
"""Entry of the manifest with the files at the end of the run."""

JOURNAL = "journal.sqlite"
"""Database of results; the tables are written from it."""

SUMMARY = "summary.csv"
"""Table with a row per flight of the study, or per trajectory and law."""

COMPARISON = "comparison.csv"
"""Table with a row per flight of the comparisons."""

CROSSINGS = "crossings.csv"
"""Table with a row per crossing of the plume."""

INTERVENTIONS = "interventions.csv"
"""Table with a row per intervention of the keep-out guard."""

TRAFFIC = "traffic.csv"
"""A row per flight and ship besides the one that is measured."""

DRAWS = "draws.csv"
"""Table of the random variables of each flight."""

OVERRIDES = "overrides.csv"
"""Table of each flight's keys that differ from the trial's configuration in the manifest."""

ESTIMATE = "estimate.json"
"""Fuel sulphur content estimated from a measured flight."""

SAMPLES = "samples.csv"
"""Readings and signals of a measured flight."""

COLUMNS = "columns.json"
"""Titles, units and meanings of the tables' columns (``common.columns``)."""

DERIVED = "derived"
"""Entry of ``columns.json`` with figures that are derived from the summary."""

VERDICT = "verdict.json"
"""Verdict of the run (``common.verdict``)."""

DESIGN_RECORD = "innerloop.json"
"""The design record of the autopilot."""

BOUNDS = "bounds.json"
"""Bounds on the commands in the paper's flights."""

STATISTICS = "statistics.json"
"""Estimates of a Monte Carlo study."""

SULPHUR_TABLE = "sulphur.csv"
"""Table of fuel sulphur estimates: a row per flight, method and time after settling."""

SULPHUR = "sulphur.json"
"""Statistics of the flights with a sniffer."""

PREMISES = "premises.csv"
"""Table with a row per case and term of the error budget: largest error over the allowance."""

TABLES = (
    SUMMARY,
    COMPARISON,
    CROSSINGS,
    INTERVENTIONS,
    TRAFFIC,
    DRAWS,
    SAMPLES,
    PREMISES,
)
"""Tables of a run, without the sniffer's table of sulphur content."""

MODEL = "model"
"""Directory with the aircraft's model and the autopilot."""

FLIGHTS = "flights"
"""Directory of flights' time histories, and entry of ``columns.json`` for their columns."""

WORST = "worst"
"""Directory with scenario files of a search's worst flights."""

REPORT_HTML, REPORT_PDF = "report.html", "report.pdf"
"""Files of the reports."""

REPORT_SETTINGS = ("title", "author", "organisation", "logo")
"""Keys of the section ``report`` of a scenario and of a manifest."""

LOGO = "logo"
"""Name of the logo's file without its suffix."""

EXPORT = "export"
"""Directory of exported files."""

HISTORY_SUFFIX = ".parquet"
"""Suffix of time histories."""

EVALUATION_SUFFIX = ".json"
"""Suffix of an instrument's evaluation of a flight."""

TRAFFIC_SUFFIX = ".traffic.json"
"""Suffix of the tracks of other ships, as maps and replays draw them."""

SMOKE_SUFFIX = ".smoke.json"
"""Suffix of the exhaust parcels that replays draw."""

NAME_BYTES_MAX = 200
"""Longest name of a trial or a flight [bytes]: file systems take 255, and suffixes are added."""


def is_file_name(name: object) -> bool:
    """Return whether a name is valid in a file's name and does not lead to another directory.

    Names in a run are checked, because the run may come from somebody else.
    """
    return (
        isinstance(name, str)
        and name.isprintable()
        and 0 < len(name.encode()) <= NAME_BYTES_MAX
        and name not in (".", "..")
        and not set(name) & {"/", "\\"}
    )


def time_history_path(flight_id: str) -> str:
    """Return the path of a flight's time history, relative to the run directory."""
    return f"{FLIGHTS}/{flight_id}{HISTORY_SUFFIX}"


def evaluation_path(flight_id: str) -> str:
    """Return the path of an instrument's evaluation of a flight, relative to the run directory."""
    return f"{FLIGHTS}/{flight_id}{EVALUATION_SUFFIX}"


def smoke_path(flight_id: str) -> str:
    """Return the path of a flight's exhaust parcels, relative to the run directory."""
    return f"{FLIGHTS}/{flight_id}{SMOKE_SUFFIX}"


def traffic_path(flight_id: str) -> str:
    """Return the path of the tracks of other ships of a flight, relative to the run directory."""
    return f"{FLIGHTS}/{flight_id}{TRAFFIC_SUFFIX}"


def flight_of(path: str) -> str:
    """Return the flight ID from a path ``RUN_DIR/flights/ID``, with or without a suffix."""
    name = Path(path).name
    for suffix in (HISTORY_SUFFIX, SMOKE_SUFFIX, TRAFFIC_SUFFIX, EVALUATION_SUFFIX):
        name = name.removesuffix(suffix)
    return name
