"""Where a report of flights says that the autopilot's design is."""

from common.run_layout import DESIGN_RECORD
from reports.document.blocks import Text
from reports.run.run_data import RunData

_WHERE = (
    "The design of the autopilot stands in {record}; plume-flight design {aircraft} makes its"
    " report."
)


def design_words(run: RunData) -> list[Text]:
    """Return the line on the autopilot of a run; none without a design record."""
    record = run.innerloop
    if not record:
        return []
    return [Text(_WHERE.format(record=DESIGN_RECORD, aircraft=record["aircraft"]))]
