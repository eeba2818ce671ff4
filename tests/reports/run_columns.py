"""What a run of flights says of its columns, for runs that are made up."""

from common.run_layout import DERIVED, SUMMARY
from scenarios.instruments.sniffer import SnifferOnBoard
from scenarios.measures.columns import DERIVED_COLUMNS, FINDING_COLUMNS, SUMMARY_COLUMNS

RUN_COLUMNS = {
    SUMMARY: SUMMARY_COLUMNS | SnifferOnBoard.FIGURES | FINDING_COLUMNS,
    DERIVED: DERIVED_COLUMNS,
}
