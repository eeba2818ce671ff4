"""Which content a run's report has."""

from collections.abc import Callable, Sequence

from common.registry import announced, is_file_part
from common.run_layout import MANIFEST
from reports.arena.content import arena_content
from reports.convergence.content import convergence_content
from reports.design.content import design_content
from reports.document.blocks import Content, Section, Verdict
from reports.document.missing import missing_sections
from reports.document.tables import provenance_table
from reports.errors import ReportError
from reports.flights.content import flights_content
from reports.measurement.content import measurement_content
from reports.paper.content import paper_content
from reports.run.run_data import RunData

STUDIES: dict[str, Callable[[RunData], tuple[Verdict, list[Section]]]] = {
    **dict.fromkeys(("flights", "trials", "monte_carlo", "falsify"), flights_content),
    "paper": paper_content,
    "arena": arena_content,
    "convergence": convergence_content,
    "design": design_content,
    "measurement": measurement_content,
}
"""A study, as its manifest names it, and what makes the verdict and the sections of its report."""

FLIGHT_ENTRIES = ("title", "trials", "trial_parameters", "modes")
"""What reports on flights need of a manifest."""


def content(run: RunData) -> Content:
    """Return everything that a report of ``run`` shows.

    Raises
    ------
    ReportError : the manifest names a study that has no report, or is of another version
    """
    study = run.manifest.get("study", "flights")
    if not isinstance(study, str) or not (study in STUDIES or is_file_part(study) or study in announced("study")):
        raise ReportError(f"'{run.path}': study is {study!r}, which has no report; those that have one: {', '.join(STUDIES)}")
    # Studies of flights that others add have the report of any flights.
    made = STUDIES.get(study, flights_content)
    needed = FLIGHT_ENTRIES if made in (flights_content, paper_content, arena_content) else ()
    refuse_other_version(run, needed)
    verdict, sections = made(run)
    # What is missing is known once everything has been asked for; it stands first.
    sections = [*missing_sections(run), *sections]
    provenance = Section(anchor="provenance", title="Provenance", blocks=[provenance_table(run)])
    return Content(
        title=run.manifest["title"],
        description=run.manifest["config"]["description"],
        changes=", ".join(run.manifest["overrides"]),
        verdict=verdict,
        sections=[section for section in (*sections, provenance) if section.blocks],
    )


def refuse_other_version(run: RunData, needed: Sequence[str]) -> None:
    """Refuse a run whose manifest lacks an entry.

    Raises
    ------
    ReportError : it names the first one that is missing
    """
    if missing := [entry for entry in needed if entry not in run.manifest]:
        raise ReportError(
            f"'{run.path}' was flown by another version: its {MANIFEST} has no '{missing[0]}'; report on it with that version, or"
            " run the scenario again in another --out"
        )
