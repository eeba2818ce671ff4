"""Where a report of flights says that the autopilot's design is."""

from common.run_layout import DESIGN_RECORD
from reports.document.blocks import Section, Text
from reports.run.run_data import RunData

_WHERE = "The design of the autopilot stands in {record}; plume-flight design {aircraft} makes its report."


def innerloop_section(run: RunData) -> Section:
    """Return the section on the autopilot of a run; without a design record it is empty."""
    record = run.innerloop
    words = _WHERE.format(record=DESIGN_RECORD, aircraft=record["aircraft"]) if record else ""
    return Section(anchor="innerloop", title="Autopilot", blocks=[Text(words)] if words else [])
