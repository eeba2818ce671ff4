"""Pieces of a run that its report lacks, and what it cannot show without them."""

from collections.abc import Mapping

from common.registry import announced
from common.run_layout import (
    BOUNDS,
    COLUMNS,
    COMPARISON,
    CROSSINGS,
    DESIGN_RECORD,
    DRAWS,
    ESTIMATE,
    FLIGHTS,
    INTERVENTIONS,
    LOGO,
    SAMPLES,
    STATISTICS,
    TRAFFIC,
    WORST,
)
from reports.document.blocks import Block, Section, Table, Text
from reports.run.run_data import RunData

_SHOWN: Mapping[str, str] = {
    STATISTICS: "probability of a keep-out violation, distributions, sensitivity",
    ESTIMATE: "the result",
    SAMPLES: "figures over time, along the track, and of the regression",
    DESIGN_RECORD: "the autopilot: trims, margins, responses",
    BOUNDS: "bounds of the commands",
    COLUMNS: "titles and units of figures, and those that users' parts add",
    COMPARISON: "comparisons",
    CROSSINGS: "crossings in the figures of single flights",
    INTERVENTIONS: "nothing: the report counts interventions by flight",
    TRAFFIC: "nothing: the report has closest approaches from the flights",
    DRAWS: "figures over swept and sampled keys",
    FLIGHTS: "figures of this flight over time",
    WORST: "nothing: a scenario file of one of the worst flights",
    **{f"{LOGO}{suffix}": "the logo" for suffix in (".png", ".jpg", ".svg")},
}
"""What a report shows of a file or, of those in a directory, of each."""

_LISTED_MAX = 30
"""Missing files that are listed, at most."""


def _remedy(run: RunData) -> str:
    study = str(run.manifest.get("study", ""))
    commands = {
        "measurement": "plume-flight estimate makes them",
        "design": "plume-flight design makes them",
    }
    return commands.get(study, "plume-flight run with --resume makes them")


def missing_sections(run: RunData) -> list[Section]:
    """Return the section that names what is missing, if anything is."""
    names = run.missing()
    if not names:
        return []
    more = len(names) - _LISTED_MAX
    announced_report = run.manifest.get("study") in announced("report")
    unknown = "what the report of its study shows of it" if announced_report else "nothing"
    rows = [
        [
            name,
            "cannot be read" if name in run.unread else "is gone",
            _SHOWN.get(name, _SHOWN.get(name.split("/")[0], unknown)),
        ]
        for name in names[:_LISTED_MAX]
    ]
    text = (
        f"{len(names)} {'files' if len(names) > 1 else 'file'} of this directory cannot be shown;"
        f" {_remedy(run)} again."
    )
    table = Table(
        caption="Files that are gone or cannot be read.",
        head=["File", "State", "What is not shown"],
        rows=rows,
        widths=[3.0, 1.0, 4.0],
        prose=True,
        left_columns=3,
    )
    blocks: list[Block] = [
        Text(text),
        table,
        *([Text(f"{more} more are missing.")] if more > 0 else []),
    ]
    return [Section(anchor="missing", title="Missing files", nav_title="Missing", blocks=blocks)]
