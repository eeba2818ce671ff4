"""Which content a run's report has."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial

from common.errors import PluginError
from common.plugins import call_plugin
from common.provenance import without_folders
from common.registry import announced, is_file_part, load_announced, part_in_file
from common.verdict import MET
from reports.design.content import design_content
from reports.document.blocks import (
    FAILURES_MAX,
    Block,
    Content,
    Findings,
    Heading,
    Section,
    Text,
    Verdict,
)
from reports.document.chart import Chart
from reports.document.missing import missing_sections
from reports.document.numbering import numbered
from reports.document.provenance import provenance_section
from reports.document.tables import figure_table
from reports.errors import ReportError
from reports.flights.content import flights_content
from reports.flights.verdict import premises_exceeded
from reports.measurement.content import measurement_content
from reports.monte_carlo.content import probabilities
from reports.monte_carlo.falsification import nearest_found
from reports.paper.content import paper_content
from reports.run.letterhead import letterhead, title
from reports.run.run_data import RunData

STUDIES: dict[str, Callable[[RunData], Findings]] = {
    **dict.fromkeys(("flights", "trials"), flights_content),
    "monte_carlo": partial(flights_content, answer=probabilities),
    "falsify": partial(flights_content, answer=nearest_found),
    "premises": partial(flights_content, answer=premises_exceeded),
    "paper": paper_content,
    "design": design_content,
    "measurement": measurement_content,
}
"""A study, as its manifest names it, and what makes the findings of its report; one of flights
gives ``flights_content`` the answer to its question. An installed package announces more of them in
the group ``plume_flight_study.report``, by the name of their study; the class of a study in a file
has one as its attribute ``report``.
"""

SECTIONS = "report_section"
"""Group of entry points, ``plume_flight_study.report_section``: functions that return sections
which reports of every study have at their end, given the run.
"""


def content(run: RunData, settings: Mapping[str, str] | None = None) -> Content:
    """Return everything that a report of ``run`` shows.

    Parameters
    ----------
    run : as read from disk
    settings : title, author, organisation and logo that replace those of the run
        (``reports.run.letterhead``)

    Raises
    ------
    ReportError : the manifest names a study that has no report, or is of another version; or the
        logo is no picture; or what a package or a file adds fails
    """
    try:
        found = _findings_of(run)(run)
        added = _added_sections(run)
    except PluginError as error:
        raise ReportError(str(error)) from error
    head = letterhead(run, settings or {})
    exit_status = run.judgement.exit_status if run.judgement else MET
    verdict = replace(found.verdict, exit_status=exit_status)
    figures = Section(anchor="figures", title="Further figures", blocks=_figures(verdict))
    # What is missing is known once everything has been read; it stands first.
    shown = [_without(found.picture, section) for section in (*found.sections, *added)]
    sections = [*missing_sections(run), figures, *shown, provenance_section(run, head)]
    picture, sections = numbered(found.picture, [section for section in sections if section.blocks])
    changes = [change for change in run.manifest["overrides"] if not change.startswith("report.")]
    return Content(
        title=title(run, settings or {}),
        letterhead=head,
        description=_description(run.manifest["config"]["description"], changes),
        changes=", ".join(map(without_folders, changes)),
        flown=found.flown,
        verdict=verdict,
        picture=picture,
        sections=sections,
        facts=found.facts,
    )


def _findings_of(run: RunData) -> Callable[[RunData], Findings]:
    """Return what makes the findings of a run's report; of a study of flights that others add
    without a report, that of any flights.
    """
    study = run.manifest.get("study")
    if isinstance(study, str):
        if study in STUDIES:
            return STUDIES[study]
        if study in announced("report"):
            made: Callable[[RunData], Findings] = load_announced("report", study)
            return made
        if is_file_part(study):
            return _report_of_file(run, study)
        if study in announced("study"):
            return flights_content
    known = [*STUDIES, *sorted(announced("report"))]
    raise ReportError(
        f"'{run.path}': study is {study!r}, which has no report; those that have one:"
        f" {', '.join(known)}"
    )


def _report_of_file(run: RunData, study: str) -> Callable[[RunData], Findings]:
    """Return what makes the report of a study in a file; without that file, that of any flights."""
    try:
        kind = part_in_file(study)
    except PluginError:
        run.unread.add(study)
        return STUDIES["flights"]
    own: Callable[[RunData], Findings] | None = getattr(kind, "report", None)
    return (lambda run: call_plugin(f"study '{study}'", own, run)) if own else STUDIES["flights"]


def _added_sections(run: RunData) -> list[Section]:
    """Return the sections that installed packages add."""
    found: list[Section] = []
    for name in sorted(announced(SECTIONS)):
        made = load_announced(SECTIONS, name)
        found += call_plugin(f"report section '{name}'", made, run)
    return found


def _description(words: str, changes: Sequence[str]) -> str:
    """Return the description of a run's scenario; of one that was changed, that it is of what was
    there before.
    """
    if not words or not changes or any(change.startswith("description=") for change in changes):
        return words
    return f"As the scenario describes it, before the changes below: {words}"


def _without(picture: Chart | None, section: Section) -> Section:
    """Return a section without the figure that page 1 shows large."""
    return replace(
        section,
        blocks=[
            of
            for of in section.blocks
            if not (picture and isinstance(of, Chart) and of.name == picture.name)
        ],
    )


def _figures(verdict: Verdict) -> list[Block]:
    """Return the figures, failures and remarks that page 1 has no room for."""
    blocks: list[Block] = [figure_table(verdict.further)] if verdict.further else []
    if left := verdict.failures[FAILURES_MAX:]:
        blocks += [Heading("More failures and remarks"), *map(Text, left)]
    return blocks
