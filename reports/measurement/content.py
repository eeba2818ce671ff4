"""The report of a measured flight."""

from collections.abc import Sequence

from reports.document.blocks import Block, Findings, Section
from reports.document.chart import Chart
from reports.measurement.charts import (
    budget_chart,
    channels_chart,
    logged_track_chart,
    over_time_chart,
    regression_chart,
)
from reports.measurement.data import Record, read_estimate, read_samples
from reports.measurement.facts import logged_facts
from reports.measurement.gases import gas_sections, gas_verdict, samples_chart
from reports.measurement.instrument_tables import assumption_table, instrument_table
from reports.measurement.tables import record_table, result_table
from reports.measurement.verdict import measurement_verdict
from reports.run.run_data import RunData


def measurement_content(run: RunData) -> Findings:
    """Return the findings of a measured flight."""
    record, samples = read_estimate(run), read_samples(run)
    if record["estimate"] is None:
        return _without_sulphur(run, record)
    shown = (
        []
        if samples is None
        else _there(
            regression_chart(samples, record), logged_track_chart(samples), channels_chart(samples)
        )
    )
    result = _there(result_table(record), over_time_chart(record), budget_chart(record))
    sections = [
        Section(anchor="result", title="Result", blocks=result),
        *gas_sections(record),
        Section(anchor="signals", title="Signals", blocks=shown),
        Section(anchor="record", title="Record", blocks=[record_table(record)]),
        Section(
            anchor="instrument",
            title="Instrument and assumptions",
            nav_title="Instrument",
            blocks=[instrument_table(record), assumption_table(run, record)],
        ),
    ]
    figures = record["estimate"]["figures"]
    flown = (
        f"A flight of {figures['duration_s']:.0f} s with {figures['passes']} passes through the"
        " plume."
    )
    pictures = _there(
        over_time_chart(record),
        *([] if samples is None else _there(regression_chart(samples, record))),
    )
    picture = next((chart for chart in pictures if isinstance(chart, Chart)), None)
    return Findings(
        flown=flown,
        verdict=measurement_verdict(record),
        picture=picture,
        sections=sections,
        facts=logged_facts(run, record),
    )


def _without_sulphur(run: RunData, record: Record) -> Findings:
    """Return the findings of a flight that did not measure SO2."""
    figures = record["gases"][0]["figures"]
    return Findings(
        flown=f"A flight of {figures['duration_s']:.0f} s with {figures['passes']} passes through"
        " the plume, without SO2.",
        verdict=gas_verdict(record),
        picture=samples_chart(record["gases"]),
        sections=gas_sections(record, with_samples=False),
        facts=logged_facts(run, record),
    )


def _there(*blocks: Block | None) -> Sequence[Block]:
    return [block for block in blocks if block is not None]
