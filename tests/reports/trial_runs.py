"""What the tests of trials' reports share: their parts, and runs with other values."""

import json
from dataclasses import replace

from report_parts import blocks_of

from reports.document.blocks import FlightPicker, Table
from reports.document.chart import Chart


def with_values(run, number, **values):
    """Return a run with other values in one row of its summary."""
    summary = run.summary.copy()
    for key, value in values.items():
        summary.loc[number, key] = value
    return replace(run, summary=summary)


def charts_of(report):
    blocks = [block for section in report.sections for block in section.blocks]
    flights = [flight for block in blocks if isinstance(block, FlightPicker) for flight in block.flights]
    return [*(block for block in blocks if isinstance(block, Chart)), *(chart for flight in flights for chart in flight.charts)]


def rows_of(report, title):
    """Return the cells of a trial in the tables of all trials, but for its title."""
    return [row[1:] for table in blocks_of(report, Table, "trials") for row in table.rows if row[0] == title]


def with_criterion(run, trial, key, value):
    manifest = json.loads(json.dumps(run.manifest))
    manifest["trials"][trial]["criteria"][key] = value
    return replace(run, manifest=manifest)
