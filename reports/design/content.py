"""The report of an autopilot's design."""

from pathlib import Path

from common.run_layout import DESIGN_RECORD, MODEL
from reports.design.data import Record, climbing, complete, reversal_sentences, speed_range
from reports.design.loop_charts import loop_charts
from reports.design.margin_charts import margin_charts
from reports.design.pole_chart import pole_chart
from reports.design.response_charts import first_chart, response_charts
from reports.design.tables import (
    envelope_table,
    extreme_trims,
    pole_table,
    robustness_table,
    step_table,
    trim_table,
    verification_table,
    weight_table,
    worst_margin_table,
)
from reports.design.trim_charts import trim_charts
from reports.design.verdict import design_verdict
from reports.document.blocks import Block, Findings, Heading, Section, Text
from reports.errors import ReportError
from reports.run.run_data import RunData


def design_content(run: RunData) -> Findings:
    """Return the findings of a design.

    Raises
    ------
    ReportError : the directory holds no design record
    """
    if run.innerloop is None:
        raise ReportError(
            f"'{run.path}' holds no design record that can be read ({DESIGN_RECORD}); run plume-flight design again"
        )
    design = complete(run.innerloop)
    sections = [
        _margins(design),
        Section(anchor="loops", title="Loop shapes", blocks=loop_charts(design)),
        Section(
            anchor="responses",
            title="Step responses",
            blocks=[*response_charts(design), step_table(design), Text(reversal_sentences(design))],
        ),
        _equilibria(design),
        Section(anchor="poles", title="Poles", blocks=[pole_chart(design), pole_table(design)]),
        _verification(design),
        _weights(design),
        _elsewhere(run.path / MODEL),
    ]
    flown = (
        f"The autopilot of the {design['title']} was designed for {speed_range(design)}, and its step responses were flown in"
        " JSBSim."
    )
    return Findings(
        flown=flown, verdict=design_verdict(design), picture=first_chart(design), sections=sections
    )


def _margins(design: Record) -> Section:
    required = design["required"]
    asked = f"{required['perturbed_gain_db']:g} dB and {required['perturbed_phase_deg']:g}°"
    blocks: list[Block] = [
        Heading(
            f"Worst of the grid, the points between and the largest bank, loop by loop; required are {required['gain_db']:g} dB and"
            f" {required['phase_deg']:g}°"
        ),
        worst_margin_table(design),
        *margin_charts(design),
        Heading(
            f"Perturbed or with more delay, worst of loops, grid and points between; required are {asked}"
        ),
        robustness_table(design),
        Text(
            "Control effectiveness is that of surfaces and throttle here; the perturbed aircraft that the search over reversals"
            " flies have another effectiveness of their surfaces alone."
        ),
    ]
    return Section(anchor="margins", title="Margins", blocks=blocks)


def _equilibria(design: Record) -> Section:
    envelope = design["envelope"]
    blocks: list[Block] = [
        envelope_table(envelope),
        *(Text(note) for note in envelope["notes"]),
        *trim_charts(design),
    ]
    shown = extreme_trims(design)
    climbs = any(climbing(t) for t in shown)
    title = "Level flight and the largest banks" + (
        ", and the steepest climb and descent" if climbs else ""
    )
    blocks += [Heading(title), trim_table(design, shown)]
    residuals = [float(t["residual"]) for t in design["trims"] if t.get("residual") is not None]
    if residuals:
        blocks.append(
            Text(
                f"Largest linear or angular acceleration left in any of the {len(residuals)} equilibria:"
                f" {max(residuals):.1e} (m/s² or rad/s²)."
            )
        )
    return Section(anchor="equilibria", title="Equilibria", blocks=blocks)


def _verification(design: Record) -> Section:
    text = (
        "The linear model's answer to a small input against that of the simulation itself, in which servos have no play here:"
        " largest error as a fraction of the largest excursion. An aircraft whose servos have play may fly with a limit cycle,"
        " which no linear model has; it is measured in straight and level flight, and the verdict says it. Of jets the throttle's is the largest, above all because its lag is measured"
        " with a throttle step of 0.05, as a turbine spools at a steady rate, and here the throttle moves by 0.01."
    )
    blocks: list[Block] = [Text(text), verification_table(design)]
    return Section(
        anchor="linearisation",
        title="Is the linear model right?",
        nav_title="Linear model",
        blocks=blocks,
    )


def _weights(design: Record) -> Section:
    text = (
        "Gains follow from the linear models by weights. By Bryson's rule the weight of a quantity is one over the square of its"
        " acceptable deviation; the table lists these, a set for the whole grid, in SI units. The weights of controls follow from"
        " them and the bandwidths at each airspeed, and are not listed. Behind the deviations stand the model that the heading rate"
        " follows, the largest errors of altitude and airspeed that the autopilot acts on, the rate at which integrals come back to"
        " what controls can give (anti-windup), and how often the autopilot computes."
    )
    return Section(
        anchor="weights",
        title="Weights of the design",
        nav_title="Weights",
        blocks=[Text(text), weight_table(design)],
    )


def _elsewhere(root: Path) -> Section:
    """Return how to fly the design without this project, by the files that are there."""
    named = [
        (what, path.relative_to(root).as_posix())
        for what, pattern in (
            ("the aircraft", "aircraft/*/*.xml"),
            ("its autopilot", "systems/*_autopilot.xml"),
            ("a script", "scripts/*.xml"),
        )
        for path in sorted(root.glob(pattern))
        if what != "the aircraft" or path.stem == path.parent.name
    ]
    if not named:
        return Section(anchor="elsewhere", title="Fly it elsewhere", blocks=[])
    files = "; ".join(f"{what}, {path}" for what, path in named)
    blocks: list[Block] = [
        Text(
            f"The directory “model” beside this report is a JSBSim root: {files}. It needs nothing else."
        )
    ]
    scripts = [path for what, path in named if what == "a script"]
    if scripts:
        commands = "; ".join(f"JSBSim --root=model --script={path}" for path in scripts)
        written = "; ".join(f"{MODEL}/{Path(path).stem}.csv" for path in scripts)
        blocks.append(
            Text(
                f"To fly it in any JSBSim, from the directory of this report: {commands}. With JSBSim's Python package the program"
                f" is called jsbsim. It writes {written}; the script says how to write elsewhere."
            )
        )
    return Section(anchor="elsewhere", title="Fly it elsewhere", blocks=blocks)
