"""Tables of trials over the real sea."""

from typing import Any

import numpy as np
import pandas as pd

from common.run_layout import SUMMARY
from reports.document.blocks import Block, Heading, Table, Text
from reports.document.chart import Array
from reports.document.tables import number, outcome, parameter_value
from reports.flights.criteria import asked, counted
from reports.flights.trial_charts import fault_name, manoeuvre_name
from reports.run.run_data import RunData
from reports.run.trials import Trial, clearance, column, entered, total

UNMET_MAX = 40
"""Flights that fell short and are listed."""

_NOTHING = "–"


def trial_table(trials: list[Trial]) -> Table:
    """Return a row per trial: how many were flown, whether they kept out, and how they ended."""
    rows = []
    for trial in trials:
        flown = trial.flown
        guarded = int(np.count_nonzero(column(flown, "guard_interventions") > 0.0))
        rows.append([
            trial.title,
            f"{len(trial.rows)}" + (f" of {trial.planned}" if len(trial.rows) < trial.planned else ""),
            f"{total(flown, 'keepout_violations')}",
            number(np.min(column(flown, "min_distance_m"), initial=np.inf) if len(flown) else None, "{:.1f}"),
            number(np.min(clearance(flown)) if len(flown) else None, "{:+.1f}"),
            f"{guarded}",
            f"{int(np.count_nonzero(np.isfinite(column(flown, 'settling_time_s'))))}",
            counted(flown["mode_at_end"]) or _NOTHING,
            f"{int(trial.rows['criteria_met'].sum())} of {trial.planned}",
        ])  # fmt: skip
    head = [
        "Trial", "Flights", "Entries", "Closest [m]", "beyond r_min [m]", "With guard", "Settled", "Mode at the end", "Met",
    ]  # fmt: skip
    return Table(head=head, rows=rows, widths=[2.2, 0.8, 0.8, 0.9, 0.9, 0.8, 0.8, 1.7, 1.1])


def criteria_table(trials: list[Trial]) -> Table:
    """Return a row per criterion of each trial: its limit, as configured, and the worst that was measured."""
    rows = []
    for trial in trials:
        listed = asked(trial)
        rows += [[trial.title, a.what, a.limit, a.worst, f"{a.short}"] for a in listed]
        rows += [] if listed else [[trial.title, "Nothing but to keep out, at a heading rate of ω_max at most", "", "", _NOTHING]]
    head = ["Trial", "Asked for", "Limit", "Worst measured", "Fell short"]
    return Table(head=head, rows=rows, widths=[1.7, 2.5, 1.2, 1.7, 0.7], left_columns=4)


def fault_table(trial: Trial) -> Table:
    """Return a row per kind of fault: what became of the flights, and how close they came from the fault on."""
    flown = trial.flown
    after = {str(row["flight_id"]): _closest_after(trial, row) for _, row in flown.iterrows()}
    rows = []
    for kind, members in flown.groupby("fault", sort=False):
        closest = [after[str(flight_id)] for flight_id in members["flight_id"]]
        known = [value for value in closest if value is not None]
        rows.append([
            fault_name(kind),
            f"{len(members)}",
            f"{total(members, 'keepout_violations')}",
            number(float(column(members, "min_distance_m").min()), "{:.1f}"),
            number(min(known, default=None), "{:.1f}") + (f" (of {len(known)})" if known and len(known) < len(closest) else ""),
            f"{column(members, 'end_distance_m').min():.0f} to {column(members, 'end_distance_m').max():.0f}",
            counted(members["mode_at_end"]),
        ])  # fmt: skip
    head = ["Fault", "Flights", "Entries", "Closest [m]", "Closest after the fault [m]", "At the end [m]", "Mode at the end"]
    return Table(head=head, rows=rows, widths=[1.5, 0.7, 0.7, 0.9, 1.3, 1.2, 2.2])


def _closest_after(trial: Trial, row: "pd.Series[Any]") -> float | None:
    """Return how close a flight came to the funnel from its fault on [m], or None without a fault or a time history."""
    history = None if pd.isna(row["fault_time_s"]) else trial.run.history(str(row["flight_id"]))
    if history is None:
        return None
    after = history[history["time_s"] >= row["fault_time_s"]]
    return float(funnel_distance(after, trial.source_height).min()) if len(after) else None


def funnel_distance(history: pd.DataFrame, source_height: float) -> Array:
    """Return the distance from the funnel's mouth at every sample [m]."""
    north, east = (column(history, f"{axis}_m") - column(history, f"vessel_{axis}_m") for axis in ("north", "east"))
    distance: Array = np.sqrt(north**2 + east**2 + (column(history, "altitude_m") - source_height) ** 2)
    return distance


