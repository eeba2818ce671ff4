"""A design record as reports use it: its margins as they count, and the questions that several
figures ask.
"""

import math
from collections.abc import Iterable
from typing import Any

from reports.document.tables import minus

Record = dict[str, Any]

TOGETHER = "all controls"
"""The loop break at all controls at once, which has disk margins only."""

_MARGINS = ("gain_db", "phase_deg", "disk_gain_db", "disk_phase_deg")

_HUNDRED = 100
"""Reversals up to which one that exceeds a limit is one in a hundred or more."""


def complete(record: Record) -> Record:
    """Return a design record as reports judge it.

    A row whose loop is not stable has no margins, even where a distance to the critical point was
    measured.
    """
    return {
        **record,
        **{name: [_judged(row) for row in record[name]] for name in ("margins", "robustness")},
    }


def _judged(row: Record) -> Record:
    return row if row["stable"] else {**row, **{key: 0.0 for key in _MARGINS if key in row}}


def is_effect(design: Record, name: str) -> bool:
    """Return whether the figures of a control are its measured effect, by which it is commanded,
    and not its command.
    """
    return any(row["is_effect"] for row in design["inputs"] if row["name"] == name)


def control_axis(design: Record, name: str) -> str:
    """Return the label of the axis of a control."""
    return f"{name.capitalize()} {'effect' if is_effect(design, name) else 'command'} [-]"


def bank_deg(row: Record) -> float:
    """Return the bank of a row to a tenth of a degree, so that the rows of one bank are equal in
    it.
    """
    return round(math.degrees(row["bank_rad"]), 1) + 0.0


def climbing(row: Record) -> bool:
    """Return whether a row's equilibrium climbs or descends."""
    return abs(float(row.get("climb_angle_rad", 0.0))) > 1e-6


def speed(airspeed: float) -> str:
    """Return an airspeed in words."""
    return f"{round(airspeed, 1):g} m/s"


def speed_range(design: Record) -> str:
    """Return the airspeeds that a design is for."""
    airspeeds = [row["airspeed_mps"] for row in design["margins"]]
    return (
        f"{round(min(airspeeds), 1):g} to {speed(max(airspeeds))}"
        if min(airspeeds) < max(airspeeds)
        else speed(airspeeds[0])
    )


def where(row: Record) -> str:
    """Return the point of the grid that a row belongs to."""
    bank = bank_deg(row)
    return f"{speed(row['airspeed_mps'])}, " + (minus(f"{bank:+g}°") if bank else "level")


def case_name(row: Record) -> str:
    """Return what a row's perturbation is called in print."""
    return str(row["case"]).replace(" -", " −")


def loop_name(row: Record) -> str:
    """Return what a row's loop is called in print."""
    return str(row["loop"]).replace("_", " ")


def loops_of(rows: Iterable[Record]) -> list[str]:
    """Return the loops of ``rows``, each once, in their order."""
    return list(dict.fromkeys(row["loop"] for row in rows))


def worst(rows: Iterable[Record], key: str) -> Record | None:
    """Return the row whose ``key`` is least, or none where no row has a value; a margin without a
    value is unlimited.
    """
    return min(
        (row for row in rows if row.get(key) is not None),
        key=lambda row: float(row[key]),
        default=None,
    )


def short_of(rows: Iterable[Record], key: str, required: float) -> list[Record]:
    """Return the rows whose ``key`` is below ``required``."""
    return [row for row in rows if row.get(key) is not None and row[key] < required]


def down(value: float | None) -> str:
    """Return a margin rounded down, so that none looks as large as required that is not; one
    without a value is unlimited.
    """
    if value is None:
        return "∞"
    # The small fraction forgives what binary fractions lose: 5.7 stays 5.7.
    return minus(f"{math.floor(value * 10.0 + 1e-6) / 10.0:.1f}")


def at_middle(record: Record, rows: Iterable[Record]) -> list[Record]:
    """Return the rows at the design airspeed in level flight."""
    airspeed = record["design_airspeed_mps"]
    return [
        row
        for row in rows
        if _same(row["airspeed_mps"], airspeed) and not (bank_deg(row) or climbing(row))
    ]


