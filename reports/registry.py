"""Which content a run's report has."""

from collections.abc import Callable

from reports.convergence.content import convergence_content
from reports.design.content import design_content
from reports.document.blocks import Content, Section, Verdict
from reports.document.tables import provenance_table
from reports.errors import ReportError
from reports.flights.content import flights_content
from reports.paper.content import paper_content
from reports.run.run_data import RunData

STUDIES: dict[str, Callable[[RunData], tuple[Verdict, list[Section]]]] = {
    **dict.fromkeys(("flights", "trials", "monte_carlo", "falsification", "replay"), flights_content),
    "paper": paper_content,
    "convergence": convergence_content,
    "design": design_content,
}
"""A study, as its manifest names it, and what makes the verdict and the sections of its report."""


def content(run: RunData) -> Content:
    """Return everything that a report of ``run`` shows.

    Raises
    ------
    ReportError : the manifest names a study that has no report
    """
    study = run.manifest.get("study", "flights")
    if study not in STUDIES:
        raise ReportError(f"'{run.path}': study is '{study}', which has no report; those that have one: {', '.join(STUDIES)}")
    verdict, sections = STUDIES[study](run)
    provenance = Section(anchor="provenance", title="Provenance", blocks=[provenance_table(run)])
    return Content(
        title=run.manifest["title"],
        description=run.manifest["config"]["description"],
        changes=", ".join(run.manifest["overrides"]),
        verdict=verdict,
        sections=[section for section in (*sections, provenance) if section.blocks],
    )
