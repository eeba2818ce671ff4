"""File names of a run directory, for the rooms that write it and the rooms that read it."""

MANIFEST = "manifest.json"
"""Configuration, software, and how the run ended."""

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

DRAWS = "draws.csv"
"""The values of the random variables of each flight."""

COUNTEREXAMPLES = "counterexamples.csv"
"""Rows of the trajectories that did not converge."""

DESIGN_RECORD = "innerloop.json"
"""The design record of the autopilot."""

BOUNDS = "bounds.json"
"""Bounds of the commands of the paper's flights."""

STATISTICS = "statistics.json"
"""Estimates of a Monte Carlo study."""

MODEL = "model"
"""Directory of the aircraft's model with the autopilot."""

FLIGHTS = "flights"
"""Directory of the time histories of flights."""

TRAJECTORIES = "trajectories"
"""Directory of the time histories of a convergence study."""

WORST = "worst"
"""Directory of the scenario files of the worst flights of a search."""

REPORT_HTML, REPORT_PDF = "report.html", "report.pdf"
"""The reports."""

HISTORY_SUFFIX = ".parquet"
"""Suffix of time histories."""


def time_history_path(flight_id: str) -> str:
    """Return the path of a flight's time history, relative to the run directory."""
    return f"{FLIGHTS}/{flight_id}{HISTORY_SUFFIX}"


def trajectory_path(law: str, number: int) -> str:
    """Return the path of the time history of a trajectory, relative to the run directory."""
    return f"{TRAJECTORIES}/{law}_{number:05d}{HISTORY_SUFFIX}"
