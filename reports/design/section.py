"""The autopilot's design, as a section of a report of flights."""

from common.run_layout import DESIGN_RECORD
from reports.design.data import Record, at_middle, bank_deg, complete, down, grid_trims
from reports.design.section_charts import loop_charts, step_charts
from reports.design.tables import step_table, trim_table
from reports.document.blocks import Fold, Heading, Section, Table, Text
from reports.document.chart import Chart
from reports.document.tables import number


def innerloop_section(record: Record) -> Section:
    """Return the section on a design record: where its report is, and behind a fold step responses,
    margins, loop shapes, poles and trims.
    """
    design = complete(record)
    flown = float(design["envelope"]["bank_deg"])
    bank = min({bank_deg(t) for t in design["trims"]}, key=lambda known: abs(known - flown))
    trims = sorted(
        (t for t in grid_trims(design) if bank_deg(t) in (0.0, bank)),
        key=lambda t: float(t["airspeed_mps"]),
    )
    details: list[Chart | Table | Heading | Text] = [
        step_table(design),
        *step_charts(design),
        Heading("Margins at the middle design airspeed"),
        _margin_table(design),
        *loop_charts(design),
        Heading(f"Equilibria: level, and at {bank:.3g} degrees of bank"),
        trim_table(design, trims),
    ]
    aircraft = design["aircraft"]
    return Section(
        anchor="innerloop",
        title="Autopilot",
        blocks=[
            Text(
                f"The design of the autopilot stands in {DESIGN_RECORD}; plume-flight design {aircraft} makes"
                " its report."
            ),
            Fold(title="Step responses, margins and equilibria", blocks=details),
        ],
    )


def _margin_table(design: Record) -> Table:
    """Return the margins at the middle design airspeed in level flight."""
    rows = [
        [
            m["loop"].replace("_", " "),
            *(
                "–" if m["loop"] == "all controls" and m[key] is None else down(m[key])
                for key in ("gain_db", "phase_deg")
            ),
            number(m["crossover"], "{:.2f}"),
            down(m["disk_gain_db"]),
            down(m["disk_phase_deg"]),
        ]
        for m in at_middle(design, design["margins"])
        if not m["between"]
    ]
    head = [
        "Loop opened at",
        "Gain [dB]",
        "Phase [deg]",
        "Crossover [rad/s]",
        "Disk gain [dB]",
        "Disk phase [deg]",
    ]
    return Table(head=head, rows=rows, widths=[1.6, 1.0, 1.0, 1.2, 1.1, 1.2])
