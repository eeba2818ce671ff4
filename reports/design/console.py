"""A design's summary on the console: equilibria, poles, margins, step responses and the verdict."""

from rich.markup import escape

from reports.design.data import (
    Record,
    at_middle,
    complete,
    excess_overshoot,
    limit_cycle_sentence,
    reversal_sentences,
    speed,
)
from reports.design.tables import (
    extreme_trims,
    pole_table,
    robustness_table,
    step_table,
    trim_table,
    worst_margin_table,
)
from reports.design.verdict import design_verdict
from reports.document.blocks import Table
from reports.document.console import console_table, wide_console


def print_summary(record: Record) -> None:
    """Print what a design's record says, in brief."""
    design = complete(record)
    required = design["required"]
    asked = f"{required['perturbed_gain_db']:g} dB and {required['perturbed_phase_deg']:g}°"
    tables = [
        ("Equilibria", trim_table(design, extreme_trims(design))),
        ("Poles of the grid", pole_table(design)),
        (
            f"Poles at {speed(design['design_airspeed_mps'])} in level flight [1/s]",
            _poles(at_middle(design, design["poles"])[0]),
        ),
        (
            "Margins, the worst of grid and points between, with servos, engine and computing"
            " delay; of all controls at once nothing is required",
            worst_margin_table(design),
        ),
        (
            "Margins when perturbed, the worst of loops, grid and points between; required are"
            f" {asked}",
            robustness_table(design),
        ),
        ("Step responses", step_table(design)),
    ]
    console = wide_console()
    # A title may have brackets of its own, which are no markup.
    title, source = (escape(str(record[name])) for name in ("title", "source"))
    console.print(f"[bold]{title}[/bold], designed at {record['altitude_m']:g} m. {source}")
    for heading, table in tables:
        console.print()
        console.print(console_table(heading, table))
    console.print(f"\nThe autopilot computes {design['autopilot_rate_hz']:.3g} times a second.")
    console.print(
        f"The heading rate lags its command by {record['heading_rate_lag_s']:.3f} s in simulated"
        " flight."
    )
    console.print(reversal_sentences(design), markup=False, highlight=False)
    console.print(
        "A heading-rate step overshoots its reference model by"
        f" {100.0 * excess_overshoot(design):.1f} %."
    )
    verdict = design_verdict(design)
    for line in (verdict.headline, *verdict.failures, limit_cycle_sentence(design)):
        if line:
            console.print(line, markup=False, highlight=False)


def _poles(poles: Record) -> Table:
    names = {"open_loop": "aircraft", "closed_loop": "under the autopilot"}
    rows = [
        [name, "  ".join(_pole(*p) for p in poles[kind] if p[1] >= 0.0)]
        for kind, name in names.items()
    ]
    return Table(head=["", ""], rows=rows, widths=[1.0, 4.0], left_columns=2)


def _pole(real: float, imaginary: float) -> str:
    return f"{real:.2f}±{imaginary:.2f}j" if imaginary else f"{real:.3g}"
