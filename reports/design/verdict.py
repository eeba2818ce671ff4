"""Whether a design is as required, at a glance."""

from collections.abc import Sequence

from reports.design.data import (
    TOGETHER,
    Record,
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
    margins = f"{required['gain_db']:g} dB and {required['phase_deg']:g}°"
    if unstable:
        headline = f"Unstable at {len(unstable)} of {len(_points(design['margins']))} points"
    elif nominal:
        headline = f"Stable everywhere, but short of {margins} in {_loops(nominal)}"
    elif perturbed:
        less = f"{required['perturbed_gain_db']:g} dB and {required['perturbed_phase_deg']:g}°"
        headline = (
            f"Every loop has {margins} everywhere, but is short of {less} under a perturbation"
        )
    else:
        headline = (
            f"Every loop has at least {margins} of margin at every point of the grid and between"
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
                    f"{loop_name(row)}: {kind} margin {down(row[key])} {unit} at {where(row)},"
                    f" required {design['required'][key]:g} {unit}; short at {points}"
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
                f"{case_name(rows[0])}: unstable at {len(unstable)} of {len(_points(rows))}"
                f" points, as at {unstable[0]}"
            )
            continue
        for kind, key, unit in (("gain", "gain_db", "dB"), ("phase", "phase_deg", "deg")):
            required = design["required"][f"perturbed_{key}"]
            row = worst(short_of(rows, key, required), key)
            if row is not None:
                loop = str(row[f"{kind}_loop"]).replace("_", " ")
                failures.append(
                    f"{case_name(row)}: {kind} margin {down(row[key])} {unit} of {loop} at"
                    f" {where(row)}, required {required:g} {unit}"
                )
    return failures


_POINTS = "Margins are those of {grid} points of the grid"
_BETWEEN = (
    " and {between} points between them and at the largest bank, for which nothing was designed"
)
_TRIED = "The same gains were tried on {perturbed} perturbed aircraft{late}."
_AT_LIMIT = (
    "{at_limit} of {trims} equilibria are at a limit, which the section on equilibria names."
)
_LAG = "Flown heading rate lags its command by {lag:.2f} s."


def _detail(design: Record) -> str:
    grid = _points([row for row in design["margins"] if not row["between"]])
    between = _points([row for row in design["margins"] if row["between"]])
    perturbed = {row["case"] for row in design["robustness"] if not row["periods_late"]}
    late = dict.fromkeys(case_name(row) for row in design["robustness"] if row["periods_late"])
    trims = grid_trims(design)
    at_limit = sum(bool(t.get("limits")) for t in trims)
    points = _POINTS.format(grid=len(grid))
    if between:
        points += _BETWEEN.format(between=len(between))
    with_delay = "".join(f" and with {case}" for case in late)
    sentences = [
        f"{points}.",
        _TRIED.format(perturbed=len(perturbed), late=with_delay),
        *([_AT_LIMIT.format(at_limit=at_limit, trims=len(trims))] if at_limit else []),
        _LAG.format(lag=design["heading_rate_lag_s"]),
        limit_cycle_sentence(design),
    ]
    return " ".join(filter(None, sentences))


def _figures(design: Record) -> list[Card]:
    required, margins = design["required"], design["margins"]
    figures = [
        _margin_figure("Worst gain margin", margins, "gain_db", required["gain_db"]),
        _margin_figure("Worst phase margin", margins, "phase_deg", required["phase_deg"]),
        *(
            _margin_figure(f"Worst {kind} margin, perturbed", design["robustness"], key, least)
            for kind, key, least in (
                ("gain", "gain_db", required["perturbed_gain_db"]),
                ("phase", "phase_deg", required["perturbed_phase_deg"]),
            )
        ),
    ]
    together = worst((row for row in margins if row["loop"] == TOGETHER), "disk_gain_db")
    if together is not None:
        value = f"{down(together['disk_gain_db'])} dB, {down(together['disk_phase_deg'])}°"
        figures.append(Card("Disk margin, all controls", value, note=where(together)))
    overshoot = f"{100.0 * excess_overshoot(design):.1f} %"
    return [*figures, Card("Heading-rate overshoot beyond the model's", overshoot)]


_UNITS = {"gain_db": " dB", "phase_deg": "°"}


def _margin_figure(name: str, rows: Sequence[Record], key: str, required: float) -> Card:
    unit, row = _UNITS[key], worst(rows, key)
    limit = f"≥ {required:g}{unit}"
    if row is None:
        return Card(name, "unlimited", limit, met=True)
    loop = row.get("loop") or row["gain_loop" if key == "gain_db" else "phase_loop"]
    at = [str(loop).replace("_", " "), where(row), *([case_name(row)] if "case" in row else [])]
    met = not short_of(rows, key, required)
    return Card(name, f"{down(row[key])}{unit}", limit, met, ", ".join(at))
