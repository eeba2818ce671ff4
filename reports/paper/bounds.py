"""Actuation bounds, as a section of a report."""

from typing import Any

from reports.document.blocks import Heading, Section, Table, Text
from reports.document.tables import Cell, rows_table


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
            _cost_table(record["guaranteed"]),
        ],
    )


_BOUND = (
    "The paper's abstract announces sufficient conditions for the heading rate to stay within its"
    " bound; its text does not print them. docs/actuation_bounds.md derives one. The bound holds"
    " for law (30) in every state, at any distance and on any course; beside it stands the largest"
    " command that was found by a search over {samples:,} states, refined from the worst of them."
)

_COST = (
    "On the reference itself the law demands ω_r plus what h and V/R add, so a reference that"
    " spends all of ω_max, as the paper's Simulation 3 does, leaves no ε, R and h that keep"
    " commands within ω_max. A reserve buys them. The parameters below converge fastest among"
    " those that keep every command within ω_max; the price is a longer look-ahead, hence slower"
    " convergence, and a longer crossing interval. The catalog's Simulation 3 and sweep do not pay"
    " it: their commands are cut at ω_max on the way to the reference. guidance.tuning=bounded"
    " with a guidance.reserve of some tenths flies with the guarantee."
)

_COST_FOR = (
    "For speeds up to {speed_mps:g} m/s, which is the largest commanded airspeed and for an"
    " aircraft a margin, and ω_max = {heading_rate_max_rad_s:g} rad/s; the time is estimated from"
    " {distance_from_m:g} m to {distance_to_m:g} m."
)


def _tightness_table(rows: list[dict[str, Any]]) -> Table:
    cells = [
        Cell("Flights", lambda row: ", ".join(row["flights"]), width=2.2),
        Cell("Parameters", lambda row: _PARAMETERS.get(row["tuning"], "given")),
        Cell("Speed [m/s]", "speed_mps", "{:.2f}", 0.8),
        Cell("ε [1/m]", "epsilon_per_m", "{:.4f}", 0.8),
        Cell("R [m]", "look_ahead_m", "{:.1f}", 0.8),
        Cell("|h| max [rad/s]", "steering_max_rad_s", "{:.3f}", 0.9),
        Cell("|ω_r| max [rad/s]", "reference_heading_rate_max_rad_s", "{:.3f}", 0.9),
        Cell("Bound [rad/s]", "bound_rad_s", "{:.5f}", 0.9),
        Cell("Largest found [rad/s]", "largest_found_rad_s", "{:.5f}"),
        Cell("ω_max [rad/s]", "heading_rate_max_rad_s", "{:.5f}", 0.9),
    ]
    return rows_table(
        rows,
        cells,
        caption="The largest demand of the law: its bound, and the largest that was found.",
        left_columns=2,
    )


_PARAMETERS = {"bounded": "searched"}
"""How the parameters of a flight were found, by its tuning; others are given."""


def _cost_table(rows: list[dict[str, Any]]) -> Table:
    cells = [
        Cell("Reserve [% of ω_max]", lambda row: 100.0 * row["reserve"], "{:g}"),
        Cell("Crossing interval [s]", "crossing_interval_s", "{:.2f}"),
        Cell("ε [1/m]", "epsilon_per_m", "{:.4f}"),
        Cell("R [m]", "look_ahead_m", "{:.0f}"),
        Cell("|h| max [rad/s]", "steering_max_rad_s", "{:.4f}"),
        Cell("Bound [rad/s]", "bound_rad_s", "{:.4f}"),
        Cell("Estimated time to settle [s]", _settling, "{:.0f}"),
    ]
    caption = "What it costs that the demand of the law stays within ω_max."
    return rows_table(rows, cells, caption=caption, left_columns=0)


def _settling(row: dict[str, Any]) -> object:
    return row.get("convergence_time_s") if "bound_rad_s" in row else "no such parameters"
