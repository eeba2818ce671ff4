"""Whether a design is as asked, at a glance."""

from collections.abc import Sequence

from reports.design.data import (
    TOGETHER,
    Record,
    bank_deg,
    case_name,
    down,
    excess_overshoot,
    grid_trims,
    limit_cycle_sentence,
    loop_name,
    loops_of,
    short_of,
    where,
    worst,
)
from reports.document.blocks import Card, Verdict

_UNSTABLE = 1e-4
"""Real part [1/s] from which a pole counts as unstable: less is what rounding makes of a pole at
the origin.
"""


def design_verdict(design: Record) -> Verdict:
    """Judge a design: it holds if it is stable at every point, and is complete if every margin is
    as required.
    """
    unstable = _unstable(design)
    nominal, perturbed = _nominal_failures(design), _perturbed_failures(design)
    required = design["required"]
    asked = f"{required['gain_db']:g} dB and {required['phase_deg']:g}°"
    if unstable:
        headline = f"Unstable at {len(unstable)} of {len(_points(design['margins']))} points"
    elif nominal:
        headline = f"Stable everywhere, but short of {asked} in {_loops(nominal)}"
    elif perturbed:
        less = f"{required['perturbed_gain_db']:g} dB and {required['perturbed_phase_deg']:g}°"
        headline = f"Every loop has {asked} everywhere, but is short of {less} under a perturbation"
    else:
        headline = (
            f"Every loop has at least {asked} of margin at every point of the grid and between"
        )
    return Verdict(
        holds=not unstable,
        complete=not (nominal or perturbed),
        headline=headline,
        detail=_detail(design),
        failures=[*(f"unstable at {point}" for point in unstable), *nominal.values(), *perturbed],
        figures=_figures(design),
    )


def _unstable(design: Record) -> list[str]:
    """Return the points at which the aircraft as modelled is unstable, by its poles or by what its
    margins say.
    """
    poles = [
        point
        for point in design["poles"]
        if max(pole[0] for pole in point["closed_loop"]) > _UNSTABLE
    ]
    return _points([*poles, *(row for row in design["margins"] if not row["stable"])])


def _points(rows: Sequence[Record]) -> list[str]:
    """Return the operating points of ``rows``, each once, in their order."""
    return list(dict.fromkeys(where(row) for row in rows))


def _loops(failures: dict[tuple[str, str], str]) -> str:
    names = list(dict.fromkeys(loop.replace("_", " ") for loop, _ in failures))
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


def _nominal_failures(design: Record) -> dict[tuple[str, str], str]:
    """Return a line per loop and kind of margin that is less than required somewhere."""
    failures = {}
    for loop in loops_of(design["margins"]):
        rows = [row for row in design["margins"] if row["loop"] == loop]
        for key, kind, unit in (("gain_db", "gain", "dB"), ("phase_deg", "phase", "deg")):
            short = short_of(rows, key, design["required"][key])
            row = worst(short, key)
            if row is not None:
                points = f"{len(short)} of {len(rows)} points"
                failures[loop, kind] = (
                    f"{loop_name(row)}: {kind} margin {down(row[key])} {unit} at {where(row)}, required"
                    f" {design['required'][key]:g} {unit}; short at {points}"
                )
    return failures


def _perturbed_failures(design: Record) -> list[str]:
    """Return a line per perturbation and kind of margin that is less than required somewhere."""
    failures = []
    for case in dict.fromkeys(row["case"] for row in design["robustness"]):
        rows = [row for row in design["robustness"] if row["case"] == case]
        unstable = _points([row for row in rows if not row["stable"]])
        if unstable:
            failures.append(
                f"{case_name(rows[0])}: unstable at {len(unstable)} of {len(_points(rows))} points, as at {unstable[0]}"
            )
            continue
        for kind, key, unit in (("gain", "gain_db", "dB"), ("phase", "phase_deg", "deg")):
            required = design["required"][f"perturbed_{key}"]
            row = worst(short_of(rows, key, required), key)
            if row is not None:
                loop = str(row[f"{kind}_loop"]).replace("_", " ")
                failures.append(
                    f"{case_name(row)}: {kind} margin {down(row[key])} {unit} of {loop} at {where(row)},"
                    f" required {required:g} {unit}"
                )
    return failures


