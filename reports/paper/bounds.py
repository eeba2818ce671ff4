"""Actuation bounds, as a section of a report."""

from typing import Any

import numpy as np

from reports.document.blocks import Heading, Section, Table, Text
from reports.document.chart import Chart, Line, Panel
from reports.document.tables import number


def bounds_section(record: dict[str, Any]) -> Section:
    """Return the section on a record of bounds: how tight they are, and what a guarantee costs."""
    return Section(
        anchor="bounds",
        title="Actuation bounds: the largest demand of the law, over all states",
        nav_title="Bounds",
        blocks=[
            Text(_BOUND.format(samples=record["samples"])),
            _tightness_table(record["flown"]),
            Heading("What a guarantee costs"),
            Text(_COST),
            *(
                [Text(_COST_FOR.format(**record["guaranteed_for"]))]
                if record["guaranteed_for"]
                else []
            ),
            *(
                [_cost_chart(record["guaranteed"])]
                if any("bound_rad_s" in row for row in record["guaranteed"])
                else []
            ),
            _cost_table(record["guaranteed"]),
        ],
    )


_BOUND = (
    "The paper's abstract announces sufficient conditions for the heading rate to stay within its bound; its text does not"
    " print them. docs/actuation_bounds.md derives one. The bound holds for law (30) in every state, at any distance and on any"
    " course; beside it stands the largest command that was found by a search over {samples:,} states, refined from the worst of"
    " them."
)

_COST = (
    "On the reference itself the law demands ω_r plus what h and V/R add, so a reference that spends all of ω_max, as the"
    " paper's Simulation 3 does, leaves no ε, R and h that keep commands within ω_max. A reserve buys them. The parameters below"
    " converge fastest among those that keep every command within ω_max; the price is a longer look-ahead, hence slower"
    " convergence, and a longer crossing interval. The catalog's Simulation 3 and sweep do not pay it: their commands are cut at"
    " ω_max on the way to the reference. guidance.tuning=bounded with a guidance.reserve of some tenths flies with the"
    " guarantee."
)

_COST_FOR = (
    "For speeds up to {speed_mps:g} m/s, which is the largest commanded airspeed and for an aircraft a margin, and ω_max ="
    " {heading_rate_max_rad_s:g} rad/s; the time is estimated from {distance_from_m:g} m to {distance_to_m:g} m."
)


def _tightness_table(rows: list[dict[str, Any]]) -> Table:
    cells = [
        [
            ", ".join(row["flights"]),
            "searched" if row["tuning"] == "bounded" else "given",
            f"{row['speed_mps']:.2f}",
            f"{row['epsilon_per_m']:.4f}",
            f"{row['look_ahead_m']:.1f}",
            f"{row['steering_max_rad_s']:.3f}",
            f"{row['reference_heading_rate_max_rad_s']:.3f}",
            f"{row['bound_rad_s']:.5f}",
            f"{row['largest_found_rad_s']:.5f}",
            f"{row['bound_rad_s'] / row['largest_found_rad_s']:.4f}",
            f"{row['heading_rate_max_rad_s']:.5f}",
        ]
        for row in rows
    ]
    head = [
        "Flights", "Parameters", "Speed [m/s]", "ε [1/m]", "R [m]", "|h| max [rad/s]", "|ω_r| max [rad/s]", "Bound [rad/s]",
        "Largest found [rad/s]", "Ratio [-]", "ω_max [rad/s]",
    ]  # fmt: skip
    return Table(
        caption="The largest demand of the law: its bound, and the largest that was found.",
        head=head,
        rows=cells,
        widths=[2.2, 1.0, 0.8, 0.8, 0.8, 0.9, 0.9, 0.9, 1.0, 0.8, 0.9],
        left_columns=2,
    )


def _cost_table(rows: list[dict[str, Any]]) -> Table:
    cells = [
        [
            f"{100.0 * row['reserve']:g}",
            number(row["crossing_interval_s"], "{:.2f}"),
            number(row.get("epsilon_per_m"), "{:.4f}"),
            number(row.get("look_ahead_m"), "{:.0f}"),
            number(row.get("steering_max_rad_s"), "{:.4f}"),
            number(row.get("bound_rad_s"), "{:.4f}"),
            number(row.get("convergence_time_s"), "{:.0f}")
            if "bound_rad_s" in row
            else "no such parameters",
        ]
        for row in rows
    ]
    head = [
        "Reserve [% of ω_max]", "Crossing interval [s]", "ε [1/m]", "R [m]", "|h| max [rad/s]", "Bound [rad/s]",
        "Estimated time to settle [s]",
    ]  # fmt: skip
    return Table(
        caption="What it costs that the demand of the law stays within ω_max.",
        head=head,
        rows=cells,
        widths=[1.0] * 7,
        left_columns=0,
    )


def _cost_chart(rows: list[dict[str, Any]]) -> Chart:
    kept = [row for row in rows if "bound_rad_s" in row and row["reserve"] >= 0.05]
    reserve = np.array([100.0 * row["reserve"] for row in kept])
    x_label = "Reserve of ω_max left to feedback [%]"
    return Chart(
        name="boundcost",
        caption=f"What it costs that the demand of the law stays within ω_max in every state, at ν = {rows[0]['nu']:g}.",
        panels=[
            Panel(
                x_label=x_label,
                y_label="Estimated time to settle [s]",
                lines=[
                    Line(
                        x=reserve,
                        y=np.array([row["convergence_time_s"] for row in kept]),
                        label="",
                        colour="black",
                    )
                ],
            ),
            Panel(
                x_label=x_label,
                y_label="Crossing interval [s]",
                lines=[
                    Line(
                        x=reserve,
                        y=np.array([row["crossing_interval_s"] for row in kept]),
                        label="",
                        colour="black",
                    )
                ],
            ),
        ],
        columns=2,
    )
