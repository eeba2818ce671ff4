"""What the tests of reports look up in a report."""

from reports.document.chart import Chart


def blocks_of(report, kind, anchor=None):
    """Return the blocks of a kind, of the whole report or of one section."""
    sections = [section for section in report.sections if anchor in (None, section.anchor)]
    return [block for section in sections for block in section.blocks if isinstance(block, kind)]


def named_charts(report):
    """Return the charts outside the flights by name."""
    return {chart.name: chart for chart in blocks_of(report, Chart)}
