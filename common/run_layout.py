"""File names of a run directory, for the rooms that write it and the rooms that read it."""

from pathlib import Path

MANIFEST = "manifest.json"
"""Configuration, software, and how the run ended."""

FORMAT = 1
"""Version of a run directory, the manifest's ``format``; it increases when a meaning changes."""

FILES = "files"
"""Entry of the manifest with the files that a run had when it ended."""

JOURNAL = "journal.sqlite"
"""Results as they arrived; the tables are written from it."""

SUMMARY = "summary.csv"
"""A row per flight of the study, or per trajectory and law."""

COMPARISON = "comparison.csv"
"""A row per flight of the comparisons."""

CROSSINGS = "crossings.csv"
"""A row per crossing of the plume."""

INTERVENTIONS = "interventions.csv"
"""A row per intervention of the keep-out guard."""

TRAFFIC = "traffic.csv"
"""A row per flight and ship besides the one that is measured."""

DRAWS = "draws.csv"
"""The values of the random variables of each flight."""

OVERRIDES = "overrides.csv"
"""The keys that each flight has otherwise than the configuration of its trial in the manifest."""

ESTIMATE = "estimate.json"
"""The fuel sulphur content that a measured flight shows."""

SAMPLES = "samples.csv"
"""Readings and signals of a measured flight."""

COLUMNS = "columns.json"
"""What the columns of its tables are: titles, units, meanings (``common.columns``)."""

DERIVED = "derived"
"""Entry of ``columns.json`` with figures that follow from the summary and are in no table."""

VERDICT = "verdict.json"
"""What the run has shown (``common.verdict``): the only judge of it."""

DESIGN_RECORD = "innerloop.json"
"""The design record of the autopilot."""

BOUNDS = "bounds.json"
"""Bounds of the commands of the paper's flights."""

STATISTICS = "statistics.json"
"""Estimates of a Monte Carlo study."""

SULPHUR_TABLE = "sulphur.csv"
"""A row per flight with a sniffer, method and time after settling: the estimate at that time."""

SULPHUR = "sulphur.json"
"""Statistics of the flights with a sniffer."""

PREMISES = "premises.csv"
"""A row per case and term of the error budget: how near errors came to what is reckoned with."""

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
"""Tables of a run; the sniffer writes that of the sulphur content."""

MODEL = "model"
"""Directory of the aircraft's model with the autopilot."""

FLIGHTS = "flights"
"""Directory of the time histories of flights, and entry of ``columns.json`` on their columns."""

WORST = "worst"
"""Directory of the scenario files of the worst flights of a search."""

REPORT_HTML, REPORT_PDF = "report.html", "report.pdf"
"""The reports."""

REPORT_SETTINGS = ("title", "author", "organisation", "logo")
"""Keys of a scenario's section ``report`` and of the manifest's entry of that name."""

LOGO = "logo"
"""Name of the file of the reports' logo, without the suffix of its kind."""

EXPORT = "export"
"""Directory of exported files."""

HISTORY_SUFFIX = ".parquet"
"""Suffix of time histories."""

EVALUATION_SUFFIX = ".json"
"""Suffix of instruments' evaluations of flights."""

TRAFFIC_SUFFIX = ".traffic.json"
"""Suffix of the tracks of other ships, as maps and replays draw them."""

SMOKE_SUFFIX = ".smoke.json"
"""Suffix of the parcels of exhausts, as replays draw them."""

NAME_BYTES_MAX = 200
"""Longest name of a trial or a flight [bytes]: file systems take 255, and suffixes are added."""


def is_file_name(name: object) -> bool:
    """Return whether a name can be part of a file's name, and leads to no other directory.

    Names that are read from a run are checked, because the run may come from somebody else.
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
    """Return the path of the parcels of a flight's exhaust, relative to the run directory."""
    return f"{FLIGHTS}/{flight_id}{SMOKE_SUFFIX}"


def traffic_path(flight_id: str) -> str:
    """Return the path of the tracks of other ships of a flight, relative to the run directory."""
    return f"{FLIGHTS}/{flight_id}{TRAFFIC_SUFFIX}"


def flight_of(path: str) -> str:
    """Return the ID of a flight by a path ``RUN_DIR/flights/ID``, with or without a suffix."""
    name = Path(path).name
    for suffix in (HISTORY_SUFFIX, SMOKE_SUFFIX, TRAFFIC_SUFFIX, EVALUATION_SUFFIX):
        name = name.removesuffix(suffix)
    return name
