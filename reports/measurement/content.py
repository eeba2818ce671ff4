"""The report of a measured flight."""

from collections.abc import Sequence

from reports.document.blocks import Block, Section, Verdict
from reports.measurement.charts import budget_chart, channels_chart, logged_track_chart, over_time_chart, regression_chart
from reports.measurement.data import read_estimate, read_samples
from reports.measurement.tables import over_time_table, record_table, result_table
from reports.measurement.verdict import measurement_verdict
from reports.run.run_data import RunData


def measurement_content(run: RunData) -> tuple[Verdict, list[Section]]:
    """Return the verdict and the sections of the report of a measured flight."""
    record, samples = read_estimate(run), read_samples(run)
    shown = (
        [] if samples is None else _there(regression_chart(samples, record), logged_track_chart(samples), channels_chart(samples))
    )
    result = _there(result_table(record), over_time_chart(record), over_time_table(record), budget_chart(record))
    sections = [
        Section(anchor="result", title="Result", blocks=result),
        Section(anchor="signals", title="Signals", blocks=shown),
        Section(anchor="record", title="Record and instrument", nav_title="Record", blocks=[record_table(record)]),
    ]
    return measurement_verdict(record), sections


def _there(*blocks: Block | None) -> Sequence[Block]:
    return [block for block in blocks if block is not None]