def _detail(design: Record) -> str:
    grid = _points([row for row in design["margins"] if not row["between"]])
    between = _points([row for row in design["margins"] if row["between"]])
    banks = {bank_deg(row) for row in design["margins"]}
    detail = f"Margins were computed at {len(grid)} points of the grid over airspeed" + (
        " and bank" if len(banks) > 1 else ""
    )
    detail += (
        f" and at {len(between)} points between them and at the largest bank, for which nothing was designed."
        if between
        else "."
    )
    perturbed = {row["case"] for row in design["robustness"] if not row["periods_late"]}
    late = dict.fromkeys(case_name(row) for row in design["robustness"] if row["periods_late"])
    detail += f" The same gains were tried on {' and with '.join([f'{len(perturbed)} perturbed aircraft', *late])}."
    at_limit = [t for t in grid_trims(design) if t.get("limits")]
    if at_limit:
        detail += f" {len(at_limit)} of {len(grid_trims(design))} equilibria are at a limit, which the section on equilibria names."
    detail += f" Flown heading rate lags its command by {design['heading_rate_lag_s']:.2f} s."
    return f"{detail} {limit_cycle_sentence(design)}".rstrip()


def _figures(design: Record) -> list[Card]:
    required = design["required"]
    margins, robustness = design["margins"], design["robustness"]
    figures = [
        _margin_figure("Worst gain margin", margins, "gain_db", "dB", required["gain_db"]),
        _margin_figure("Worst phase margin", margins, "phase_deg", "°", required["phase_deg"]),
        _margin_figure(
            "Worst gain margin", robustness, "gain_db", "dB", required["perturbed_gain_db"]
        ),
        _margin_figure(
            "Worst phase margin", robustness, "phase_deg", "°", required["perturbed_phase_deg"]
        ),
    ]
    together = worst((row for row in margins if row["loop"] == TOGETHER), "disk_gain_db")
    if together is not None:
        value = f"{down(together['disk_gain_db'])} dB, {down(together['disk_phase_deg'])}°"
        figures.append(Card(f"Disk margin, all controls: {where(together)}", value))
    figures.append(
        Card(
            "Heading-rate overshoot beyond the model's", f"{100.0 * excess_overshoot(design):.1f} %"
        )
    )
    figures.append(Card("Flown heading rate lags by", f"{design['heading_rate_lag_s']:.2f} s"))
    # An input that moves nothing has no error to speak of; the table shows it.
    errors = [row for row in design["verification"] if row["error"] is not None]
    if errors:
        largest = max(errors, key=lambda row: float(row["error"]))
        moved = f"{largest['output'].replace('_', ' ')} by {largest['input']}"
        figures.append(
            Card(
                f"Linear model against small motions, worst: {moved}",
                f"{100.0 * largest['error']:.1f} %",
            )
        )
    return figures


def _margin_figure(name: str, rows: Sequence[Record], key: str, unit: str, required: float) -> Card:
    space = " " if unit == "dB" else ""
    row = worst(rows, key)
    if rows and "case" in rows[0]:
        name += f", {case_name(row)}" if row else ", perturbed"
    if row is None:
        return Card(name, "unlimited", f"≥ {required:g}{space}{unit}", met=True)
    loop = str(row.get("loop") or row["gain_loop" if key == "gain_db" else "phase_loop"]).replace(
        "_", " "
    )
    met = not short_of(rows, key, required)
    return Card(
        f"{name}: {loop}, {where(row)}",
        f"{down(row[key])}{space}{unit}",
        f"≥ {required:g}{space}{unit}",
        met,
    )
