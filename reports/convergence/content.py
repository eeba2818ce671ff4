"""The report of a convergence study."""

import pandas as pd

from common.run_layout import COUNTEREXAMPLES
from reports.convergence.charts import HISTORIES_PER_LAW, history_chart, settling_charts
from reports.convergence.data import REFERENCES, ConvergenceData, failed, read_convergence
from reports.convergence.tables import FAILED_ROWS, failed_table, settling_table
from reports.convergence.verdict import convergence_verdict
from reports.document.blocks import Block, Findings, Heading, Section, Text
from reports.document.tables import number, parameter_blocks
from reports.run.run_data import RunData


def convergence_content(run: RunData) -> Findings:
    """Return the findings of a convergence study."""
    data = read_convergence(run)
    sections = [
        Section(anchor="question", title="What was asked", blocks=_question(data)),
        Section(
            anchor="settling",
            title="How soon they settle",
            nav_title="Settling",
            blocks=_settling(data),
        ),
        Section(
            anchor="samples",
            title="Sample trajectories",
            nav_title="Samples",
            blocks=_samples(data),
        ),
        Section(
            anchor="counterexamples",
            title="What did not converge",
            nav_title="Counter-examples",
            blocks=_failed(data),
        ),
        Section(anchor="parameters", title="Parameters", blocks=parameter_blocks(run)),
    ]
    pictures = settling_charts(data) if len(data.rows) else []
    return Findings(
        flown=_flown(data),
        verdict=convergence_verdict(data),
        picture=pictures[0] if pictures else None,
        sections=sections,
    )


def _flown(data: ConvergenceData) -> str:
    laws = ", ".join(law.name.lower() for law in data.laws) or "none"
    states = data.rows["trajectory"].nunique()
    return (
        f"{len(data.rows):,} trajectories of the paper's kinematic vehicle, from {states:,} initial states at random, under these"
        f" laws: {laws}."
    )


def _question(data: ConvergenceData) -> list[Block]:
    rows = data.rows
    if not len(rows):
        return []
    states = rows.drop_duplicates("trajectory")
    counts = (
        f"{(states['reference'] == reference).sum():,} are {REFERENCES[reference][0]}"
        for reference in data.references
    )
    distance, phi = (
        data.run.manifest[key] for key in ("converged_distance_m", "converged_phi_rad")
    )
    band = data.run.manifest["config"]["ensemble"]["settling_band_m"]
    return [
        Heading("Sampled initial states"),
        Text(
            f"{len(states):,} initial states, the same for every law: a place up to"
            f" {number(states['start_distance_m'].max(), '{:,.0f}')} m from the reference and a course, both at random, and a"
            f" reference that turns. Of the references {', '.join(counts)}."
        ),
        Text(_PATIENCE),
        Heading("What converged means"),
        Text(
            f"A trajectory has converged once it is within {distance:g} m of its reference and φ, the angle from the vector z,"
            f" along which the law steers, to the vehicle's course, is within {phi:g} rad: from there on, under the paper's"
            f" laws, both stay small. It is settled from the moment from which its distance stays below {band:g} m."
        ),
        Heading("What the theory says"),
        Text(
            "From every initial state the distance goes to zero: under law (24) but for the singular point φ = π, towards which its"
            " command grows without limit, and under every law of the class (30). That holds for references that do turn, and for"
            " commands that are carried out as they are. Of commands that are cut at ω_max, as an aircraft flies them, the theory"
            " says nothing: they are shown, and have no part in the verdict. Trajectories can refute the theory, not prove it."
        ),
    ]


def _all_on_tight_circles(rows: pd.DataFrame, data: ConvergenceData) -> bool:
    """Return whether there are such rows, and all are about circles that spend more than 98 % of
    omega_max.
    """
    limit = 0.98 * float(data.run.manifest["config"]["guidance"]["heading_rate_max_rad_s"])
    tight = (rows["reference"] == "circle") & (rows["reference_heading_rate_max_rad_s"] > limit)
    return len(rows) > 0 and bool(tight.all())


_LIMIT_CYCLE = (
    "A circle that spends nearly all of ω_max leaves almost nothing to steer with. With cut commands there is then, beside the"
    " reference, a limit cycle some hundred metres off: the command is cut most of each turn, φ swings far out and back once a"
    " turn, and on average the vehicle turns with the reference without coming nearer. Equation (31b), on which the proof for"
    " law (30) rests, does not hold for cut commands. A reserve of a few per cent of ω_max takes the cycle away; oscillations,"
    " at their peak only briefly, have converged without."
)


_PATIENCE = (
    "A trajectory is given up when it has taken many times as long as the motion averaged over its reference's turns predicts,"
    " and at least ensemble.time_max_s. The slowest are those about references that hardly turn: an error along the track then"
    " decays ever so slowly, at a rate that goes with the square of ω_r."
)


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
    if _all_on_tight_circles(
        pd.concat([failed(data.of(law)) for law in data.laws if not law.proven] or [data.rows[:0]]),
        data,
    ):
        blocks.insert(0, Text(_LIMIT_CYCLE))
    for law in data.laws:
        count = len(failed(data.of(law)))
        if count:
            some = (
                f"; the first {FAILED_ROWS} of {count:,}, all are in {COUNTEREXAMPLES}"
                if count > FAILED_ROWS
                else ""
            )
            blocks += [
                Heading(
                    f"{law.name}{'' if law.proven else ', of which the theory says nothing'}{some}"
                ),
                failed_table(data, law),
            ]
    return blocks