def unmet_blocks(run: RunData) -> list[Block]:
    """Return the flights that fell short, entries first, so many of them at most, each with its reason."""
    unmet = run.summary[~run.summary["criteria_met"]]
    if not len(unmet):
        return []
    order = np.lexsort((np.arange(len(unmet)), -np.nan_to_num(column(unmet, "keepout_depth_m")), ~entered(unmet)))
    rows = [
        [
            str(row["flight_id"]),
            number(row["nu"], "{:.2f}"),
            number(row["keepout_violations"], "{:.0f}"),
            number(row["min_distance_m"], "{:.1f}"),
            outcome(row),
        ]
        for _, row in unmet.iloc[order[:UNMET_MAX]].iterrows()
    ]
    head = ["Flight", "ν [-]", "Entries", "Closest [m]", "How it ended, and what it fell short of"]
    table = Table(head=head, rows=rows, widths=[2.4, 0.5, 0.6, 0.8, 4.2], prose=True, left_columns=5, breakable=True)
    more = len(unmet) - len(rows)
    text = f"{len(unmet)} flights fell short; those that entered the keep-out area come first."
    return [Text(text + (f" The first {len(rows)} are listed, {more} more are in {SUMMARY}." if more else "")), table]


def parameter_blocks(trials: list[Trial]) -> list[Block]:
    """Return what each trial sets and draws, and all parameters with the values that they have otherwise."""
    blocks: list[Block] = []
    for trial in trials:
        blocks += [Heading(trial.title), _set_table(trial)]
    return [*blocks, Heading("Every parameter, where a trial sets nothing"), _default_table(trials[0])] if trials else []


def _set_table(trial: Trial) -> Table:
    """Return what a trial draws for each flight, and the parameters that it sets to other than their defaults."""
    config = trial.config
    listed = {parameter["key"]: parameter for parameter in trial.parameters()}
    rows = [["flights, seed", f"{trial.planned}, {config['seed']}", "", "", "Number of flights; seed of all that is drawn"]]
    if trial.draws("wind") or trial.draws("vessel"):
        low, high = config["speed_ratio"]
        rows.append(["speed_ratio", f"{low:g} to {high:g}", "", "", "Draws with another speed ratio ν are drawn again"])
    for draw in config["draws"]:
        about = listed.get(draw["key"], {})
        rows.append([draw["key"], _drawn(draw), _default(about), about.get("unit", ""), about.get("meaning", "")])
    drawn = {draw["key"] for draw in config["draws"]}
    rows += [
        [key, _value(p["value"]), _default(p), p["unit"], p["meaning"]]
        for key, p in listed.items()
        if key not in drawn and ("default" not in p or p["value"] != p["default"])
    ]
    head = ["Parameter", "Value", "Default", "Unit", "Meaning"]
    return Table(head=head, rows=rows, widths=[2.9, 2.1, 1.1, 0.5, 2.9], left_columns=5, prose=True, breakable=True)


def _default_table(trial: Trial) -> Table:
    rows = [[p["key"], _default(p), p["unit"], p["meaning"]] for p in trial.parameters()]
    head = ["Parameter", "Default", "Unit", "Meaning"]
    return Table(head=head, rows=rows, widths=[3.1, 1.2, 0.7, 3.9], left_columns=4, prose=True, breakable=True)


def _drawn(draw: dict[str, Any]) -> str:
    if draw["uniform"] is not None:
        low, high = draw["uniform"]
        return f"drawn from {low:g} to {high:g}"
    if draw["choice"] is not None:
        choices = [_value(choice) for choice in draw["choice"]]
        if draw["weights"] is None:
            return "in turn: " + "; ".join(choices)
        whole = sum(draw["weights"])
        return "; ".join(f"{100.0 * w / whole:.0f} % {choice}" for w, choice in zip(draw["weights"], choices, strict=True))
    if draw["normal"] is not None:
        mean, sigma = draw["normal"]
        what = f"normal, mean {mean:g}, deviation {sigma:g}"
    else:
        shape, scale = draw["weibull"]
        what = f"Weibull, shape {shape:g}, scale {scale:g}"
    return f"{what}, from {draw['within'][0]:g} to {draw['within'][1]:g}" if draw["within"] else what


def _default(parameter: dict[str, Any]) -> str:
    return _value(parameter["default"]) if "default" in parameter else ""


def _value(value: Any) -> str:
    """Return a value in words; a list of sections can only be manoeuvres, one of figures only a range."""
    if isinstance(value, list) and (not value or isinstance(value[0], dict)):
        return manoeuvre_name(value)
    if isinstance(value, list) and isinstance(value[0], float):
        return " to ".join(f"{bound:g}" for bound in value)
    return parameter_value(value)