def _same(airspeed: float, other: float) -> bool:
    """Return whether two airspeeds are the same point of the grid, however they were rounded."""
    return abs(airspeed - other) < 1e-3


def grid_trims(record: Record) -> list[Record]:
    """Return the equilibria that neither climb nor descend, ordered by bank and airspeed."""
    return sorted(
        (t for t in record["trims"] if not climbing(t)),
        key=lambda t: (bank_deg(t), t["airspeed_mps"]),
    )


def responses_of(record: Record, command: str) -> list[Record]:
    """Return the step responses to ``command``, the prediction first and what was flown last, so
    that it is drawn on top.
    """
    order = {"model": 0, "predicted": 1, "flown": 2}
    rows = (row for row in record["responses"] if row["command"] == command)
    return sorted(rows, key=lambda row: order.get(row["kind"], 0))


def excess_overshoot(record: Record) -> float:
    """Return how far a flown heading-rate step goes past its reference model, as a fraction of the
    step.
    """
    overshoot = {
        row["kind"]: float(row["overshoot"]) for row in responses_of(record, "heading_rate")
    }
    return max(0.0, overshoot["flown"] - overshoot["model"])


def damping(pole: tuple[float, float]) -> float:
    """Return the damping ratio of a pole [-]; 1 for a real stable one."""
    size = math.hypot(*pole)
    return -pole[0] / size if size else 0.0


_REVERSAL = (
    "A reversal of the turn at {bank_deg:.0f}° of bank is predicted by a dead time of"
    " {delay_s:.2f} s and a lag of {lag_s:.2f} s. In {reversals} reversals that a search flew the"
    " aircraft came up to {deviation_max_m:.2f} m nearer to what it turned away from than"
    " predicted{worst}."
)
_OTHERS = "In the {unguided_reversals} others at most {deviation_99_percent_m:.2f} m."
_OTHERS_OF_MANY = (
    "In the {unguided_reversals} others at most one in a hundred came nearer by more than"
    " {deviation_99_percent_m:.2f} m."
)
_REPEATED = (
    "A second search of {reversals} reversals came up to {deviation_max_m:.2f} m nearer{worst}."
)


def reversal_sentences(design: Record) -> str:
    """Return how far reversals stray from their response."""
    own = design["turn_reversal"]
    others = _OTHERS if own["unguided_reversals"] <= _HUNDRED else _OTHERS_OF_MANY
    sentences = [_REVERSAL.format(**own, worst=_worst_case(own)), others.format(**own)]
    if more := own.get("repeated_search"):
        sentences.append(_REPEATED.format(**more, worst=_worst_case(more)))
    return " ".join(sentences)


def limit_cycle_sentence(design: Record) -> str:
    """Return what servos with play make of straight and level flight; empty where they have none,
    or where an older record does not say.
    """
    found = design.get("limit_cycle")
    if not found:
        return ""
    amplitudes = _amplitudes(found)
    if found["is_flown"]:
        return (
            "Its servos have play: straight and level in still air it flies with a limit cycle of"
            f" {found['period_s']:.1f} s, altitude ±{amplitudes[0]} and bank ±{amplitudes[1]},"
            " which no linear model and no margin shows."
        )
    least = _amplitudes(found["counted_from"])
    return (
        "Its servos have play; straight and level in still air it flew with no sustained"
        f" oscillation from {least[0]} of altitude or {least[1]} of bank on."
    )


def _amplitudes(of: Record) -> tuple[str, str]:
    return f"{of['altitude_m']:.2f} m", f"{math.degrees(of['bank_rad']):.2f}°"


def _worst_case(search: Record) -> str:
    """Return which aircraft deviated most, unless the search flew it as modelled only."""
    of = search.get("deviation_of_m", {})
    return minus(f" (the worst: {max(of, key=of.get)})") if len(of) > 1 else ""
