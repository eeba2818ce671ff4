"""Tables that every report has, and how their cells are written."""

from collections.abc import Sequence
from typing import Any

import pandas as pd

from reports.document.blocks import Table, Verdict
from reports.run.run_data import RunData


def parameter_table(run: RunData, derived: Sequence[list[str]] = ()) -> Table:
    """Return every parameter of the run with its unit and meaning, and rows for what follows from them."""
    rows = [[p["key"], parameter_value(p["value"], p["key"]), p["unit"], p["meaning"]] for p in run.manifest["parameters"]]
    return Table(
        caption="Every parameter, with its unit and meaning.",
        head=["Parameter", "Value", "Unit", "Meaning and equation"],
        rows=[*rows, *derived],
        widths=[3.1, 1.2, 0.7, 3.9],
        left_columns=4,
        prose=True,
        breakable=True,
    )


def figure_table(verdict: Verdict) -> Table:
    """Return every figure that a verdict rests on; page 1 has the most important."""
    rows = [
        [card.name, card.value, card.limit or "–", "–" if card.met is None else "met" if card.met else "not met"]
        for card in verdict.figures
    ]
    return Table(
        head=["Figure", "Value", "Required", ""],
        rows=rows,
        widths=[3.0, 1.4, 1.4, 0.6],
        caption="Every figure that the verdict rests on, and what is required of it.",
    )


def run_config(run: RunData) -> dict[str, Any]:
    """Return the configuration of the run, or of its first trial: the vehicle is the same in all of them."""
    return dict(next(iter(run.manifest.get("trials", {}).values()), run.manifest["config"]))


def kinematic(run: RunData) -> str:
    """Return what the kinematic vehicle of a run is: equation (1), with a lag if it has one."""
    lag = float((run_config(run).get("kinematic") or {}).get("heading_rate_lag_s", 0.0))
    return f"eq. (1) with a heading-rate lag of {lag:g} s" if lag else "eq. (1)"


def length(metres: float) -> str:
    """Return a distance in the unit that suits its size."""
    if metres >= 0.1:
        return f"{metres:.2f} m"
    return f"{1000.0 * metres:.1f} mm" if metres >= 1e-4 else "< 0.1 mm"


def limit(value: float) -> str:
    """Return a limit to three digits: one that is fitted to an aircraft has many."""
    return f"{float(f'{value:.3g}'):g}"


def vehicle_flown(run: RunData) -> str:
    """Return the vehicle of a run, to go on a sentence with."""
    fidelity = run_config(run).get("fidelity")
    name = run.innerloop["title"] if run.innerloop else run_config(run).get("aircraft", "aircraft")
    aircraft = f"the {name} in six degrees of freedom"
    if fidelity == "kinematic":
        return f"the kinematic vehicle, {kinematic(run)}"
    return f"{aircraft} and of the kinematic vehicle" if fidelity == "both" else aircraft


def number(value: Any, pattern: str) -> str:
    """Return a value by its pattern, and a dash if there is none."""
    return "–" if value is None or pd.isna(value) else pattern.format(float(value))


def outcome(row: "pd.Series[Any]") -> str:
    """Return how a flight ended, in words, and why it is not met."""
    if row["criteria_met"]:
        return "met"
    ended, message = str(row["outcome"]).replace("_", " "), str(row["message"])
    return f"{ended}: {message}" if message else ended


def parameter_value(value: Any, key: str = "") -> str:
    """Return the value of a parameter in words; some lists mean a range, which their key tells."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list):
        # Of all lists the starting distances alone are a range.
        return (" to " if key == "start.distance_m" else ", ").join(parameter_value(v) for v in value)
    return "not set" if value is None else f"{value:g}" if isinstance(value, float) else str(value)
