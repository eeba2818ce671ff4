"""The report of a convergence study."""

from reports.blocks import Block, Content, Heading, Section, Text
from reports.convergence_charts import HISTORIES_PER_LAW, history_chart, settling_charts
from reports.convergence_data import CONVERGED, REFERENCES, ConvergenceData, failed, read_convergence
from reports.convergence_tables import FAILED_ROWS, failed_table, settling_table
from reports.convergence_verdict import convergence_verdict
from reports.run_data import RunData
from reports.tables import number, parameter_table, provenance_table


def convergence_content(run: RunData) -> Content:
    """Return everything that the report of a convergence study shows."""
    data = read_convergence(run)
    sections = [
        Section(anchor="question", title="What was asked", blocks=_question(data)),
        Section(anchor="settling", title="How soon they settle", nav_title="Settling", blocks=_settling(data)),
        Section(anchor="samples", title="Sample trajectories", nav_title="Samples", blocks=_samples(data)),
        Section(anchor="counterexamples", title="What did not converge", nav_title="Counter-examples", blocks=_failed(data)),
        Section(anchor="parameters", title="Parameters", blocks=[parameter_table(run)]),
        Section(anchor="provenance", title="Provenance", blocks=[provenance_table(run)]),
    ]
    return Content(
        title=run.manifest["title"],
        description=run.manifest["config"]["description"],
        changes=", ".join(run.manifest["overrides"]),
        verdict=convergence_verdict(data),
        sections=[section for section in sections if section.blocks],
    )


def _question(data: ConvergenceData) -> list[Block]:
    rows = data.rows
    if not len(rows):
        return []
    states = rows.drop_duplicates("trajectory")
    counts = (f"{(states['reference'] == reference).sum():,} are {REFERENCES[reference][0]}" for reference in data.references)
    ended = rows[rows["outcome"] == CONVERGED]
    distance, phi = ended["distance_final_m"].max(), ended["phi_final_rad"].abs().max()
    within = f" Those that converged ended within {distance:.3g} m and {phi:.3g} rad." if len(ended) else ""
    band = data.run.manifest["config"]["ensemble"]["settling_band_m"]
    return [
        Heading("What was drawn"),
        Text(
            f"{len(states):,} initial states, the same for every law: a place up to"
            f" {number(states['start_distance_m'].max(), '{:,.0f}')} m from the reference and a course, both at random, and a"
            f" reference that turns. Of the references {', '.join(counts)}."
        ),
        Heading("What converged means"),
        Text(
            "A trajectory has converged once the distance to its reference is next to nothing, and so is φ, the angle from the"
            f" vector z, along which the law steers, to the vehicle's course.{within} A trajectory is settled from the moment from"
            f" which its distance stays below {band:g} m."
        ),
        Heading("What the theory says"),
        Text(
            "From every initial state the distance goes to zero: under law (24) but for the singular point φ = π, towards which its"
            " command grows without limit, and under every law of the class (30). That holds for references that do turn, and for"
            " commands that are carried out as they are. Of commands that are cut at ω_max, as an aircraft flies them, the theory"
            " says nothing: they are shown, and have no part in the verdict. Trajectories can refute the theory, not prove it."
        ),
    ]


def _settling(data: ConvergenceData) -> list[Block]:
    return [*settling_charts(data), settling_table(data)] if len(data.rows) else []


def _samples(data: ConvergenceData) -> list[Block]:
    chart = history_chart(
        data,
        "samples",
        f"Distance to the reference over time, of up to {HISTORIES_PER_LAW} trajectories per law that converged.",
        converged=True,
    )
    return [chart] if chart else []


def _failed(data: ConvergenceData) -> list[Block]:
    caption = f"Distance to the reference over time, of up to {HISTORIES_PER_LAW} trajectories per law that did not converge."
    chart = history_chart(data, "counterexamples", caption, converged=False)
    blocks: list[Block] = [chart] if chart else []
    for law in data.laws:
        count = len(failed(data.of(law)))
        if count:
            some = f"; the first {FAILED_ROWS} of {count:,}, all are in counterexamples.csv" if count > FAILED_ROWS else ""
            blocks += [
                Heading(f"{law.name}{'' if law.proven else ', of which the theory says nothing'}{some}"),
                failed_table(data, law),
            ]
    return blocks
