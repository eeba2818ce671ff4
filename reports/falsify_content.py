"""What a report shows of a search for the worst flight: how the search went, and the flights that it kept."""

from typing import Any

import numpy as np
import pandas as pd

from reports.blocks import Block, Section, Table, Text
from reports.chart import Chart, Line, Panel
from reports.run_data import RunData
from reports.sea_data import clearance

_POINTS_MAX = 4000
"""Flights that are drawn, at most: an even sample of more."""


def falsify_sections(run: RunData) -> list[Section]:
    """Return the section of a run that searched for the worst flight, and none of any other."""
    config = next(iter(run.manifest["trials"].values()))
    flown = run.summary[run.summary["min_distance_m"].notna()]
    if "search" not in config or not len(flown):
        return []
    blocks: list[Block] = [
        Text(_in_words(config, flown)),
        search_chart(flown, int(config["search"]["population"])),
        worst_table(flown, int(config["search"]["kept"])),
    ]
    return [Section(anchor="search", title="The search for the worst flight", nav_title="Search", blocks=blocks)]


def _in_words(config: dict[str, Any], flown: pd.DataFrame) -> str:
    search = config["search"]
    least = float(np.min(clearance(flown)))
    found = (
        f"The closest that it found stayed {least:.1f} m outside the keep-out area."
        if least >= 0.0
        else f"The worst that it found came {-least:.1f} m into the keep-out area."
    )
    return (
        f"Differential evolution over {len(config['draws'])} inputs within their declared ranges: {search['population']} flights a"
        f" generation, {search['generations']} generations after a Sobol sequence. {found} A search finds what is there to be"
        " found within its flights; it proves no bound. The worst flights are in the directory worst/, as scenario files that fly"
        " again identically."
    )


def search_chart(flown: pd.DataFrame, population: int) -> Chart:
    """Return how close to the keep-out area each flight came, and the closest so far, over the generations."""
    number = np.array([int(str(flight_id).rsplit("_", 1)[1]) for flight_id in flown["flight_id"]], dtype=np.float64)
    generation, distance = np.floor(number / population), clearance(flown)
    every = max(1, -(-len(flown) // _POINTS_MAX))
    each = np.unique(generation)
    closest = np.array([np.min(distance[generation == g]) for g in each])
    median = np.array([np.median(distance[generation == g]) for g in each])
    lines = [
        Line(x=generation[::every], y=distance[::every], label="a flight", colour="sky", style="points"),
        Line(x=each, y=median, label="median of the generation", colour="orange"),
        Line(x=each, y=np.minimum.accumulate(closest), label="closest so far", colour="blue"),
        Line(x=np.array([each[0], each[-1]]), y=np.zeros(2), label="r_min", colour="vermillion", style="dash"),
    ]
    panel = Panel(x_label="Generation [-]", y_label="Distance kept beyond r_min [m]", lines=lines)
    return Chart(name="search", caption="Closest approach of each flight, by generation of the search.", panels=[panel])


def worst_table(flown: pd.DataFrame, kept: int) -> Table:
    """Return the flights that came closest, the worst first."""
    order = np.argsort(clearance(flown), kind="stable")[:kept]
    rows = [
        [
            str(i),
            str(row["flight_id"]),
            f"{float(row['min_distance_m'] - row['keepout_radius_m']):.1f}",
            f"{float(row['keepout_margin_m']):.1f}",
            f"{float(row['nu_min']):.2f} to {float(row['nu_max']):.2f}",
            f"{float(row['wind_speed_mps']):.1f}",
            str(row["turbulence"]),
            f"{float(row['start_distance_m']):.0f}",
            f"{float(row['guard_time_s']):.1f}",
        ]
        for i, (_, row) in enumerate(flown.iloc[order].iterrows(), start=1)
    ]
    head = [
        "", "Flight", "Beyond r_min [m]", "Planned margin [m]", "ν", "Wind [m/s]", "Turbulence", "Start [m]", "Guard [s]",
    ]  # fmt: skip
    return Table(head=head, rows=rows, widths=[0.3, 1.7, 1.0, 1.0, 1.2, 0.8, 1.0, 0.8, 0.8], left_columns=2)
