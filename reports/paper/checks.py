"""What the paper says of its simulations in numbers, checked against a run of them; and the verdict
that follows.
"""

import math
from dataclasses import dataclass
from typing import Any

import pandas as pd

from common.verdict import MET
from reports.document.blocks import Card, Verdict
from reports.document.tables import length, number
from reports.paper.flown import VEHICLES, vehicle_name
from reports.run.run_data import RunData

INTERVAL_PRINTED, DISTANCE_PRINTED = 9.5, 214.0
"""What section V of the paper publishes of Simulation 3 [s, m]."""

TOLERANCES = {"kinematic": 0.005, "six_dof": 0.02}
"""How close each vehicle has to come to what is published."""

END_DISTANCE_MAX = 0.1
"""Distance to the reference at which Simulations 1 and 2 count as converged [m]."""

_SHORT = {"kinematic": "kinematic", "six_dof": "six degrees of freedom"}


@dataclass(frozen=True, slots=True)
class Check:
    """A statement: what it is about, the value found, what is required, and whether it holds; None
    if there is no value.
    """

    name: str
    value: str
    required: str
    met: bool | None


def rows_by_id(run: RunData) -> dict[str, "pd.Series[Any]"]:
    """Return the row of every flight, those of comparisons among them."""
    return {
        str(row["flight_id"]): row
        for frame in (run.summary, run.comparison)
        for _, row in frame.iterrows()
    }


def vehicles(run: RunData) -> list[str]:
    """Return the fidelities that the run was to fly."""
    chosen = str(run.manifest["config"]["fidelity"])
    return list(VEHICLES) if chosen == "both" else [chosen]


def paper_checks(run: RunData) -> list[Check]:
    """Return every check of a run, in the order of the tiles."""
    rows = rows_by_id(run)

    def value(case: str, fidelity: str, key: str) -> float:
        row = rows.get(f"{case}_{fidelity}")
        return math.nan if row is None else float(row[key])

    checks = []
    for fidelity in vehicles(run):
        tolerance, name = TOLERANCES[fidelity], _SHORT[fidelity]
        for what, key, printed, unit in (
            ("interval", "crossing_interval_mean_s", INTERVAL_PRINTED, "s"),
            ("distance", "crossing_distance_mean_m", DISTANCE_PRINTED, "m"),
        ):
            found = value("sim3", fidelity, key)
            checks.append(
                Check(
                    f"Sim. 3 {what}, {name}",
                    number(found, "{:.3f} s" if unit == "s" else "{:.2f} m"),
                    f"{printed:g} {unit} ± {100.0 * tolerance:g} %",
                    _met(found, abs(found / printed - 1.0) <= tolerance),
                )
            )
    violations = sum(value("sim3", fidelity, "keepout_violations") for fidelity in vehicles(run))
    checks.append(
        Check(
            "Sim. 3, keep-out violations",
            number(violations, "{:.0f}"),
            "0",
            _met(violations, violations == 0),
        )
    )
    for case, name in (("sim1", "Sim. 1"), ("sim2_delta", "Sim. 2")):
        if "kinematic" in vehicles(run):
            end = value(case, "kinematic", "tracking_error_end_m")
            what = f"{name} distance at the end, kinematic"
            checks.append(
                Check(
                    what,
                    "–" if math.isnan(end) else length(end),
                    f"< {END_DISTANCE_MAX:g} m",
                    _met(end, end < END_DISTANCE_MAX),
                )
            )
    for case, name, within in (("sim2_delta", "δ law", True), ("sim2_los", "line of sight", False)):
        demand = [
            value(case, fidelity, "heading_rate_demand_max_rad_s") for fidelity in vehicles(run)
        ]
        limit = value(case, vehicles(run)[0], "heading_rate_limit_rad_s")
        # The δ law at its largest, the line of sight at its smallest: each vehicle has to show it.
        worst = (
            sum(demand)
            if any(math.isnan(w) for w in demand)
            else max(demand)
            if within
            else min(demand)
        )
        holds = worst <= limit if within else worst > limit
        required = f"{'≤' if within else '>'} ω_max = {number(limit, '{:g}')} rad/s"
        checks.append(
            Check(
                f"Sim. 2, demand of the {name}",
                number(worst, "{:.3f} rad/s"),
                required,
                _met(worst, holds),
            )
        )
    return checks


def paper_verdict(run: RunData) -> Verdict:
    """Judge a run by its checks, and by the criteria of its flights."""
    checks, verdict, counts = paper_checks(run), run.verdict, run.verdict.counts
    planned, short = counts.planned, counts.done - counts.met
    failed = run.summary[~run.summary["criteria_met"]]
    wrong = [check for check in checks if check.met is False]
    missing = [check for check in checks if check.met is None]
    finished = verdict.is_done and not missing
    if counts.violated:
        headline = f"{counts.keepout_violations} keep-out violations in Simulation 3"
    elif wrong:
        headline = f"Not reproduced: {len(wrong)} of {len(checks)} statements do not hold"
    elif counts.lost:
        headline = f"{counts.lost} of {planned} flights lost their aircraft or diverged"
    elif verdict.is_done and len(missing) == len(checks):
        headline = f"{counts.met} of {planned} flights met their criteria; none is one of the paper's simulations"
    elif not finished:
        headline = f"Unfinished: {len(checks) - len(missing)} of {len(checks)} statements could be tested, and hold"
    elif short:
        headline = (
            f"The paper's statements hold, but {short} of {planned} flights failed a criterion"
        )
    elif len(vehicles(run)) > 1:
        headline = "Reproduced: the paper's numbers, and what it says of Simulations 1 to 3, on both vehicles"
    else:
        headline = f"Reproduced on the {vehicle_name(run, vehicles(run)[0])}"
    detail = (
        f"{counts.done} of {planned} flights are in this report; {counts.met} met every criterion."
    )
    if not verdict.is_done:
        detail += " The run did not end; continue it with --resume."
    return Verdict(
        holds=not (counts.violated or counts.lost or wrong),
        complete=finished and verdict.exit_status == MET,
        headline=headline,
        detail=detail,
        failures=[
            *(f"{check.name}: {check.value}, required {check.required}" for check in wrong),
            *(
                f"{row['flight_id']}: {str(row['outcome']).replace('_', ' ')}, {row['message']}"
                for _, row in failed.iterrows()
            ),
        ],
        figures=[
            Card(check.name, check.value, check.required, check.met)
            for check in checks
            if check.met is not None
        ],
    )


def _met(value: float, holds: bool) -> bool | None:
    return None if math.isnan(value) else holds
