"""The report of an autopilot's design."""

from pathlib import Path

from common.run_layout import DESIGN_RECORD, MODEL
from reports.design.charts import first_chart, margin_chart, nichols_chart, trim_map
from reports.design.data import Record, complete, reversal_sentences, speed_range
from reports.design.tables import (
    envelope_table,
    pole_table,
    robustness_table,
    step_table,
    verification_table,
    weight_table,
    worst_margin_table,
)
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
            f"'{run.path}' holds no design record that can be read ({DESIGN_RECORD});"
            " run plume-flight design again"
        )
    design = complete(run.innerloop)
    nichols = nichols_chart(design)
    sections = [
        _margins(design),
        Section(
            anchor="loops",
            title="Loop shapes",
            blocks=[nichols] if nichols else [],
        ),
        Section(
            anchor="responses",
            title="Step responses",
            blocks=[step_table(design), Text(reversal_sentences(design))],
        ),
        _equilibria(design),
        Section(anchor="poles", title="Poles", blocks=[pole_table(design)]),
        Section(
            anchor="linearisation",
            title="Verification of the linear model",
            nav_title="Linear model",
            blocks=[Text(_VERIFICATION), verification_table(design)],
        ),
        Section(
            anchor="weights",
            title="Weights of the design",
            nav_title="Weights",
            blocks=[Text(_WEIGHTS), weight_table(design)],
        ),
        _elsewhere(run.path / MODEL),
    ]
    return Findings(
        flown=_FLOWN.format(title=design["title"], speeds=speed_range(design)),
        verdict=design_verdict(design),
        picture=first_chart(design),
        sections=sections,
    )


_FLOWN = (
    "The autopilot of the {title} was designed for {speeds}, and its step responses were flown in"
    " JSBSim."
)
_NOMINAL = (
    "Worst of the grid, the points between and the largest bank, loop by loop; required are"
    " {gain_db:g} dB and {phase_deg:g}°"
)
_PERTURBED = (
    "Perturbed or with more delay, worst of loops, grid and points between; required are"
    " {perturbed_gain_db:g} dB and {perturbed_phase_deg:g}°"
)
_EFFECTIVENESS = (
    "Control effectiveness is that of surfaces and throttle here. The perturbed aircraft of the"
    " search over reversals differ in the effectiveness of their surfaces alone."
)
_RESIDUAL = (
    "Largest linear or angular acceleration left in any of the {count} equilibria: {largest:.1e}"
    " (m/s² or rad/s²)."
)
_VERIFICATION = (
    "The linear model's answer to a small input against that of the simulation, in which servos"
    " have no play here: largest error as a fraction of the largest excursion. An aircraft whose"
    " servos have play may fly with a limit cycle, which no linear model has; page 1 says so. Of"
    " jets the throttle's error is the largest: its lag is measured with a throttle step of 0.05,"
    " as a turbine spools at a steady rate, and here the throttle moves by 0.01."
)
_WEIGHTS = (
    "Gains follow from the linear models by weights. By Bryson's rule the weight of a quantity is"
    " one over the square of its acceptable deviation. The table lists these deviations, one set"
    " for the whole grid; the weights of controls follow from them and from the bandwidths at each"
    " airspeed. Below them: the model that the heading rate follows, the largest errors of altitude"
    " and airspeed that the autopilot acts on, the anti-windup rate, and the computing rate."
)


def _margins(design: Record) -> Section:
    blocks: list[Block] = [
        Heading(_NOMINAL.format(**design["required"])),
        worst_margin_table(design),
        margin_chart(design),
        Heading(_PERTURBED.format(**design["required"])),
        robustness_table(design),
        Text(_EFFECTIVENESS),
    ]
    return Section(anchor="margins", title="Margins", blocks=blocks)


def _equilibria(design: Record) -> Section:
    envelope = design["envelope"]
    residuals = [float(t["residual"]) for t in design["trims"] if t.get("residual") is not None]
    sizes = (
        [Text(_RESIDUAL.format(count=len(residuals), largest=max(residuals)))] if residuals else []
    )
    return Section(
        anchor="equilibria",
        title="Equilibria",
        blocks=[
            envelope_table(envelope),
            *(Text(note) for note in envelope["notes"]),
            trim_map(design),
            *sizes,
        ],
    )


_FILES = (
    "The directory “model” beside this report is a JSBSim root: {files}. It needs nothing else."
)
_FLY = (
    "To fly it in any JSBSim, from the directory of this report: {commands}. With JSBSim's Python"
    " package the program is called jsbsim. It writes {written}; the script says how to write"
    " elsewhere."
)


def _elsewhere(root: Path) -> Section:
    """Return how to fly the design without this project, by the files that are there."""
    found = {
        "the aircraft": [p for p in root.glob("aircraft/*/*.xml") if p.stem == p.parent.name],
        "its autopilot": root.glob("systems/*_autopilot.xml"),
        "a script": root.glob("scripts/*.xml"),
    }
    named = [
        (what, path.relative_to(root).as_posix())
        for what, paths in found.items()
        for path in sorted(paths)
    ]
    scripts = [path for what, path in named if what == "a script"]
    blocks = []
    if named:
        blocks.append(
            Text(_FILES.format(files="; ".join(f"{what}, {path}" for what, path in named)))
        )
    if scripts:
        commands = "; ".join(f"JSBSim --root=model --script={path}" for path in scripts)
        written = "; ".join(f"{MODEL}/{Path(path).stem}.csv" for path in scripts)
        blocks.append(Text(_FLY.format(commands=commands, written=written)))
    return Section(anchor="elsewhere", title="Use in stand-alone JSBSim", blocks=blocks)
