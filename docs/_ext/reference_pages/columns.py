"""Every column of the tables and time histories of a run, from the code that writes them."""

from collections.abc import Iterable, Mapping

from common.run_layout import PHASES, SHIPS, SUMMARY
from measurement.log.run_files import SAMPLE_MEANINGS
from reference_pages.markdown import literal, plain, table
from reports.compare.figures import MEASURES
from reports.export.tracks_csv import COLUMNS as TRACK_COLUMNS
from scenarios.instruments.sniffer import SnifferOnBoard
from scenarios.metrics.columns import (
    CROSSING_COLUMNS,
    INPUT_COLUMNS,
    INTERVENTION_COLUMNS,
    SEARCH_COLUMNS,
    SUMMARY_COLUMNS,
)
from scenarios.metrics.finding import FINDING_FIGURES
from scenarios.metrics.meanings import CONVERGENCE_MEANINGS, MEANINGS
from scenarios.metrics.window import MEASURED_COLUMNS, WINDOW_COLUMNS
from scenarios.simulation.guard_belief import GuardBelief
from scenarios.simulation.plume_readings import PlumeBelief
from scenarios.simulation.record import MEANINGS as HISTORY_MEANINGS
from scenarios.simulation.record import unit_of
from scenarios.simulation.time_history import INSTRUMENT_MEANINGS
from scenarios.statistics.premises import TABLE_COLUMNS as PREMISE_COLUMNS
from scenarios.statistics.premises import TABLE_MEANINGS as PREMISE_MEANINGS
from scenarios.studies.arena.study import TUNING_COLUMNS
from scenarios.studies.convergence.ensemble import COLUMNS as CONVERGENCE_COLUMNS
from scenarios.studies.patrol.meanings import MEANINGS as PATROL_MEANINGS
from scenarios.studies.patrol.tables import PATROL_COLUMNS, PHASE_COLUMNS, SHIP_COLUMNS

_INTRODUCTION = """\
# Every column

Made from the code that writes the files. What each file is for, and how figures are measured:
[the run directory](/reference/results.md). A figure that a flight does not have is empty. *Settled* is said of the flight from its
settling time on; `rms` stands for the root mean square.
"""

SNIFFER_TITLE, SEARCH_TITLE = (
    "summary.csv, of flights with a sniffer",
    "summary.csv, of flights that search for the plume",
)


def tables() -> dict[str, tuple[Iterable[str], Mapping[str, str]]]:
    """Return the columns and their meanings by the titles of the tables."""
    ((sulphur, sulphur_columns),) = SnifferOnBoard.TABLES.items()
    histories = {**HISTORY_MEANINGS, **INSTRUMENT_MEANINGS}
    columns = {
        "crossings.csv": CROSSING_COLUMNS,
        "interventions.csv": INTERVENTION_COLUMNS,
        "draws.csv": (*INPUT_COLUMNS, *SEARCH_COLUMNS),
        sulphur: ("flight_id", "trial", "variant", *sulphur_columns),
        "window.csv": ("flight_id", "trial", *WINDOW_COLUMNS, *MEASURED_COLUMNS),
        "tuning.csv": TUNING_COLUMNS,
    }
    return {
        "summary.csv and comparison.csv": (SUMMARY_COLUMNS, MEANINGS["summary.csv"]),
        SNIFFER_TITLE: (SnifferOnBoard.FIGURES, MEANINGS["summary.csv"]),
        SEARCH_TITLE: (FINDING_FIGURES, MEANINGS["summary.csv"]),
        **{name: (of, MEANINGS[name]) for name, of in columns.items()},
        "flights/ID.parquet": (HISTORY_MEANINGS, histories),
        "flights/ID.parquet, of flights with a sniffer": (SnifferOnBoard.COLUMNS, histories),
        "flights/ID.parquet, of flights with a keep-out guard": (GuardBelief.COLUMNS, histories),
        "flights/ID.parquet, of flights that search for the plume": (
            PlumeBelief.COLUMNS,
            histories,
        ),
        "summary.csv and counterexamples.csv, of a study of convergence": (
            CONVERGENCE_COLUMNS,
            CONVERGENCE_MEANINGS,
        ),
        "summary.csv, of patrols": (PATROL_COLUMNS, PATROL_MEANINGS[SUMMARY]),
        "ships.csv, of patrols": (SHIP_COLUMNS, PATROL_MEANINGS[SHIPS]),
        "phases.csv, of patrols": (PHASE_COLUMNS, PATROL_MEANINGS[PHASES]),
        "premises.csv": (PREMISE_COLUMNS, PREMISE_MEANINGS),
        "samples.csv of the log of a flight": (SAMPLE_MEANINGS, SAMPLE_MEANINGS),
        "export/NAME.tracks.csv": (
            ("flight_id", *TRACK_COLUMNS),
            {"flight_id": "name of the flight", **histories},
        ),
    }


def columns_page() -> str:
    """Return the page."""
    lines = [_INTRODUCTION]
    for title, (names, meanings) in tables().items():
        lines += [f"## {plain(title)}", ""]
        lines += table(
            ("column", "unit", "meaning"),
            ((literal(name), _unit(name), plain(meanings[name])) for name in names),
        )
    lines += ["## differences.csv of a comparison of runs", "", _DIFFERENCES, ""]
    rows = (
        (literal(name), plain(of.figure.unit.replace("-", "")), plain(of.figure.name))
        for name, of in MEASURES.items()
    )
    return "\n".join([*lines, *table(("column", "unit", "meaning"), rows)])


_DIFFERENCES = """\
A row per pair of flights: the run by its letter and directory, flight, trial and seed, and whether the flight is met in the
first run and in the other. Each of these figures has three columns: in the first run (`_first`), in the other, and their
difference (`_difference`)."""


def _unit(name: str) -> str:
    unit = unit_of(name)
    return "" if unit == "1" else unit
