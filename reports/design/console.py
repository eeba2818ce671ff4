"""A design's summary on the console: poles, margins, step responses and the verdict."""

from rich.markup import escape

from reports.design.data import (
    Record,
    complete,
    excess_overshoot,
    limit_cycle_sentence,
    reversal_sentences,
)
from reports.design.tables import pole_table, robustness_table, step_table, worst_margin_table
from reports.design.verdict import design_verdict
from reports.document.console import console_table, wide_console

_REQUIRED = "{perturbed_gain_db:g} dB and {perturbed_phase_deg:g}°"
_HEADINGS = (
    "Poles of the grid",
    "Margins, the worst of grid and points between, with servos, engine and computing delay; of all"
    " controls at once nothing is required",
    "Margins when perturbed, the worst of loops, grid and points between; required are {required}",
    "Step responses",
)
_WORDS = (
    "The autopilot computes {rate:.3g} times a second.",
    "The heading rate lags its command by {lag:.3f} s in simulated flight.",
    "A heading-rate step overshoots its reference model by {overshoot:.1f} %.",
)


def print_summary(record: Record) -> None:
    """Print what a design's record says, in brief."""
    design = complete(record)
    tables = [
        pole_table(design),
        worst_margin_table(design),
        robustness_table(design),
        step_table(design),
    ]
    console = wide_console()
    # Brackets in a title are no markup.
    title, source = (escape(str(record[name])) for name in ("title", "source"))
    console.print(f"[bold]{title}[/bold], designed at {record['altitude_m']:g} m. {source}")
    required = _REQUIRED.format(**design["required"])
    for heading, table in zip(_HEADINGS, tables, strict=True):
        console.print()
        console.print(console_table(heading.format(required=required), table))
    said = {
        "rate": design["autopilot_rate_hz"],
        "lag": record["heading_rate_lag_s"],
        "overshoot": 100.0 * excess_overshoot(design),
    }
    verdict = design_verdict(design)
    lines = [*(words.format(**said) for words in _WORDS), reversal_sentences(design)]
    lines += [verdict.headline, *verdict.failures, limit_cycle_sentence(design)]
    console.print()
    for line in filter(None, lines):
        console.print(line, markup=False, highlight=False)
