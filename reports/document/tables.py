"""Tables that every report has, and how their cells are written."""

from collections.abc import Sequence
from typing import Any

import pandas as pd

from reports.document.blocks import Table
from reports.run.run_data import RunData


def parameter_table(run: RunData, derived: Sequence[list[str]] = ()) -> Table:
    """Return every parameter of the run with its unit and meaning, and rows for what follows from them."""
    rows = [[p["key"], parameter_value(p["value"], p["key"]), p["unit"], p["meaning"]] for p in run.manifest["parameters"]]
    return Table(
        head=["Parameter", "Value", "Unit", "Meaning and equation"],
        rows=[*rows, *derived],
        widths=[3.1, 1.2, 0.7, 3.9],
        left_columns=4,
        prose=True,
        breakable=True,
    )


def provenance_table(run: RunData) -> Table:
    """Return where the run comes from."""
    manifest = run.manifest
    design, measured = (manifest.get("study") == study for study in ("design", "measurement"))
    seed = manifest["config"].get("seed")
    seeds = "each trial's own" if seed is None else str(seed)
    rows = [
        ["Design" if design else "Flight" if measured else "Scenario", f"{manifest['name']}: {manifest['title']}"],
        *_vehicle(run),
        # A design is made without chance, and of no more than its title says.
        *([] if design or measured else [["Seed", seeds]]),
        *([] if design else [["Hash of the input" if measured else "Configuration hash", manifest["config_hash"]]]),
        ["Source revision", manifest["git_revision"]],
        ["Python", f"{manifest['python']} on {manifest['platform']}"],
        ["Packages", ", ".join(f"{name} {version}" for name, version in manifest["packages"].items())],
        ["State", manifest["state"]],
    ]
    if "wall_time_s" in manifest:
        rows.append(["Wall time", f"{manifest['wall_time_s']:.1f} s"])
    return Table(head=["", ""], rows=rows, widths=[1.0, 4.0], left_columns=2, prose=True, print_size_pt=8.0)


def _config(run: RunData) -> dict[str, Any]:
    """Return the configuration of the run, or of its first trial: the vehicle is the same in all of them."""
    return dict(next(iter(run.manifest.get("trials", {}).values()), run.manifest["config"]))


def _vehicle(run: RunData) -> list[list[str]]:
    """Return the rows on the vehicle."""
    config = _config(run)
    rows = []
    if run.innerloop:
        rows.append(["Aircraft", f"{run.innerloop['title']}. {run.innerloop['source']}"])
    elif config.get("fidelity", "six_dof") == "six_dof" and run.manifest.get("study") != "measurement":
        rows.append(["Aircraft", str(config.get("aircraft", "unknown"))])
    if config.get("fidelity") in ("kinematic", "both"):
        rows.append(
            [
                "Kinematic vehicle",
                "Equation (1) of the paper: it has the commanded speed at once, and is steered by its heading rate.",
            ]
        )
    return rows


def kinematic(run: RunData) -> str:
    """Return what the kinematic vehicle of a run is: equation (1), with a lag if it has one."""
    lag = float((_config(run).get("kinematic") or {}).get("heading_rate_lag_s", 0.0))
    return f"eq. (1) with a heading-rate lag of {lag:g} s" if lag else "eq. (1)"


def length(metres: float) -> str:
    """Return a distance in the unit that suits its size."""
    if metres >= 0.1:
        return f"{metres:.2f} m"
    return f"{1000.0 * metres:.1f} mm" if metres >= 1e-4 else "< 0.1 mm"


def limit(value: float) -> str:
    """Return a limit to three digits: one that is fitted to an aircraft has many."""
    return f"{float(f'{value:.3g}'):g}"


def vehicles_flown(run: RunData) -> str:
    """Return a sentence on the vehicle of a run."""
    fidelity, by_equation = _config(run).get("fidelity"), f"the kinematic vehicle, {kinematic(run)}"
    if fidelity == "kinematic":
        return f"Flown with {by_equation}, not with an aircraft."
    name = run.innerloop["title"] if run.innerloop else _config(run).get("aircraft", "unknown")
    return f"Aircraft: {name}, in six degrees of freedom" + (f"; and {by_equation}." if fidelity == "both" else ".")


def number(value: Any, pattern: str) -> str:
    """Return a value by its pattern, and a dash if there is none."""
    return "–" if value is None or pd.isna(value) else pattern.format(float(value))


def outcome(row: "pd.Series[Any]") -> str:
    """Return how a flight ended, in words, and why it is not met."""
    if row["criteria_met"]:
        return "met"
    ended, message = str(row["outcome"]).replace("_", " "), str(row["message"])
    return f"{ended}: {message}" if message else ended


def ending(row: "pd.Series[Any]") -> str:
    """Return how a flight ended: every criterion that it failed, or why it was not completed, without the advice that follows."""
    words = outcome(row)
    return words if row["outcome"] == "completed" else words.split(";", maxsplit=1)[0]


def parameter_value(value: Any, key: str = "") -> str:
    """Return the value of a parameter in words; some lists mean a range, which their key tells."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list):
        # Of all lists the starting distances alone are a range.
        return (" to " if key == "start.distance_m" else ", ").join(parameter_value(v) for v in value)
    return "not set" if value is None else f"{value:g}" if isinstance(value, float) else str(value)
