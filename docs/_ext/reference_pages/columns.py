"""Every column of the tables and time histories of a run, from the code that writes them."""

from common.columns import Table, described
from common.registry import announced, load_announced
from measurement.log.run_files import SAMPLE_MEANINGS
from reference_pages.markdown import literal, plain, table
from reports.compare.pairs import COMPARED
from reports.export.tracks_csv import COLUMNS as TRACK_COLUMNS
from scenarios.flight.guard_belief import GuardBelief
from scenarios.flight.onboard import BELIEF_COLUMNS
from scenarios.flight.record import HISTORY_COLUMNS
from scenarios.flight.traffic_belief import TrafficBelief
from scenarios.instruments.gas_channels import gas_columns
from scenarios.instruments.sniffer import SnifferOnBoard
from scenarios.measures.columns import (
    CROSSING_COLUMNS,
    DERIVED_COLUMNS,
    FINDING_COLUMNS,
    FLIGHT_COLUMNS,
    HULL_COLUMNS,
    INPUT_COLUMNS,
    INTERVENTION_COLUMNS,
    SEARCH_COLUMNS,
    SUMMARY_COLUMNS,
    TRAFFIC_COLUMNS,
    TRAFFIC_FIGURES,
    further_faults,
)
from scenarios.scenario.sections.world import GAS_KEYS
from scenarios.statistics.estimates import TABLE_COLUMNS as PREMISE_COLUMNS

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


def tables() -> dict[str, Table]:
    """Return the columns by the titles of the tables."""
    ((sulphur, of_sulphur),) = SnifferOnBoard.TABLES.items()
    histories, gases = HISTORY_COLUMNS | SnifferOnBoard.COLUMNS, gas_columns(GAS_KEYS)
    return {
        "summary.csv and comparison.csv": SUMMARY_COLUMNS,
        SNIFFER_TITLE: SnifferOnBoard.FIGURES,
        "summary.csv, of flights with channels of other gases": gases.figures,
        "summary.csv, of flights beside a ship whose size is known": HULL_COLUMNS,
        "summary.csv, of flights with several faults": further_faults(2),
        SEARCH_TITLE: FINDING_COLUMNS,
        "derived figures": DERIVED_COLUMNS,
        "crossings.csv": CROSSING_COLUMNS,
        "interventions.csv": INTERVENTION_COLUMNS,
        "summary.csv, of flights with other ships": TRAFFIC_FIGURES,
        "traffic.csv": TRAFFIC_COLUMNS,
        "draws.csv": INPUT_COLUMNS | SEARCH_COLUMNS,
        "overrides.csv": FLIGHT_COLUMNS,
        sulphur: FLIGHT_COLUMNS | of_sulphur,
        "flights/ID.parquet": HISTORY_COLUMNS,
        "flights/ID.parquet, of flights with a sniffer": SnifferOnBoard.COLUMNS,
        "flights/ID.parquet, of flights with channels of other gases": gases.histories,
        "flights/ID.parquet, of flights with a keep-out guard": GuardBelief.COLUMNS,
        "flights/ID.parquet, of flights with other ships": TrafficBelief.COLUMNS,
        "flights/ID.parquet, of flights that search for the plume": BELIEF_COLUMNS,
        "premises.csv": PREMISE_COLUMNS,
        "samples.csv of the log of a flight": described(SAMPLE_MEANINGS),
        "export/NAME.tracks.csv": {
            "flight_id": FLIGHT_COLUMNS["flight_id"],
            **{name: histories[name] for name in TRACK_COLUMNS},
        },
        **{
            title: columns
            for name in sorted(announced("columns"))
            for title, columns in load_announced("columns", name).items()
        },
    }


def columns_page() -> str:
    """Return the page."""
    lines = [_INTRODUCTION]
    for title, columns in tables().items():
        lines += [f"## {plain(title)}", ""]
        lines += [_DERIVED, ""] if columns is DERIVED_COLUMNS else []
        lines += _rows(columns)
    lines += ["## differences.csv of a comparison of runs", "", _DIFFERENCES, ""]
    known = SUMMARY_COLUMNS | SnifferOnBoard.FIGURES | DERIVED_COLUMNS
    return "\n".join([*lines, *_rows({name: known[name] for name in COMPARED})])


def _rows(columns: Table) -> list[str]:
    """Return a row per column: its name, title, unit and meaning."""
    return table(
        ("column", "title", "unit", "meaning"),
        (
            (
                literal(name),
                plain(f"{of.title} {of.symbol}".strip()),
                plain(of.after.strip()),
                plain(of.meaning),
            )
            for name, of in columns.items()
        ),
    )


_DERIVED = "They are in no table: statistics, reports and `differences.csv` have them."

_DIFFERENCES = """\
A row per pair of flights: the run by its letter and directory, flight, trial and seed, and whether the flight is met in the
first run and in the other. Each of these figures has three columns: in the first run (`_first`), in the other, and their
difference (`_difference`)."""
